"""Compiled worlds on a GPU, as a Gymnasium vector environment of numpy arrays, or of torch's tensors."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..compiled.vector_env import CompiledVectorEnv, telling
from .memory import GpuWorlds, fetch


class CudaVectorEnv(CompiledVectorEnv):
    """`CompiledVectorEnv` on a GPU: `simulator="cuda"`. It takes some thousand worlds to pay.

    The kernels are those of the processor, compiled once more; each thread steps a world. Same seed, same bytes, for a
    world beside any others; but a GPU rounds otherwise than a processor (a product and a sum at once), so that a drive
    is the processor's at first, and drifts from it as two drives with other noise do.

    With `people="truth"` or "modelled"; "tracker" makes arrays as it goes, which a GPU's kernels cannot.

    Args:
        num_envs: How many worlds.
        arguments: Those of `CompiledVectorEnv`, but `workers`.

    Raises:
        InputError: If an argument is wrong, or there is no GPU that numba-cuda can use.
    """

    def __init__(self, num_envs: int = 1, **arguments: Any) -> None:
        if "workers" in arguments:
            raise InputError('`workers` are threads of a processor: simulator="cuda" has none')
        if not cuda.is_available():
            raise InputError(
                'simulator="cuda" needs an NVIDIA GPU, its driver and numba-cuda (pip install "tagalong[cuda]"), '
                'and found none; "compiled" does the same on the processor'
            )
        super().__init__(num_envs, workers=1, **arguments)
        if self._rules.tracked:
            raise InputError('simulator="cuda" does not support people="tracker": take "modelled", or "compiled"')
        self._gpu: GpuWorlds | None = None

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Start episodes, as `CompiledVectorEnv.reset`; the worlds come to the processor and go back."""
        if self._gpu is not None:
            self._gpu.fetch_state(self._state)
            fetch(self._gpu.told, self._told)
            self._gpu = None
        return super().reset(seed=seed, options=options)

    def _run(self, what: NDArray[np.int8], actions: NDArray[np.float64]) -> None:
        """Do `what` (num_envs,) in all worlds."""
        self._move(what, cuda.to_device(actions))
        fetch(self._told_there, self._told)

    def _move(self, what: NDArray[np.int8], actions: Any) -> None:
        """Do the same with actions that lie on the GPU, and leave there what is told."""
        if self._gpu is None:
            self._gpu = GpuWorlds(self._rules, self._pool.plans, self._state, self._told, self._room())
        if self._begun:
            self._gpu.step(what, actions)
        else:  # the first call may compile
            telling(self._gpu.step, what, actions)
        self._gpu.fetch_ended(self._state.ended)

    @property
    def _told_there(self) -> Any:
        """What is told, on the GPU."""
        assert self._gpu is not None
        return self._gpu.told

    @property
    def memory(self) -> int:
        """Memory of episodes, state, what is told and scratch, on the GPU [bytes]."""
        return super().memory + self.num_envs * sum(array.nbytes for array in self._room())
