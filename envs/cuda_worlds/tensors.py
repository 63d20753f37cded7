"""Compiled worlds on a GPU whose observations, rewards and infos stay there, as tensors of torch."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numba import cuda
from numpy.typing import NDArray

from ...slam.errors import InputError, MissingExtraError
from ..compiled.episodes import BEGIN_AGAIN, REST, STEP
from ..compiled.infos import SUCCESSES, observations, table_of, terms_of
from .vector_env import CudaVectorEnv

DEVICE = "cuda"


class TensorVectorEnv(CudaVectorEnv):
    """`CudaVectorEnv` that tells all in tensors of torch on the GPU: `simulator="cuda", output="torch"`.

    Of what is told nothing but one byte a world comes to the processor. `step` takes a tensor (num_envs, a). Infos have
    the names of `CompiledVectorEnv`, each a tensor over all worlds, without Gymnasium's masks; `ending` is the number
    of the reason in `task.endings.REASONS`, 0 while the episode lasts. With autoreset "SameStep", `final_obs` and
    `final_info` are such tables of all worlds as they were before, and `_final_obs` (num_envs,) says whose episode has
    ended.

    Raises:
        InputError: As `CudaVectorEnv`.
        MissingExtraError: Without torch.
    """

    def __init__(self, num_envs: int = 1, **arguments: Any) -> None:
        try:
            import torch
        except ImportError:
            raise MissingExtraError("tensors", "learn") from None
        super().__init__(num_envs, **arguments)
        self._torch = torch
        self._good = torch.as_tensor(SUCCESSES, device=DEVICE)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start episodes, as `CompiledVectorEnv.reset`; return tensors, infos of all worlds."""
        super().reset(seed=seed, options=options)
        return self._seen(), self._infos()

    def step(self, actions: Any) -> tuple[dict[str, Any], Any, Any, Any, dict[str, Any]]:
        """Drive all worlds for one control period by `actions`, a tensor (num_envs, a); return tensors.

        Raises:
            InputError: If the actions have another shape, or an episode is over that is not followed.
        """
        self._require_open()
        wanted = self._on_gpu(actions)
        mode, ended = self.metadata["autoreset_mode"], self._state.ended.copy()
        if mode == AutoresetMode.DISABLED and ended.any():
            raise InputError(f"the episode of environment {int(np.flatnonzero(ended)[0])} has ended: reset it first")
        self._move(np.where(ended, BEGIN_AGAIN, STEP).astype(np.int8), wanted)
        told, ended = self._told_there, self._state.ended.copy()
        judged = tuple(self._tensor(values) for values in (told.reward, told.terminated, told.truncated))
        if mode != AutoresetMode.SAME_STEP or not ended.any():
            return self._seen(), *judged, self._infos()
        final = {"final_obs": self._seen(), "final_info": self._infos(), "_final_obs": judged[1] | judged[2]}
        self._move(np.where(ended, BEGIN_AGAIN, REST).astype(np.int8), wanted)
        return self._seen(), *judged, {**self._infos(), **final}

    def _run(self, what: NDArray[np.int8], actions: NDArray[np.float64]) -> None:
        self._move(what, cuda.to_device(actions))

    def _on_gpu(self, actions: Any) -> Any:
        wanted = self._torch.as_tensor(actions, dtype=self._torch.float64, device=DEVICE).contiguous()
        if tuple(wanted.shape) != self.action_space.shape:
            raise InputError(f"actions have shape {self.action_space.shape}, got {tuple(wanted.shape)}")
        return cuda.as_cuda_array(wanted.detach())

    def _tensor(self, values: Any) -> Any:
        """Return a copy of an array on the GPU as a tensor."""
        return self._torch.as_tensor(values, device=DEVICE).clone()

    def _seen(self) -> dict[str, Any]:
        return {name: self._tensor(values) for name, values in observations(self._told_there).items()}

    def _infos(self) -> dict[str, Any]:
        told = {name: self._tensor(values) for name, values in table_of(self._told_there).items()}
        told["is_success"] = self._good[told["ending"]]
        terms = self._tensor(self._told_there.terms)
        told["reward_terms"] = terms_of(terms)
        return told
