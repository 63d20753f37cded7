"""`tagalong teleop`: drives the robot by stick, records a joystick log, replays one."""

import argparse
import os
from pathlib import Path
from typing import Any

from ...agents.teleop.joystick import JoystickLog, read_joystick_log, write_joystick_log
from ...envs.follow_env import FollowEnv
from ...envs.registration import IDS
from ...slam.errors import InputError
from ..console.arguments import at_least, random_seed
from ..console.setting_words import add_settings, read_settings
from ..console.tables import format_table

EPILOG = """\
Keys: arrows or w a s d, space lets go; a gamepad's left stick. q, back or start, and Ctrl-C end the drive; the log of
what was driven is kept. It is a small text file with environment, arguments and seed in its header; a replay refuses
anything else.

The operator model is a model and labelled so in the log; --calibrate shows what it is fitted to. Three logs by it are
shipped: --replay corridor, meeting_room or office.

examples:
  tagalong teleop --env tagalong/Corridor-v0 --seed 3 --out drive.txt
  tagalong teleop --operator gamepad --viewer --out drive.txt
  tagalong teleop --operator model --set odometry=slipping --out model.txt
  tagalong teleop --replay model.txt
  tagalong teleop --replay corridor
  tagalong teleop --calibrate --data DIR
"""
SHOWN = (
    "duration_s",
    "coverage",
    "path_length_m",
    "jerk_rms_mps3",
    "contacts_people",
    "contacts_static",
    "near_misses",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("--env", choices=sorted(IDS), default="tagalong/Corridor-v0", help="where (%(default)s)")
    parser.add_argument("--seed", type=random_seed, default=0, metavar="N", help="seed of the episode (%(default)s)")
    parser.add_argument("--people", type=at_least(0), default=2, metavar="N", help="bystanders (%(default)s)")
    parser.add_argument(
        "--operator", choices=("keyboard", "gamepad", "model"), default="keyboard", help="who drives (%(default)s)"
    )
    parser.add_argument(
        "--gamepad", default="/dev/input/js0", metavar="DEVICE", help="which gamepad, on Linux (%(default)s)"
    )
    add_settings(parser, "an argument of the environment, e.g. robot=dingo-o or odometry=slipping")
    parser.add_argument("--viewer", action="store_true", help="show MuJoCo's viewer; needs a display")
    parser.add_argument("--out", type=Path, metavar="LOG", help="where the joystick log goes")
    parser.set_defaults(out_is_folder=False)
    parser.add_argument(
        "--replay", type=Path, metavar="LOG", help="replay this log instead, or a shipped one by its name"
    )
    parser.add_argument(
        "--calibrate", action="store_true", help="fit the operator model to real logs and show how well"
    )
    parser.add_argument("--data", type=Path, metavar="DIR", help="recorded data (default: TAGALONG_DATA)")


def run(options: argparse.Namespace) -> int:
    """Do what was asked for."""
    if options.calibrate:
        return _calibrate(options.data)
    if options.replay is not None:
        _report(read_joystick_log(options.replay))
        return 0
    if options.out is None:
        raise InputError("say where the joystick log goes: --out LOG")
    log = _record(options)
    write_joystick_log(options.out, log)
    print(f"\n{options.out}: {len(log.actions)} steps by {log.made_by}")
    return 0


def _record(options: argparse.Namespace) -> JoystickLog:
    from ...agents.teleop import gamepad, keyboard
    from ...agents.teleop.joystick_drive import record_drive

    arguments: dict[str, Any] = {"leader": False, "people_count": options.people, "slam": None, "coverage_goal": 1.0}
    arguments |= {"ends_on_contact": False, **read_settings(options.settings)}
    mode = "human" if options.viewer else None
    if options.operator == "model":
        return record_drive(options.env, arguments, options.seed, render_mode=mode)
    pad = options.operator == "gamepad"
    source = gamepad.gamepad_events(options.gamepad) if pad else keyboard.terminal_keys()
    stick = gamepad.GamepadStick if pad else keyboard.KeyboardStick
    print(gamepad.HELP if pad else keyboard.HELP)
    with source as read:
        return record_drive(
            options.env,
            arguments,
            options.seed,
            operator=lambda env, seed: stick(read, 1.0 / env.config.task.control_hz),  # pyright: ignore[reportArgumentType]
            made_by=options.operator,
            watch=_status,
            render_mode=mode,
            by_hand=True,
        )


def _status(env: FollowEnv) -> None:
    """Print one line: what the driver has to know without a viewer."""
    truth, scan = env.truth, env.belief.scan
    half = len(scan.ranges) // 2
    ahead = min((float(r) for r in scan.ranges[half - 60 : half + 60] if r == r), default=float("nan"))
    words = f"{truth.time_s:6.1f} s  seen {100.0 * env.coverage.share:3.0f} %  speed {truth.robot_velocity[0]:5.2f} m/s"
    print(f"\r{words}  free ahead {ahead:5.2f} m  ", end="", flush=True)


def _report(log: JoystickLog) -> None:
    from ...agents.teleop.joystick_drive import replay_drive

    episode = replay_drive(log)
    print(f"{log.env}, seed {log.seed}, made by: {log.made_by}")
    rows = [("operator active [s]", f"{log.active_s:.1f}"), ("commands", str(len(log.changes)))]
    rows += [(name, f"{episode.metrics[name]:.3f}") for name in SHOWN]
    print(format_table(("figure", "value"), rows))


def _calibrate(data: Path | None) -> int:
    from ..benchmarks.joystick_calibration import calibrate, log_figures, model_figures

    variable = os.environ.get("TAGALONG_DATA")
    folder = data or (Path(variable) if variable else None)
    if folder is None:
        raise InputError("--calibrate needs recorded data: --data DIR or TAGALONG_DATA")
    targets = log_figures(folder)
    best = calibrate(targets)
    rows = [figures.row(name) for name, figures in targets.items()] + [model_figures(best).row("model")]
    columns = ("drive", "speed, 95 % [m/s]", "turn rate, 99 % [rad/s]", "acceleration [m/s2]", "turning [rad/s2]")
    print(format_table(columns, rows))
    print(f"slew {best.slew} full sticks/s, over-correction {best.over_correction}")
    return 0
