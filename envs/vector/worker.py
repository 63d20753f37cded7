"""One process's share of a vector environment."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.processes.stages import in_turn
from ..follow_env import FollowEnv, StepResult

Row = tuple[Any, float, bool, bool, dict[str, Any], Any, dict[str, Any] | None]
"""Observation, reward, terminated, truncated, info, and of an episode that ended in this step its last observation and
info where the next one has begun already."""


@dataclass(frozen=True, eq=False)
class Rows:
    """One step of a share, batched where it was computed: the process that asks for it has less to do.

    Attributes:
        observations: Of k environments, by name.
        rewards: (k,).
        terminated: (k,).
        truncated: (k,).
        columns: Their infos by name, see `columns`; None where they differ in kind.
        infos: Their infos one by one, and what ended in this step; empty where `columns` says all.
    """

    observations: dict[str, NDArray[Any]]
    rewards: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    columns: dict[str, Any] | None
    infos: list[tuple[dict[str, Any], Any, dict[str, Any] | None]]


def stacked(observations: list[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Return the batch of `observations`, by name."""
    return {key: np.stack([observation[key] for observation in observations]) for key in observations[0]}


def columns(infos: list[dict[str, Any]]) -> dict[str, Any] | None:
    """Return arrays (k, ...) of the entries of k `infos` as Gymnasium batches them; None where their names differ."""
    names = infos[0].keys()
    if any(info.keys() != names for info in infos):
        return None
    table: dict[str, Any] = {}
    for name in names:
        values = [info[name] for info in infos]
        first = values[0]
        if isinstance(first, dict):
            table[name] = columns(values)
            if table[name] is None:
                return None
        elif isinstance(first, np.ndarray):
            table[name] = np.stack(values)
        elif isinstance(first, int | float | np.number):
            table[name] = np.array(values, dtype=type(first))
        else:
            table[name] = np.empty(len(values), dtype=object)
            table[name][:] = values
    return table


def split(table: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """Return the `count` infos that `columns` made `table` of; those of an empty table are empty."""
    rows: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, values in table.items():
        each = split(values, count) if isinstance(values, dict) else values
        if isinstance(values, np.ndarray) and values.dtype == bool and values.ndim == 1:
            each = values.tolist()  # Gymnasium batches Python's, not numpy's, as arrays of booleans
        for row, value in zip(rows, each, strict=True):
            row[name] = value
    return rows


def joined(tables: list[dict[str, Any]], count: int) -> dict[str, Any] | None:
    """Return the infos of `count` environments, with masks, from the `columns` of shares; None where they differ."""
    names = tables[0].keys()
    if any(table.keys() != names for table in tables):
        return None
    infos: dict[str, Any] = {}
    for name in names:
        parts = [table[name] for table in tables]
        if isinstance(parts[0], dict):
            infos[name] = joined(parts, count)
            if infos[name] is None:
                return None
        else:
            infos[name] = np.concatenate(parts, dtype=parts[0].dtype, casting="unsafe")
        infos[f"_{name}"] = np.ones(count, dtype=bool)
    return infos


class WorkerShare:
    """Some environments that are stepped in turn, stage by stage.

    Args:
        count: How many.
        mode: When an ended episode is followed by the next.
        max_episode_steps: Steps after which an episode is truncated; None never.
        fields: Keyword arguments of `FollowEnv`.
    """

    def __init__(self, count: int, mode: AutoresetMode, max_episode_steps: int | None, fields: dict[str, Any]) -> None:
        self._envs = [FollowEnv(**fields) for _ in range(count)]
        self._mode, self._limit = mode, max_episode_steps or np.inf
        self._ended = np.zeros(count, dtype=bool)
        self._steps = np.zeros(count, dtype=np.int64)

    def reset(self, seeds: list[int | None], options: dict[str, Any] | None, chosen: list[bool]) -> list[Any]:
        """Return (observation, info) of each environment that is `chosen`, None of the others."""
        results: list[Any] = []
        for i, (seed, wanted) in enumerate(zip(seeds, chosen, strict=True)):
            results.append(self._restart(i, seed=seed, options=options) if wanted else None)
        return results

    def step(self, actions: Any) -> Rows:
        """Return what became of each environment under `actions` (count, ...)."""
        if self._mode == AutoresetMode.DISABLED and self._ended.any():
            ended = int(np.flatnonzero(self._ended)[0])
            raise InputError(f"the episode of environment {ended} of this worker has ended: reset it first")
        going = np.flatnonzero(~self._ended).tolist()
        results = dict(zip(going, in_turn([self._envs[i].step_in_stages(actions[i]) for i in going]), strict=True))
        rows = [self._row(i, results.get(i)) for i in range(len(self._envs))]
        alike = None if any(row[6] is not None for row in rows) else columns([row[4] for row in rows])
        return Rows(
            observations=stacked([row[0] for row in rows]),
            rewards=np.array([row[1] for row in rows], dtype=np.float64),
            terminated=np.array([row[2] for row in rows], dtype=bool),
            truncated=np.array([row[3] for row in rows], dtype=bool),
            columns=alike,
            infos=[] if alike is not None else [row[4:] for row in rows],
        )

    def render(self) -> list[Any]:
        """Return a picture of each environment."""
        return [env.render() for env in self._envs]

    def _row(self, i: int, result: StepResult | None) -> Row:
        """Return what became of environment i by the `result` of its step; None: its episode had ended before."""
        if result is None:
            observation, info = self._restart(i)
            return observation, 0.0, False, False, info, None, None
        observation, reward, terminated, _, info = result
        self._steps[i] += 1
        truncated = bool(self._steps[i] >= self._limit)
        self._ended[i] = terminated or truncated
        if self._ended[i] and self._mode == AutoresetMode.SAME_STEP:
            last, last_info = observation, info
            observation, info = self._restart(i)
            return observation, reward, terminated, truncated, info, last, last_info
        return observation, reward, terminated, truncated, info, None, None

    def _restart(self, i: int, **how: Any) -> tuple[Any, dict[str, Any]]:
        self._ended[i], self._steps[i] = False, 0
        return self._envs[i].reset(**how)


def asked(share: WorkerShare, task: tuple[str, tuple[Any, ...]]) -> Any:
    """Return what the method of `share` returns that `task` names, called with its arguments."""
    name, arguments = task
    return getattr(share, name)(*arguments)


def worker_share(*arguments: Any) -> Callable[[tuple[str, tuple[Any, ...]]], Any]:
    """Return, in a worker's process, what answers a task there; the arguments are those of `WorkerShare`."""
    return partial(asked, WorkerShare(*arguments))
