"""Arrays of worlds on the GPU, and their way there and back."""

from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import NDArray

from ..compiled.plans import Plans
from ..compiled.rules import Rules
from ..compiled.state import Scratch, Told, WorldsState
from .kernel import THREADS, step_on_gpu


def on_gpu(values: Any) -> Any:
    """Return a NamedTuple whose arrays are copied to the GPU; numbers in it stay what they are."""
    if isinstance(values, np.ndarray):
        return cuda.to_device(values)
    if hasattr(values, "_fields"):
        return type(values)(*(on_gpu(value) for value in values))
    return values


def fetch(there: Any, here: Any) -> None:
    """Copy the arrays of a NamedTuple on the GPU into those of its twin `here`."""
    if isinstance(here, np.ndarray):
        if here.size > 0:
            there.copy_to_host(here)
    elif hasattr(here, "_fields"):
        for one, other in zip(there, here, strict=True):
            fetch(one, other)


def _room_for(shape: tuple[int, ...], kind: Any) -> Any:
    """Return an array on the GPU; its numbers are any."""
    return cuda.device_array(shape, kind)


def _room_of_each(values: Any, worlds: int) -> Any:
    """Return room on the GPU for the arrays of a NamedTuple, once for each world."""
    if hasattr(values, "_fields"):
        return type(values)(*(_room_of_each(value, worlds) for value in values))
    return _room_for((worlds, *values.shape), values.dtype)


class GpuWorlds:
    """Worlds as they lie on the GPU.

    Args:
        rules: What never changes.
        plans: The episodes.
        state: All worlds.
        told: What is told of them.
        room: Scratch of one thread.
    """

    def __init__(self, rules: Rules, plans: Plans, state: WorldsState, told: Told, room: Scratch) -> None:
        self.told: Any = on_gpu(told)
        self._state: Any = on_gpu(state)
        self._rules, self._plans = on_gpu(rules), on_gpu(plans)
        worlds = len(state.slot)
        self._room: Any = _room_of_each(room, worlds)
        self._what = _room_for((worlds,), np.int8)
        self._blocks = -(-worlds // THREADS)

    def step(self, what: NDArray[np.int8], actions: Any) -> None:
        """Do `what` (w,) in all worlds, with `actions` (w, a) on the GPU."""
        self._what.copy_to_device(what)
        step_on_gpu[self._blocks, THREADS](
            self._what, actions, self._rules, self._plans, self._state, self.told, self._room
        )

    def fetch_state(self, state: WorldsState) -> None:
        """Copy the state of all worlds into arrays of the processor."""
        fetch(self._state, state)

    def fetch_ended(self, ended: NDArray[np.bool_]) -> None:
        """Copy which episodes are over (w,)."""
        fetch(self._state.ended, ended)
