"""What of stable-baselines3's `VecEnv` makes no sense where the environments are one whole."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
from stable_baselines3.common.vec_env.base_vec_env import VecEnv


class WholeVecEnv(VecEnv):
    """A `VecEnv` without single environments: nobody can call into one of them, none is wrapped."""

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Refuse: there are no single environments.

        Raises:
            NotImplementedError: Always.
        """
        raise NotImplementedError(f"the environments of {type(self).__name__} have no method {method_name}")

    def env_is_wrapped(self, wrapper_class: type[gym.Wrapper], indices: Any = None) -> list[bool]:
        """Return for each environment whether it is wrapped in `wrapper_class`: never."""
        return [False for _ in self._get_indices(indices)]

    def _get_indices(self, indices: Any) -> Sequence[int]:
        return super()._get_indices(indices)  # pyright: ignore[reportReturnType]
