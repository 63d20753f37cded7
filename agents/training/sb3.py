"""Our vector environments for stable-baselines3, which does not know Gymnasium's."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from ...slam.errors import InputError, MissingExtraError

try:
    from stable_baselines3.common.vec_env.base_vec_env import VecEnvStepReturn

    from .whole import WholeVecEnv
except ImportError:
    raise MissingExtraError("environments of stable-baselines3", "learn") from None

Observations = dict[str, NDArray[Any]]


class SB3VecEnv(WholeVecEnv):
    """A vector environment of `gymnasium.make_vec` as stable-baselines3 wants it.

        env = gymnasium.make_vec(
            "tagalong/Office-v0", 256, "vector_entry_point", simulator="compiled", autoreset_mode="SameStep"
        )
        PPO("MultiInputPolicy", SB3VecEnv(env)).learn(10_000_000)

    Where an episode ends, its info has `terminal_observation`, `TimeLimit.truncated`, `is_success`, `ending`, and
    `episode` with the return `r` and the length `l`, from which stable-baselines3 makes its means; the infos of the
    others are empty.

    Args:
        env: The environment; its episodes must be followed in the same step.

    Raises:
        InputError: If they are not.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any]) -> None:
        mode = env.metadata.get("autoreset_mode")
        if mode != AutoresetMode.SAME_STEP:
            raise InputError(
                f'stable-baselines3 needs `autoreset_mode="SameStep"`, got {getattr(mode, "value", mode)!r}'
            )
        self.env, self.render_mode = env, env.render_mode
        self._seed: int | None = None
        self._returns, self._lengths = np.zeros(env.num_envs), np.zeros(env.num_envs, dtype=np.int64)
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)
        self._actions: NDArray[Any] = np.zeros(env.action_space.shape or ())

    def seed(self, seed: int | None = None) -> Sequence[int | None]:
        """Take a seed for the next `reset`; environment i gets `seed` + i."""
        self._seed = seed
        return [None if seed is None else seed + i for i in range(self.num_envs)]

    def reset(self) -> Observations:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Start an episode in every environment."""
        observations, _ = self.env.reset(seed=self._seed)
        self._seed = None
        self._returns[:], self._lengths[:] = 0.0, 0
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Keep the actions (num_envs, a)."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Drive for one step; see the class for the infos."""
        observations, rewards, terminated, truncated, told = self.env.step(self._actions)
        self._returns += rewards
        self._lengths += 1
        ended = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(ended).tolist():
            last, final = told["final_obs"], told["final_info"]
            infos[i] = {
                "terminal_observation": last[i],
                "TimeLimit.truncated": bool(truncated[i] and not terminated[i]),
                "is_success": bool(final["is_success"][i]),
                "ending": str(final["ending"][i]),
                "episode": {"r": float(self._returns[i]), "l": int(self._lengths[i]), "t": 0.0},
            }
        self._returns[ended], self._lengths[ended] = 0.0, 0
        return observations, rewards.astype(np.float32), ended, infos  # pyright: ignore[reportReturnType]

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the whole, once for each environment."""
        value = getattr(self.env, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Set an attribute of the whole."""
        setattr(self.env, attr_name, value)
