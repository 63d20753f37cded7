"""Worlds on a GPU for libraries of learning: tensors of torch in and out, which stay there."""

from typing import Any

import torch
from gymnasium.vector import AutoresetMode
from torch import Tensor

from ...envs import CudaVectorEnv
from ...envs.compiled.infos import SUCCESSES, observations, table_of, terms_of
from ...envs.compiled.state import Told
from ...slam.errors import InputError

DEVICE = "cuda"


class TensorVectorEnv:
    """A `CudaVectorEnv` that is told and tells in tensors on the GPU.

        env = gymnasium.make_vec("tagalong/Office-v0", 16384, "vector_entry_point", simulator="cuda")
        env = TensorVectorEnv(env)
        observation, info = env.reset(seed=0)
        observation, reward, terminated, truncated, info = env.step(torch.zeros(16384, 2, device="cuda"))

    Infos have the names of `CompiledVectorEnv`, each a tensor over all worlds, without Gymnasium's masks; `ending` is
    the number of the reason in `tagalong.envs.task.endings.REASONS`, 0 while the episode lasts. With autoreset
    "SameStep", `final_obs` and `final_info` are such tables of all worlds as they were before, and `_final_obs`
    (num_envs,) says whose episode has ended. Of what is told one byte a world comes to the processor.

    Args:
        env: The environment.

    Raises:
        InputError: If it is of another simulator.
    """

    def __init__(self, env: Any) -> None:
        worlds = env.unwrapped
        if not isinstance(worlds, CudaVectorEnv):
            raise InputError(f'tensors on the GPU need simulator="cuda", got a {type(worlds).__name__}')
        self.env, self.num_envs = worlds, worlds.num_envs
        self.single_observation_space, self.single_action_space = (
            worlds.single_observation_space,
            worlds.single_action_space,
        )
        self.interface, self.metadata = worlds.interface, worlds.metadata
        self._good = torch.as_tensor(SUCCESSES, device=DEVICE)

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[dict[str, Tensor], Any]:
        """Start episodes, as `CompiledVectorEnv.reset`; return observations and infos of all worlds."""
        self.env.reset(seed=seed, options=options)
        return self._seen(), self._infos()

    def step(self, actions: Tensor) -> tuple[dict[str, Tensor], Tensor, Tensor, Tensor, dict[str, Any]]:
        """Drive all worlds for one control period by `actions` (num_envs, a); return what `step` of Gymnasium does.

        Raises:
            InputError: If the actions have another shape, or an episode is over that is not followed.
        """
        wanted = torch.as_tensor(actions, dtype=torch.float64, device=DEVICE).detach().contiguous()
        shape = (self.num_envs, *(self.single_action_space.shape or ()))
        if tuple(wanted.shape) != shape:
            raise InputError(f"actions have shape {shape}, got {tuple(wanted.shape)}")
        self.env.drive(wanted)
        told = self._told()
        judged = told.reward.clone(), told.terminated.clone(), told.truncated.clone()
        if self.metadata["autoreset_mode"] != AutoresetMode.SAME_STEP or not self.env.ended.any():
            return self._seen(), *judged, self._infos()
        final = {"final_obs": self._seen(), "final_info": self._infos(), "_final_obs": judged[1] | judged[2]}
        self.env.begin_ended()
        return self._seen(), *judged, {**self._infos(), **final}

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def _seen(self) -> dict[str, Tensor]:
        seen: dict[str, Any] = observations(self._told())
        return {name: values.clone() for name, values in seen.items()}

    def _infos(self) -> dict[str, Any]:
        told = self._told()
        table: dict[str, Any] = {name: values.clone() for name, values in table_of(told).items()}
        return {**table, "is_success": self._good[table["ending"]], "reward_terms": terms_of(told.terms.clone())}

    def _told(self) -> Any:
        """Return what is told as tensors in the place of the arrays, which the next step overwrites.

        Whole arrays become tensors, and a column is taken from the tensor: numba looks at every row of a column of its
        own arrays, 0.1 s a time for 65,536 worlds.
        """
        return Told._make(torch.as_tensor(values, device=DEVICE) for values in self.env.told)
