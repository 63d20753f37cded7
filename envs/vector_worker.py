"""One process's share of a vector environment."""

from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers import TimeLimit

from ..slam.errors import InputError
from .follow_env import FollowEnv

Row = tuple[Any, float, bool, bool, dict[str, Any], Any, dict[str, Any] | None]
"""Observation, reward, terminated, truncated, info, and of an episode that ended in this step its last observation and
info where the next one has begun already."""


class Share:
    """Some environments that are stepped one after the other.

    Args:
        count: How many.
        mode: When an ended episode is followed by the next.
        max_episode_steps: Steps after which an episode is truncated; None never.
        fields: Keyword arguments of `FollowEnv`.
    """

    def __init__(self, count: int, mode: AutoresetMode, max_episode_steps: int | None, fields: dict[str, Any]) -> None:
        single = [FollowEnv(**fields) for _ in range(count)]
        self._envs = [TimeLimit(env, max_episode_steps) if max_episode_steps else env for env in single]
        self._mode = mode
        self._ended = np.zeros(count, dtype=bool)

    def reset(self, seeds: list[int | None], options: dict[str, Any] | None, chosen: list[bool]) -> list[Any]:
        """Return (observation, info) of each environment that is `chosen`, None of the others."""
        results: list[Any] = []
        for i, (env, seed, wanted) in enumerate(zip(self._envs, seeds, chosen, strict=True)):
            self._ended[i] = self._ended[i] and not wanted
            results.append(env.reset(seed=seed, options=options) if wanted else None)
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
            observation, info = env.reset()
            return observation, 0.0, False, False, info, None, None
        observation, reward, terminated, truncated, info = env.step(action)
        ended = terminated or truncated
        if ended and self._mode == AutoresetMode.SAME_STEP:
            last, last_info = observation, info
            observation, info = env.reset()
            return observation, reward, terminated, truncated, info, last, last_info
        self._ended[i] = ended
        return observation, reward, terminated, truncated, info, None, None


def work(
    pipe: Connection, count: int, mode: AutoresetMode, max_episode_steps: int | None, fields: dict[str, Any]
) -> None:
    """Do what comes through `pipe`, (name of a method of `Share`, its arguments), until None comes.

    Answers are (result, None), or (None, error).
    """
    share = Share(count, mode, max_episode_steps, fields)
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
