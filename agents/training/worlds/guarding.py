"""The safety filter of many worlds at once, on the processor or a GPU: the kernel of `learned.braking` for each.

It goes by the returns of the present scan. What the laser has lost behind the robot, which `learned.guard` remembers,
it does not mind: in training a contact there is a lesson.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import cuda
from numpy.typing import NDArray
from torch import Tensor

from ....envs.task.interface import FollowInterface
from ...learned.braking import MOST_WISHES, GuardNumbers, guard_world, guard_worlds
from ...learned.guard import GuardConfig
from ...learned.steering import SteeringConfig
from ...scripted.scan_points import MOST_BEAMS

Array = NDArray[np.float64]
THREADS = 64
"""Of a block of a GPU."""


class WorldsGuard:
    """Lets pass what can be braked.

    Args:
        config: What is guarded.
        interface: Scales of the environment.
        count: How many worlds.
        device: "cpu" or "cuda".
    """

    def __init__(self, config: GuardConfig, interface: FollowInterface, count: int, device: str) -> None:
        self._device, self._robot = device, config.of(interface)
        self._every = max(1, len(interface.bearings) // MOST_BEAMS)
        bearings = interface.bearings[:: self._every] + interface.T_robot_lidar[2]
        directions = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
        rows = 1 if device == "cpu" else count
        self._directions = self._here(directions)
        self._things = self._here(np.empty((rows, len(bearings), 5)))
        self._wishes = self._here(np.empty((rows, MOST_WISHES, 3)))

    def limit(self, commanded: Tensor, wishes: Tensor, seen: Mapping[str, Tensor], steering: SteeringConfig) -> Tensor:
        """Return (n, 2) the wishes, or the nearest that can be braked: speed [m/s] and turn rate [rad/s].

        Args:
            commanded: (n, 4) what is commanded now.
            wishes: (n, 2).
            seen: The observations: `scan` (n, beams), `leader` (n, 6), `people` (n, m, 6).
            steering: How wishes are driven.
        """
        limited = wishes.clone()
        rows = commanded, limited, seen["scan"][:, :: self._every], seen["leader"], seen["people"]
        given: list[Any] = [_array(tensor) for tensor in rows]
        given += [self._directions, self._here(np.array(steering.as_tuple())), self._robot]
        if self._device == "cpu":
            guard_worlds(*given, self._things[0], self._wishes[0])  # pyright: ignore[reportCallIssue]
        else:
            blocks = (len(wishes) + THREADS - 1) // THREADS
            guard_on_gpu[blocks, THREADS](*given, self._things, self._wishes)
        return limited

    def _here(self, values: Array) -> Any:
        return values if self._device == "cpu" else cuda.to_device(values)


def _array(tensor: Tensor) -> Any:
    """Return the array that a tensor is, without a copy."""
    return tensor.numpy() if tensor.device.type == "cpu" else cuda.as_cuda_array(tensor.contiguous())


def _guard(
    states: Array,
    wanted: Array,
    scans: Array,
    leaders: Array,
    people: Array,
    directions: Array,
    steering: Array,
    robot: GuardNumbers,
    things: Array,
    wishes: Array,
) -> None:
    w = cuda.grid(1)  # pyright: ignore[reportCallIssue]
    if w < len(wanted):
        guard_world(
            states[w], wanted[w], scans[w], leaders[w], people[w], directions, steering, robot, things[w], wishes[w]
        )  # fmt: skip


guard_on_gpu: Any = cuda.jit(cache=True)(_guard)
"""`braking.guard_worlds`, a thread each; things and wishes are scratch of each."""
