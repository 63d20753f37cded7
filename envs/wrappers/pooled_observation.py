"""Gymnasium wrappers that tell a network what an environment shows, pooled."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.utils import RecordConstructorArgs
from gymnasium.vector import AutoresetMode, VectorEnv, VectorWrapper
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ..task.interface import FollowInterface
from .pooled_config import LIMIT, PooledConfig
from .pooled_features import PooledFeatures

Floats = NDArray[np.float32]


class PooledObservation(gym.Wrapper[Any, Any, Any, Any], RecordConstructorArgs):
    """Tells one vector, `PooledConfig().names`, instead of the environment's dictionary.

        env = PooledObservation(gymnasium.make("tagalong/Office-v0", slam=None))

    Args:
        env: A follow environment with a leader.
        config: What is told.

    Raises:
        InputError: If nobody leads there.
    """

    def __init__(self, env: gym.Env[Any, Any], config: PooledConfig | None = None) -> None:
        RecordConstructorArgs.__init__(self, config=config)
        gym.Wrapper.__init__(self, env)
        interface = env.get_wrapper_attr("interface")
        _require_leader(env.observation_space)
        self._features = PooledFeatures(config or PooledConfig(), interface)
        self.observation_space = _space(self._features)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, dict[str, Any]]:
        """Start an episode, and forget the one before."""
        observation, info = self.env.reset(seed=seed, options=options)
        return self._features.begin(_batch(observation))[0], info

    def step(self, action: Any) -> tuple[Floats, float, bool, bool, dict[str, Any]]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Drive for one step."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        told = self._features.update(_batch(observation), np.asarray(action)[None])[0]
        return told, float(reward), terminated, truncated, info


class PooledVectorObservation(VectorWrapper):
    """Does the same for a vector environment, of either simulator and any `autoreset_mode`.

        env = PooledVectorObservation(
            gymnasium.make_vec("tagalong/Office-v0", 256, "vector_entry_point", simulator="compiled")
        )

    Where episodes are followed in the same step, `final_obs` of info holds vectors, too.

    Args:
        env: The environment, with a leader.
        config: What is told.

    Raises:
        InputError: If nobody leads there.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any], config: PooledConfig | None = None) -> None:
        super().__init__(env)
        _require_leader(env.single_observation_space)
        interface: FollowInterface = env.interface  # pyright: ignore[reportAttributeAccessIssue]
        self._features = PooledFeatures(config or PooledConfig(), interface, env.num_envs)
        self._single_observation_space = _space(self._features)
        self._observation_space = batch_space(self._single_observation_space, env.num_envs)
        self._mode = AutoresetMode(env.metadata["autoreset_mode"])
        self._ended: NDArray[np.bool_] = np.zeros(env.num_envs, dtype=bool)
        self._told = np.zeros((env.num_envs, self._features.size), dtype=np.float32)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Start episodes in all worlds, or in those of `options["reset_mask"]`."""
        batch, info = self.env.reset(seed=seed, options=options)  # pyright: ignore[reportArgumentType]
        mask = (options or {}).get("reset_mask")
        rows = np.arange(self.num_envs) if mask is None else np.flatnonzero(mask)
        self._ended[rows] = False
        self._begin(batch, rows)
        return self._told.copy(), info

    def step(self, actions: Any) -> tuple[Floats, Any, Any, Any, dict[str, Any]]:
        """Drive all worlds for one step."""
        batch, rewards, terminated, truncated, info = self.env.step(actions)
        ended, actions = np.asarray(terminated | truncated), np.asarray(actions)
        if self._mode == AutoresetMode.SAME_STEP:
            info = self._follow_at_once(batch, actions, ended, info)
        else:
            begun = self._ended if self._mode == AutoresetMode.NEXT_STEP else np.zeros_like(ended)
            on, anew = np.flatnonzero(~begun), np.flatnonzero(begun)
            self._told[on] = self._features.update(_rows(batch, on), actions[on], on)
            self._begin(batch, anew)
            self._ended = ended
        return self._told.copy(), rewards, terminated, truncated, info

    def _begin(self, batch: dict[str, Any], rows: NDArray[np.intp]) -> None:
        self._told[rows] = self._features.begin(_rows(batch, rows), rows)

    def _follow_at_once(
        self, batch: dict[str, Any], actions: NDArray[Any], ended: NDArray[np.bool_], info: dict[str, Any]
    ) -> dict[str, Any]:
        """Tell how episodes end, then how the next ones begin; return info with what was told of the ends."""
        on, over = np.flatnonzero(~ended), np.flatnonzero(ended)
        self._told[on] = self._features.update(_rows(batch, on), actions[on], on)
        if not len(over):
            return info
        final = {name: np.stack([info["final_obs"][i][name] for i in over]) for name in batch}
        last = np.full(self.num_envs, None, dtype=object)
        for i, told in zip(over.tolist(), self._features.update(final, actions[over], over), strict=True):
            last[i] = told
        self._begin(batch, over)
        return {**info, "final_obs": last}


def _space(features: PooledFeatures) -> spaces.Box:
    return spaces.Box(-LIMIT, LIMIT, (features.size,), np.float32)


def _batch(observation: dict[str, Any]) -> dict[str, Any]:
    return {name: observation[name][None] for name in ("scan", "leader", "people", "velocity")}


def _rows(batch: dict[str, Any], rows: NDArray[np.intp]) -> dict[str, Any]:
    return {name: batch[name][rows] for name in ("scan", "leader", "people", "velocity")}


def _require_leader(space: Any) -> None:
    if not isinstance(space, spaces.Dict) or "leader" not in space.spaces:
        raise InputError(f"the pooled observation tells of a leader: the environment has none, got {shown(space)}")
