"""`tagalong train follower`: a follower that is learned, from nothing to a policy that drives without torch."""

import argparse
import time
from dataclasses import replace
from pathlib import Path

from ...slam.errors import InputError, MissingExtraError
from ...slam.processes.crew import require_workers
from ..console.arguments import at_least, random_seed, within
from ..console.setting_words import add_settings, read_settings
from ..console.subcommands import add_described

MOST_STEPS = 10**10
"""Two weeks on a core."""
ALGORITHMS = ("ppo", "sac", "recurrent-ppo")
WORLDS = "worlds"
PRESETS = (WORLDS, "office", "office-map", "corridor")
EPILOG = """\
With the preset worlds, the default, the policy is rewarded from the start, by PPO on compiled worlds: offices of the
training half, a floor plan, corridors and halls, people known by the robot's own tracker (on a GPU by a model of its
errors). Its wishes pass a safety filter that stops before a certain contact, in training as later; "DIR-alone" is the
network alone. The same command makes the same weights, to the byte, if it is not interrupted.

With the other presets it is trained in MuJoCo's worlds with the tracker: with ppo, it first imitates a teacher that
drives by the truth (which the robot never sees), on the ways that the policy itself comes to; then it is rewarded.
With sac and recurrent-ppo it is rewarded from the start.

The same command goes on where it was killed. Only --workers, --max-minutes may change then.

writes into DIR: policy.npz (arrays), policy.safetensors, policy.json (card), settings.json, and curve.json (worlds) or
policy.onnx, evaluations.json, tensorboard/; checkpoint.json with model_*.safetensors, demonstrations/ (only to go on)

examples:
  tagalong train follower --out out/follower
  tagalong evaluate out/follower --suite office --episodes 100
  tagalong train follower --algo ppo --preset office --max-minutes 90 --out out/imitated
  tagalong train follower --algo recurrent-ppo --preset corridor --out out/recurrent
"""


def add_follower_arguments(models: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Declare the options."""
    summary = "a follower, by reinforcement from nothing, or by imitation"
    parser = add_described(models, "follower", summary, EPILOG)
    parser.add_argument("--algo", choices=ALGORITHMS, default="ppo", help="default: %(default)s")
    parser.add_argument("--preset", choices=PRESETS, default=WORLDS, help="default: %(default)s")
    parser.add_argument("--seed", type=random_seed, default=0, help="of all random draws (default: %(default)s)")
    parser.add_argument(
        "--steps",
        type=at_least(1, MOST_STEPS),
        metavar="N",
        help="steps of reinforcement (worlds: 4000000)",
    )
    parser.add_argument("--max-minutes", type=within(0.001, 1e6), metavar="M", help="stop then, evaluations included")
    parser.add_argument(
        "--workers",
        type=at_least(1),
        default=2,
        metavar="N",
        help="processes that drive (worlds: threads; %(default)s)",
    )
    parser.add_argument(
        "--device", choices=("cpu", "cuda"), default="cpu",
        help="worlds: cuda steps them on a GPU, 400000000 steps, for a larger network (default: %(default)s)",
    )  # fmt: skip
    add_settings(parser, "an argument of the environments that it is trained in, e.g. robot=pioneer")
    parser.add_argument("--out", type=Path, default=Path("out/follower"), metavar="DIR", help="default: %(default)s")


def train_follower(options: argparse.Namespace) -> int:
    """Train, or go on with training; print a line on the progress now and then."""
    require_workers(options.workers, "--workers")
    if options.preset == WORLDS:
        return _train_on_worlds(options)
    if options.device != "cpu":
        raise InputError(f"--device {options.device} is for the preset {WORLDS}; the others are MuJoCo's worlds")
    if options.steps is not None:
        raise InputError(f"--steps is for the preset {WORLDS}; the others have steps of their own")
    try:
        from ...agents.training.presets import make_preset
        from ...agents.training.run import RunConfig, TrainingRun
        from ...envs.follow_config import make_config
    except ImportError as error:
        raise MissingExtraError(f"learned followers ({error.name})", "learn") from None
    preset = make_preset(options.preset, options.algo)
    preset = replace(preset, env={**preset.env, **read_settings(options.settings)})
    make_config(preset.env)  # what makes no sense is told before the processes start
    config = RunConfig(
        preset=preset,
        name=options.preset,
        seed=options.seed,
        workers=options.workers,
        max_minutes=options.max_minutes,
    )
    lines = ProgressLines()
    run = TrainingRun(config, options.out, lines)
    if run.progress.minutes:
        lines.go_on(run.progress.minutes)
    progress = run.train()
    if progress.best == float("-inf"):
        print(f"stopped after {progress.minutes:.1f} minutes, before a first evaluation: the same command goes on")
        return 1
    print(f"wrote {options.out / 'policy.npz'}; best return of an evaluation {progress.best:.1f}")
    return 0


def _train_on_worlds(options: argparse.Namespace) -> int:
    if options.algo != "ppo":
        raise InputError(f"the preset {WORLDS} is trained by ppo, got {options.algo}")
    try:
        from ...agents.training.worlds.preset import preset_for
        from ...agents.training.worlds.run import WorldsRun, WorldsRunConfig
    except ImportError as error:
        raise MissingExtraError(f"learned followers ({error.name})", "learn") from None
    preset = preset_for(options.device)
    preset = replace(preset, env={**preset.env, **read_settings(options.settings)})
    if options.steps is not None:
        preset = replace(preset, steps=options.steps)
    limits = {"seed": options.seed, "workers": options.workers, "max_minutes": options.max_minutes}
    config = WorldsRunConfig(preset=preset, device=options.device, **limits)
    lines = ProgressLines()
    run = WorldsRun(config, options.out, lines)
    if run.progress.minutes:
        lines.go_on(run.progress.minutes)
    progress = run.train()
    print(f"wrote {options.out / 'policy.npz'} after {progress.steps} steps")
    return 0


class ProgressLines:
    """Prints a line if the last one is old, or if it tells of a result, with the minutes that the run took so far."""

    def __init__(self, every_s: float = 10.0) -> None:
        self._every_s, self._began, self._last = every_s, time.monotonic(), float("-inf")

    def go_on(self, minutes: float) -> None:
        """Say that a run goes on which took so many minutes before."""
        self._began -= 60.0 * minutes
        self("going on from the last checkpoint")

    def __call__(self, line: str) -> None:
        """Take a line."""
        now = time.monotonic()
        if now - self._last >= self._every_s or line.startswith("evaluation"):
            self._last = now
            print(f"{(now - self._began) / 60.0:6.1f} min  {line}", flush=True)
