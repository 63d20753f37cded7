"""One episode of a follower in an environment."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, runtime_checkable

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..follow_config import FollowConfig
from ..follow_env import FollowEnv
from ..metrics import episode_metrics
from ..metrics.history import History
from ..task.interface import FollowInterface
from .recorder import Recorder


class Acting(Protocol):
    """Whoever acts in an environment, e.g. a follower of `tagalong.agents`."""

    def reset(self) -> None:
        """Forget the last episode."""
        ...

    def act(self, observation: Any) -> NDArray[np.float32]:
        """Return the action for one observation."""
        ...


@runtime_checkable
class Learning(Protocol):
    """Who acts, and takes what it has to know about the environment from it."""

    def learn_interface(self, interface: FollowInterface) -> None:
        """Take the scales of the environment."""
        ...


@dataclass(frozen=True, eq=False)
class Episode:
    """A finished (or cut) episode.

    Attributes:
        history: What happened, row by row.
        ending: Why it ended: "collision_person", "collision_static", "leader_lost", "tour_done", "covered"; "" if it
            was cut.
        seed: The seed it was started with.
        config: The environment's configuration.
        options: The options of its `reset`.
    """

    history: History
    ending: str
    seed: int | None
    config: FollowConfig
    options: dict[str, Any]

    @cached_property
    def metrics(self) -> dict[str, float]:
        """Every figure by name, from the history alone; see `tagalong.envs.metrics`."""
        return episode_metrics(self.history)

    @property
    def total_reward(self) -> float:
        """Sum of the rewards."""
        return float(self.history.reward.sum())


def rollout(
    env: gym.Env,
    follower: Acting,
    *,
    seed: int | None = None,
    steps: int | None = None,
    options: dict[str, Any] | None = None,
    after_step: Callable[[FollowEnv], None] | None = None,
) -> Episode:
    """Run one episode and return what happened.

    Args:
        env: A `FollowEnv`, wrapped or not; wrappers see every step.
        follower: Acts; it is reset first, and told `env.unwrapped.interface` if it has `learn_interface(interface)`.
        seed: Seed of the episode; None continues the environment's generator.
        steps: Most steps, at least 1; None runs until the episode ends.
        options: Options of `reset`.
        after_step: Called after `reset` and after each step, e.g. to render.

    Raises:
        InputError: If `env` is not a `FollowEnv` inside, or `steps` is not positive.
    """
    inner = env.unwrapped
    if not isinstance(inner, FollowEnv):
        raise InputError(f"`rollout` needs a FollowEnv, got {inner!r}")
    if steps is not None and steps < 1:
        raise InputError(f"`steps` must be at least 1, got {steps}")
    observation, _ = env.reset(seed=seed, options=options)
    if isinstance(follower, Learning):
        follower.learn_interface(inner.interface)
    follower.reset()
    recorder, done, info, taken = Recorder(inner), False, {"ending": ""}, 0
    notify = after_step or (lambda _: None)
    try:
        notify(inner)
        while not done and (steps is None or taken < steps):
            observation, _, terminated, truncated, info = env.step(follower.act(observation))
            notify(inner)
            done, taken = terminated or truncated, taken + 1
    finally:
        recorder.stop()
    return Episode(recorder.history(), info["ending"], seed, inner.config, dict(options or {}))
