"""Joystick logs: what an operator did with the stick in one episode, as a small text file, and its replay."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..slam.errors import InputError
from ..slam.files import write_text

FIRST_LINE = "tagalong joystick log 1"
SHIPPED = Path(__file__).parent / "joystick_logs"
"""Folder of the logs that come with the program, all by the operator model: corridor, meeting_room, office."""
_LONGEST = 10_000_000
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
                raise InputError(f"the joystick log was recorded with {what} {recorded!r}, not {asked!r}")


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
        "step forward turn",
    ]
    lines += [f"{k} {log.actions[k, 0]:.4f} {log.actions[k, 1]:.4f}" for k in log.changes]
    write_text(Path(path), "\n".join(lines) + "\n")


def read_joystick_log(path: str | os.PathLike[str]) -> JoystickLog:
    """Return the log in `path`, which may be the name of a shipped one, too ("corridor").

    Raises:
        InputError: If it is none, naming file and line.
    """
    shipped = SHIPPED / f"{path}.txt"
    try:
        lines = (shipped if shipped.is_file() else Path(path)).read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a joystick log: it is no text ({error})") from error
    if not lines or lines[0] != FIRST_LINE or "step forward turn" not in lines[:12]:
        raise InputError(f"{path}: not a joystick log: its first line should be {FIRST_LINE!r}")
    table = lines.index("step forward turn")
    header = dict(line.split(": ", 1) for line in lines[1:table] if ": " in line)
    try:
        actions = _held(lines[table + 1 :], int(header["steps"]))
        kwargs = json.loads(header["kwargs"])
        made_by, env, seed, step_s = header["made by"], header["env"], int(header["seed"]), float(header["step_s"])
        _check_values(kwargs, actions, seed, step_s)
    except (KeyError, ValueError, IndexError) as error:
        raise InputError(f"{path}: damaged joystick log ({error})") from error
    return JoystickLog(made_by, env, kwargs, seed, actions, step_s)


def _held(lines: Sequence[str], steps: int) -> NDArray[np.float32]:
    """Return (steps, 2): each position of the stick held until the next one."""
    if not 0 <= steps <= _LONGEST:
        raise ValueError(f"steps: 0 to {_LONGEST}, got {steps}")
    actions = np.zeros((steps, 2), dtype=np.float32)
    for line in lines:
        step, forward, turn = line.split()
        if not 0 <= int(step) < steps:
            raise ValueError(f"step {step} is none of the {steps}")
        actions[int(step) :] = (float(forward), float(turn))
    return actions


def _check_values(kwargs: Any, actions: NDArray[np.float32], seed: int, step_s: float) -> None:
    """Raise a ValueError that says what cannot be."""
    if not isinstance(kwargs, dict):
        raise ValueError(f"kwargs: names with values, got {kwargs!r}")
    if seed < 0:
        raise ValueError(f"seed: not negative, got {seed}")
    if not 0.0 < step_s < np.inf:
        raise ValueError(f"step_s: a time in seconds, got {step_s}")
    if not (np.abs(actions) <= 1.0).all():
        raise ValueError("the stick is in [-1, 1]")


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
