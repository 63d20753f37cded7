"""Compiled worlds on a GPU, as a Gymnasium vector environment."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numba import cuda
from numpy.typing import NDArray

from ...slam.errors import InputError
from ..compiled.episodes import BEGIN_AGAIN, REST, STEP
from ..compiled.state import Told, arrays_of
from ..compiled.vector_env import CompiledVectorEnv, telling
from .memory import GpuWorlds, fetch


class CudaVectorEnv(CompiledVectorEnv):
    """`CompiledVectorEnv` on a GPU: `simulator="cuda"`. It takes some thousand worlds to pay.

    The kernels are those of the processor, compiled once more; each thread steps a world. Its random numbers are a
    world's own, the same beside any others. A GPU rounds otherwise than a processor in the last digit, so that people
    and noise drift from the processor's as they do in drives with other noise.

    With `people="truth"` or "modelled"; "tracker" makes arrays as it goes, which a GPU's kernels cannot.

    `reset` and `step` take and return arrays of the processor. `drive` and `begin_ended` leave all on the GPU, for
    `tagalong.agents.TensorVectorEnv`, or a library of your own that reads `__cuda_array_interface__`.

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
        if self.config.reward.terms:
            raise InputError(
                'simulator="cuda" does not support `reward.terms`: nobody can call them on a GPU; "compiled" does'
            )
        self._gpu: GpuWorlds | None = None

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """Start episodes, as `CompiledVectorEnv.reset`; the worlds come to the processor and go back."""
        if self._gpu is not None:
            self._gpu.fetch_state(self._state)
            fetch(self._gpu.told, self._told)
            self._gpu = None
        return super().reset(seed=seed, options=options)

    def drive(self, actions: Any) -> None:
        """Do as `step` with actions on the GPU; what came of it is in `told`, and is not fetched.

        With autoreset "NextStep" whose episode has ended begins another one. With "SameStep" call `begin_ended` next.

        Args:
            actions: (num_envs, a) of 64 bits and finite, anything with `__cuda_array_interface__`.

        Raises:
            InputError: If an episode has ended and is not followed.
        """
        self._require_open()
        ended = self._state.ended
        if self.metadata["autoreset_mode"] == AutoresetMode.DISABLED and ended.any():
            raise InputError(f"the episode of environment {int(np.flatnonzero(ended)[0])} has ended: reset it first")
        self._move(np.where(ended, BEGIN_AGAIN, STEP).astype(np.int8), cuda.as_cuda_array(actions))

    def begin_ended(self) -> None:
        """Begin another episode where one has ended."""
        nothing = cuda.to_device(np.zeros(self.action_space.shape or ()))
        self._move(np.where(self._state.ended, BEGIN_AGAIN, REST).astype(np.int8), nothing)

    @property
    def told(self) -> Told:
        """What the last step told of all worlds, as arrays on the GPU, which the next one overwrites."""
        if self._gpu is None:
            raise InputError("nothing is told before the first reset")
        return self._gpu.told

    @property
    def ended(self) -> NDArray[np.bool_]:
        """(num_envs,) whose episode is over."""
        return self._state.ended.copy()

    def _run(self, what: NDArray[np.int8], actions: NDArray[np.float64]) -> None:
        """Do `what` (num_envs,) in all worlds, and fetch what is told."""
        self._move(what, cuda.to_device(actions))
        fetch(self.told, self._told)

    def _move(self, what: NDArray[np.int8], actions: Any) -> None:
        """Do the same with actions that lie on the GPU, and leave there what is told."""
        if self._gpu is None:
            self._gpu = GpuWorlds(self._rules, self._pool.plans_in_use, self._state, self._told, self._room())
        if self._begun:
            self._gpu.step(what, actions)
        else:  # the first call may compile
            telling(self._gpu.step, what, actions)
        self._gpu.fetch_ended(self._state.ended)

    @property
    def memory(self) -> int:
        """Memory of episodes, state, what is told and scratch, on the GPU [bytes]."""
        return super().memory + self.num_envs * sum(array.nbytes for array in arrays_of(self._room()))
