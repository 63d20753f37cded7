"""A follower that was told nothing of its environment, and learns it there."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from .follower import Follower, Observation


class Newcomer:
    """Drives as a follower that it makes for the environment in which it finds itself.

    `rollout` tells it the environment's interface. Who steps an environment alone need not: number of beams and kind of
    drive are seen in an observation, the other scales, and the laser's field of view, are then those by default.

    Args:
        make: Makes a follower for an interface; called once at once, so that what cannot be made is told.
    """

    def __init__(self, make: Callable[[FollowInterface], Follower]) -> None:
        self._make, self._interface = make, FollowInterface()
        self.follower = make(self._interface)

    def learn_interface(self, interface: FollowInterface) -> None:
        """Take the scales of an environment; what was remembered of another one is forgotten."""
        if not _same_scales(interface, self._interface):
            self._interface, self.follower = interface, self._make(interface)

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self.follower.reset()

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action for one observation, within [-1, 1]: shape (2,), or (3,) for a holonomic robot."""
        beams, holonomic = len(observation["scan"]), len(observation["velocity"]) == 3
        known = self._interface
        if (beams, holonomic) != (len(known.bearings), known.holonomic):
            bearings = np.linspace(known.bearings[0], known.bearings[-1], beams)
            self.learn_interface(replace(known, bearings=bearings, holonomic=holonomic))
        return self.follower.act(observation)


def _same_scales(one: FollowInterface, other: FollowInterface) -> bool:
    """Return whether a follower need not tell two interfaces apart; the directions of beams but for rounding."""
    plain = ("max_speed", "max_turn_rate", "control_hz", "holonomic", "range_max", "T_robot_lidar")
    if any(getattr(one, name) != getattr(other, name) for name in plain):
        return False
    a, b = one.bearings, other.bearings
    return len(a) == len(b) and bool(np.abs(a - b).max(initial=0.0) < 1e-9)
