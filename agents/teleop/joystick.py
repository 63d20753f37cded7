"""Joystick logs: what an operator did with the stick in one episode, as a small text file, and its replay."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, one_line, shown
from ...slam.files.input import named, parse_json, read_text
from ...slam.files.output import write_text

FIRST_LINE = "tagalong joystick log 1"
SHIPPED = Path(__file__).parents[1] / "joystick_logs"
"""Folder of the logs that come with the program, all by the operator model: corridor, meeting_room, office."""
_LONGEST = 1_000_000  # steps: 28 hours at 10 Hz
_LONGEST_STEP_S = 60.0
_MOST_BYTES = 1 << 25  # a line of at most 25 bytes a step, and a header
_TABLE = "step forward turn"
MODEL = "operator model, not a human"
"""What stands under "made by" where the operator model held the stick."""


@dataclass(frozen=True, eq=False)
class JoystickLog:
    """One recorded episode.

    Attributes:
        made_by: Who held the stick: "keyboard", "gamepad", or `MODEL`.
        env: Id of the environment.
        kwargs: Its keyword arguments, as `gymnasium.make` took them; plain JSON.
        seed: Seed of the episode.
        actions: (n, 2) forward and turn in [-1, 1] of each step.
        step_s: Length of a step [s].
    """

    made_by: str
    env: str
    kwargs: Mapping[str, Any]
    seed: int
    actions: NDArray[np.float32]
    step_s: float = 0.1

    @property
    def changes(self) -> NDArray[np.intp]:
        """(m,) steps at which the stick was moved: the operator's commands."""
        moved = np.any(np.diff(self.actions, axis=0, prepend=np.zeros((1, 2), dtype=np.float32)) != 0.0, axis=1)
        return np.flatnonzero(moved)

    @property
    def active_s(self) -> float:
        """Time in which the stick was held away from its middle [s]."""
        return float(np.any(self.actions != 0.0, axis=1).sum()) * self.step_s

    def check(self, env: str, kwargs: Mapping[str, Any], seed: int | None) -> None:
        """Refuse to be replayed anywhere but where it was recorded.

        Raises:
            InputError: Saying what differs.
        """
        plain = json.loads(json.dumps(dict(kwargs)))
        for what, recorded, asked in (
            ("environment", self.env, env),
            ("arguments", dict(self.kwargs), plain),
            ("seed", self.seed, seed),
        ):
            if recorded != asked:
                raise InputError(f"the joystick log was recorded with {what} {shown(recorded)}, not {shown(asked)}")


def write_joystick_log(path: str | os.PathLike[str], log: JoystickLog) -> None:
    """Write `log` to `path`, whole or not at all."""
    lines = [
        FIRST_LINE,
        f"made by: {log.made_by}",
        f"env: {log.env}",
        f"kwargs: {json.dumps(dict(log.kwargs), sort_keys=True)}",
        f"seed: {log.seed}",
        f"step_s: {log.step_s:g}",
        f"steps: {len(log.actions)}",
        _TABLE,
    ]
    lines += [f"{k} {log.actions[k, 0]:.4f} {log.actions[k, 1]:.4f}" for k in log.changes]
    write_text(Path(path), "\n".join(lines) + "\n")


def read_joystick_log(path: str | os.PathLike[str]) -> JoystickLog:
    """Return the log in `path`, which may be the name of a shipped one, too ("corridor").

    Raises:
        InputError: If it is none, naming file and line.
    """
    shipped = SHIPPED / f"{named(path)}.txt"
    text = read_text(shipped if _is_shipped(shipped) else path, _MOST_BYTES, f"a log has at most {_MOST_BYTES} bytes")
    lines = text.splitlines()
    if not lines or lines[0] != FIRST_LINE or _TABLE not in lines[:12]:
        raise InputError(f"{named(path)}: not a joystick log: its first line should be {FIRST_LINE!r}")
    table = lines.index(_TABLE)
    header = dict(line.split(": ", 1) for line in lines[1:table] if ": " in line)
    try:
        actions = _held(lines[table + 1 :], _count("steps", header["steps"]))
        kwargs = parse_json(header["kwargs"], "kwargs")
        made_by, env, seed = header["made by"], header["env"], _count("seed", header["seed"])
        step_s = float(header["step_s"])
        _check_values(kwargs, step_s)
    except (KeyError, ValueError) as error:
        raise InputError(f"{named(path)}: damaged joystick log ({one_line(str(error), 200)})") from error
    return JoystickLog(made_by, env, kwargs, seed, actions, step_s)


def _is_shipped(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # no name that any file can have: what was given is a path, and opening it will say so
        return False


def _count(name: str, word: str) -> int:
    """Return a whole number of the header; of more than twenty digits nothing is counted."""
    if not (word.isdecimal() and word.isascii() and len(word) <= 20):
        raise ValueError(f"{name}: a whole number, not negative, got {shown(word)}")
    return int(word)


def _held(lines: Sequence[str], steps: int) -> NDArray[np.float32]:
    """Return (steps, 2): each position of the stick held until the next one."""
    if steps > _LONGEST:
        raise ValueError(f"steps: 0 to {_LONGEST}, got {steps}")
    actions = np.zeros((steps, 2), dtype=np.float32)
    since, held = 0, (0.0, 0.0)
    for line in lines:
        words = line.split(maxsplit=3)
        step = _count("step", words[0]) if len(words) == 3 else steps
        if not since <= step < steps:
            raise ValueError(f"a line is `step forward turn`, steps ascending from 0 to {steps - 1}; got {shown(line)}")
        actions[since:step] = held
        since, held = step, (float(words[1]), float(words[2]))
        if not all(abs(value) <= 1.0 for value in held):
            raise ValueError(f"the stick is in [-1, 1], got {shown(line)}")
    actions[since:] = held
    return actions


def _check_values(kwargs: Any, step_s: float) -> None:
    """Raise a ValueError that says what cannot be."""
    if not isinstance(kwargs, dict):
        raise ValueError(f"kwargs: names with values, got {shown(kwargs)}")
    if not 0.0 < step_s <= _LONGEST_STEP_S:
        raise ValueError(f"step_s: a time in seconds, at most {_LONGEST_STEP_S}, got {step_s}")


class JoystickReplay:
    """Acts as recorded, whatever happens; stands still after the end.

    Args:
        log: What was recorded.
        env: Id of the environment that it will act in.
        kwargs: Keyword arguments of that environment.
        seed: Seed of the episode.

    Raises:
        InputError: If the log was recorded elsewhere.
    """

    def __init__(self, log: JoystickLog, env: str, kwargs: Mapping[str, Any], seed: int | None) -> None:
        log.check(env, kwargs, seed)
        self.log = log
        self.reset()

    def reset(self) -> None:
        """Begin again."""
        self._step = 0

    def act(self, observation: Any) -> NDArray[np.float32]:
        """Return the recorded action of this step, (2,)."""
        self._step += 1
        if self._step > len(self.log.actions):
            return np.zeros(2, dtype=np.float32)
        return self.log.actions[self._step - 1].copy()
