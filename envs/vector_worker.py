"""One process's share of a vector environment."""

from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import TimeLimit
from numpy.typing import NDArray

from ..slam.errors import InputError
from .follow_env import FollowEnv

Row = tuple[float, bool, bool, dict[str, Any], Any, dict[str, Any] | None]
"""Reward, terminated, truncated, info, and of an episode that ended in this step its last observation and info where
the next one has begun already. The observation itself stands in shared memory."""
Views = dict[str, NDArray[Any]]


def shared_views(buffers: dict[str, Any], space: spaces.Dict, count: int) -> Views:
    """Return arrays (count, ...) for the observations of `count` environments in the memory of `buffers`."""
    views = {}
    for key, part in space.spaces.items():
        assert part.dtype is not None
        views[key] = np.frombuffer(buffers[key], part.dtype).reshape(count, *(part.shape or ()))
    return views


class Share:
    """Some environments that are stepped one after the other.

    Args:
        count: How many.
        mode: When an ended episode is followed by the next.
        max_episode_steps: Steps after which an episode is truncated; None never.
        fields: Keyword arguments of `FollowEnv`.
        views: Where their observations are written, (count, ...) of each entry.
    """

    def __init__(
        self, count: int, mode: AutoresetMode, max_episode_steps: int | None, fields: dict[str, Any], views: Views
    ) -> None:
        single = [FollowEnv(**fields) for _ in range(count)]
        self._envs = [TimeLimit(env, max_episode_steps) if max_episode_steps else env for env in single]
        self._mode = mode
        self._views = views
        self._ended = np.zeros(count, dtype=bool)

    def reset(self, seeds: list[int | None], options: dict[str, Any] | None, chosen: list[bool]) -> list[Any]:
        """Return the info of each environment that is `chosen`, None of the others."""
        results: list[Any] = []
        for i, (env, seed, wanted) in enumerate(zip(self._envs, seeds, chosen, strict=True)):
            self._ended[i] = self._ended[i] and not wanted
            results.append(self._started(i, env, seed=seed, options=options) if wanted else None)
        return results

    def step(self, actions: Any) -> list[Row]:
        """Return what became of each environment under `actions` (count, ...)."""
        return [self._step(i, env, actions[i]) for i, env in enumerate(self._envs)]

    def render(self) -> list[Any]:
        """Return a picture of each environment."""
        return [env.render() for env in self._envs]

    def _step(self, i: int, env: Any, action: Any) -> Row:
        if self._ended[i]:
            if self._mode == AutoresetMode.DISABLED:
                raise InputError(f"the episode of environment {i} of this worker has ended: reset it first")
            self._ended[i] = False
            return 0.0, False, False, self._started(i, env), None, None
        observation, reward, terminated, truncated, info = env.step(action)
        ended = terminated or truncated
        if ended and self._mode == AutoresetMode.SAME_STEP:
            return reward, terminated, truncated, self._started(i, env), observation, info
        self._ended[i] = ended
        self._write(i, observation)
        return reward, terminated, truncated, info, None, None

    def _started(self, i: int, env: Any, **arguments: Any) -> dict[str, Any]:
        observation, info = env.reset(**arguments)
        self._write(i, observation)
        return info

    def _write(self, i: int, observation: dict[str, NDArray[Any]]) -> None:
        for key, value in observation.items():
            self._views[key][i] = value


def work(
    pipe: Connection,
    part: slice,
    num_envs: int,
    buffers: dict[str, Any],
    space: spaces.Dict,
    mode: AutoresetMode,
    max_episode_steps: int | None,
    fields: dict[str, Any],
) -> None:
    """Do what comes through `pipe`, (name of a method of `Share`, its arguments), until None comes.

    Answers are (result, None), or (None, error). Observations are written to the rows `part` of `buffers`.
    """
    views = {key: view[part] for key, view in shared_views(buffers, space, num_envs).items()}
    share = Share(part.stop - part.start, mode, max_episode_steps, fields, views)
    while True:
        try:
            task = pipe.recv()
        except (EOFError, KeyboardInterrupt):
            return
        if task is None:
            return
        name, arguments = task
        try:
            pipe.send((getattr(share, name)(*arguments), None))
        except Exception as error:
            pipe.send((None, error))
