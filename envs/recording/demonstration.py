"""One episode as a learner of it needs it: what was observed, what was done, and what came of it."""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.errors import InputError
from ...slam.files.input import named
from ...slam.files.npz import read_arrays
from ...slam.files.output import replacing
from .rollout import Acting, rollout

Arrays = dict[str, NDArray[Any]]

_TABLES = ("observations", "infos")
_TOLD = ("seed", "options", "ending")
_COLUMNS = ("actions", "rewards", "terminated", "truncated")


@dataclass(frozen=True, eq=False)
class Demonstration:
    """An episode of T steps.

    Attributes:
        observations: Entry -> (T + 1, ...) what was observed, the one after the last step included.
        actions: (T, k) float32 what was done, cut to [-1, 1].
        rewards: (T,) float64.
        terminated: (T,) whether the episode ended with the step.
        truncated: (T,) whether it was cut after it.
        infos: Name -> (T + 1, ...) of `info`; the terms of the reward are `reward_NAME`. They hold the truth: to judge
            by, not to learn from.
        seed: Of the episode.
        options: Of its `reset`.
        ending: Why it ended, as in `info`.
    """

    observations: Arrays
    actions: NDArray[np.float32]
    rewards: NDArray[np.float64]
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    infos: Arrays
    seed: int
    options: dict[str, Any]
    ending: str

    def __len__(self) -> int:
        return len(self.rewards)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to an .npz file, whole or not at all: plain arrays, no pickles."""
        told = {name: getattr(self, name) for name in _TOLD}
        arrays: Arrays = {name: getattr(self, name) for name in _COLUMNS}
        arrays |= {f"{table}/{name}": array for table in _TABLES for name, array in getattr(self, table).items()}
        with replacing(path) as temporary:
            np.savez_compressed(temporary, allow_pickle=False, told=np.array(json.dumps(told)), **arrays)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "Demonstration":
        """Return what `save` wrote.

        Raises:
            InputError: If there is no such file, or it is none of `save`.
        """
        arrays = read_arrays(path)
        try:
            told = json.loads(str(arrays["told"]))
            columns = {name: arrays[name] for name in _COLUMNS}
            known = {name: told[name] for name in _TOLD}
        except (KeyError, TypeError, ValueError, RecursionError):
            raise InputError(f"{named(path)}: holds no demonstration") from None
        tables: dict[str, Arrays] = {
            table: {name.partition("/")[2]: array for name, array in arrays.items() if name.startswith(f"{table}/")}
            for table in _TABLES
        }
        steps = {len(array) if array.ndim else -1 for array in columns.values()}
        steps |= {len(array) - 1 if array.ndim else -1 for table in tables.values() for array in table.values()}
        if len(steps) != 1 or min(steps) < 1:
            raise InputError(f"{named(path)}: holds no demonstration")
        return cls(**columns, **tables, **known)


def demonstrate(
    env: gym.Env[Any, Any],
    follower: Acting,
    *,
    seed: int,
    steps: int | None = None,
    options: dict[str, Any] | None = None,
) -> Demonstration:
    """Drive one episode and return it as a demonstration.

    Args:
        env: A `FollowEnv`, wrapped or not, whose outermost observation is a `Dict`: that is what is kept.
        follower: Acts.
        seed: Seed of the episode.
        steps: Most steps; None runs until the episode ends. An episode that is cut counts as truncated.
        options: Options of `reset`.

    Raises:
        InputError: If the observation is no `Dict`, or `rollout` cannot drive there.
    """
    if not isinstance(env.observation_space, gym.spaces.Dict):
        raise InputError(f"demonstrations need observations that are a Dict, got {env.observation_space}")
    notes = _NotedEnv(env)
    episode = rollout(notes, follower, seed=seed, steps=steps, options=options)
    return notes.demonstration(seed, episode.options, episode.ending)


class _NotedEnv(gym.Wrapper[Any, Any, Any, Any]):
    """Notes what goes in and out of an environment, and changes nothing."""

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode, and forget the one before."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._observed, self._told = [observation], [_flat(info)]
        self._done: list[tuple[NDArray[np.float32], float, bool, bool]] = []
        return observation, info

    def step(self, action: ArrayLike) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Step, and note it."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._observed.append(observation)
        self._told.append(_flat(info))
        cut = np.clip(np.array(action, dtype=np.float32), -1.0, 1.0)
        self._done.append((cut, float(reward), bool(terminated), bool(truncated)))
        return observation, float(reward), terminated, truncated, info

    def demonstration(self, seed: int, options: dict[str, Any], ending: str) -> Demonstration:
        """Return what was noted since `reset`."""
        actions, rewards, terminated, truncated = zip(*self._done, strict=True)
        cut = np.array(truncated)
        cut[-1] |= not terminated[-1]
        return Demonstration(
            observations=_stacked(self._observed),
            actions=np.stack(actions),
            rewards=np.array(rewards),
            terminated=np.array(terminated),
            truncated=cut,
            infos=_stacked(self._told),
            seed=seed,
            options=options,
            ending=ending,
        )


def _flat(info: Mapping[str, Any]) -> dict[str, Any]:
    terms = {f"reward_{name}": value for name, value in info["reward_terms"].items()}
    return {**{name: value for name, value in info.items() if name != "reward_terms"}, **terms}


def _stacked(rows: list[dict[str, Any]]) -> Arrays:
    """Return one array for each name that every row has: wrappers may tell more at the end of an episode."""
    names = [name for name in rows[0] if all(name in row for row in rows)]
    return {name: np.stack([np.asarray(row[name]) for row in rows]) for name in names}
