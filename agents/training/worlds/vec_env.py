"""Compiled worlds of several kinds as stable-baselines3 wants them: pooled observations, wishes for actions."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvStepReturn

from ....envs.compiled.vector_env import CompiledVectorEnv
from ....envs.wrappers.pooled_observation import PooledVectorObservation
from ...learned.steering import steer_many
from .preset import WorldKind, WorldsPreset

Floats = NDArray[np.float32]


class WorldsVecEnv(VecEnv):
    """Worlds of all kinds of a preset.

    The action is the wish that `SteeringConfig` describes. A tour that is done counts as cut short, not as an end: the
    value of what would have followed is not lost, or the policy would learn to linger before the end.

    Args:
        preset: Which worlds, and how they are driven.
        seed: Of the buildings that are drawn, and of the episodes.
        workers: Threads that step the worlds; the same bytes for any number.
    """

    def __init__(self, preset: WorldsPreset, seed: int, workers: int) -> None:
        self._preset, self._seed = preset, seed
        self._parts = [_part(kind, preset, seed + k, workers) for k, kind in enumerate(preset.kinds)]
        interface = self._parts[0].env.interface  # pyright: ignore[reportAttributeAccessIssue]
        edges = np.cumsum([0, *(kind.count for kind in preset.kinds)]).tolist()
        self._slices = [slice(a, b) for a, b in pairwise(edges)]
        space = self._parts[0].single_observation_space
        super().__init__(preset.worlds, space, spaces.Box(-1.0, 1.0, (2,), np.float32))
        self._scales = np.array((interface.max_speed, interface.max_turn_rate))
        self._step_s = 1.0 / interface.control_hz
        self.begin_share(0.0)
        self._state, self._wishes = np.zeros((preset.worlds, 4)), np.zeros((preset.worlds, 2))
        self._returns, self._lengths = np.zeros(preset.worlds), np.zeros(preset.worlds, dtype=np.int64)

    def begin_with(self, seed: int) -> None:
        """Take the seed of the episodes that the next `reset` begins; buildings stay as they were drawn."""
        self._seed = seed

    def begin_share(self, share: float) -> None:
        """Drive as the preset wants it after this share of the training's steps."""
        self._steering, self._smooth = self._preset.steering_at(share), self._preset.smooth_at(share)

    def reset(self) -> Floats:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Start an episode in every world."""
        self._state[:], self._returns[:], self._lengths[:] = 0.0, 0.0, 0
        seeds = [int(s) for s in np.random.default_rng((self._seed, 1)).integers(2**62, size=len(self._parts))]
        return np.concatenate([part.reset(seed=s)[0] for part, s in zip(self._parts, seeds, strict=True)])

    def step_async(self, actions: NDArray[np.floating]) -> None:
        """Keep the network's outputs (n, 2)."""
        c = self._preset.steering
        half, middle = 0.5 * (c.max_speed + c.reverse_speed), 0.5 * (c.max_speed - c.reverse_speed)
        cut = np.clip(actions, -1.0, 1.0).astype(np.float64)
        self._wishes = np.stack((middle + half * cut[:, 0], c.max_turn_rate * cut[:, 1]), axis=1)

    def step_wait(self) -> VecEnvStepReturn:
        """Drive for one step; infos as of `SB3VecEnv`, with `kind`, the number of the world's kind."""
        before = self._state
        self._state = steer_many(before, self._wishes, self._step_s, self._steering)
        actions = (self._state[:, (0, 2)] / self._scales).astype(np.float32)
        told = [part.step(actions[rows]) for part, rows in zip(self._parts, self._slices, strict=True)]
        observations = np.concatenate([one[0] for one in told])
        ended = np.concatenate([one[2] | one[3] for one in told])
        rewards = np.concatenate([one[1] for one in told]) - self._jerk_cost(before)
        rewards -= np.where(ended, 0.0, self._clearance_cost(observations))
        self._returns += rewards
        self._lengths += 1
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for k, (rows, (_, _, terminated, truncated, info)) in enumerate(zip(self._slices, told, strict=True)):
            for j in np.flatnonzero(terminated | truncated).tolist():
                infos[rows.start + j] = {"kind": k, **self._end(rows.start + j, j, info)}
        self._returns[ended], self._lengths[ended], self._state[ended] = 0.0, 0, 0.0
        return observations, (rewards * self._preset.reward_scale).astype(np.float32), ended, infos  # pyright: ignore[reportReturnType]

    def _jerk_cost(self, before: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (n,) what the jerk of the last step costs; `before` (n, 4) was commanded before it."""
        jerk = (self._state - before)[:, (1, 3)] / self._step_s
        cost = self._preset.jerk * jerk[:, 0] ** 2 + self._preset.turn_jerk * jerk[:, 1] ** 2
        return self._smooth * cost

    def _clearance_cost(self, observations: Floats) -> NDArray[np.float64]:
        """Return (n,) what the nearest return of the laser costs."""
        pooled = self._preset.pooled
        gap = -pooled.gap_scale * np.log(observations[:, : pooled.sectors].max(axis=1).astype(np.float64))
        return self._preset.clearance * np.maximum(1.0 - gap / self._preset.clearance_m, 0.0) ** 2

    def _end(self, row: int, j: int, info: dict[str, Any]) -> dict[str, Any]:
        final = info["final_info"]
        ending, success = str(final["ending"][j]), bool(final["is_success"][j])
        return {
            "terminal_observation": info["final_obs"][j],
            "TimeLimit.truncated": success or not ending,
            "is_success": success,
            "ending": ending,
            "episode": {"r": float(self._returns[row]), "l": int(self._lengths[row]), "t": 0.0},
        }

    def close(self) -> None:
        """End the threads."""
        for part in self._parts:
            part.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the whole, once for each world."""
        return [getattr(self, attr_name, None) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the whole."""
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Refuse: there are no single environments."""
        raise NotImplementedError(f"the worlds of {type(self).__name__} have no method {method_name}")

    def env_is_wrapped(self, wrapper_class: type[gym.Wrapper], indices: Any = None) -> list[bool]:
        """Return for each world whether it is wrapped in `wrapper_class`: never."""
        return [False for _ in self._get_indices(indices)]

    def _get_indices(self, indices: Any) -> Sequence[int]:
        return super()._get_indices(indices)  # pyright: ignore[reportReturnType]


def _part(kind: WorldKind, preset: WorldsPreset, seed: int, workers: int) -> PooledVectorObservation:
    env = CompiledVectorEnv(
        kind.count, workers=min(workers, kind.count), max_episode_steps=preset.most_steps, autoreset_mode="SameStep",
        episodes_ahead=kind.episodes, episodes_seed=seed,
        **{"scene": kind.name, "people_count": kind.people, **preset.env},
    )  # fmt: skip
    return PooledVectorObservation(env, preset.pooled)
