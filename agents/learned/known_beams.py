"""The laser that a policy was trained with, made of the one that a robot has."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ...slam.geometry import wrap_angle
from ..protocol.follower import Observation
from ..scripted.scan_points import scan_of

NOTHING = np.float32(1.0)
"""Reading of a beam that the robot's laser has not: no return."""
AHEAD = float(np.radians(30.0))
"""To either side of straight ahead the laser must look so far [rad]."""
_LEAST_SPACING = 1e-4


class KnownBeams:
    """Tells a scan as a laser of another field of view would: beams beyond it are left out, missing ones read nothing.

    What a narrower laser does not see is told as free, so a policy is worse with it, the less it sees.

    Args:
        interface: Of the robot, with its own laser, turned as it may be.
        field_of_view: That a policy knows, half of it to either side of straight ahead [rad].
        least: Beams that it needs; a laser of fewer tells some of them more than once.

    Attributes:
        interface: The same robot with the laser that is told, which has as many beams a radian, or `least`.

    Raises:
        InputError: If the laser does not look ahead.
    """

    def __init__(self, interface: FollowInterface, field_of_view: float, least: int) -> None:
        own, turn = interface.bearings, interface.T_robot_lidar[2]
        self._count = len(own)
        spacing = max(abs(own[-1] - own[0]) / max(self._count - 1, 1), _LEAST_SPACING)
        beams = max(round(field_of_view / spacing) + 1, least)
        told = np.linspace(-0.5 * field_of_view, 0.5 * field_of_view, beams)
        self.interface = replace(interface, bearings=told - turn)
        self._beams, apart = _nearest(wrap_angle(own + turn), told)
        self._missing = apart > max(spacing, field_of_view / (beams - 1))
        if self._missing[np.abs(told) <= AHEAD].any():
            first, last = np.degrees((own[0] + turn, own[-1] + turn))
            raise InputError(
                f"a policy needs a laser that looks {np.degrees(AHEAD):.0f} degrees to either side of straight ahead, "
                f"got one from {first:.0f} to {last:.0f}"
            )

    def scan(self, observation: Observation) -> NDArray[np.float32]:
        """Return (N,) the scan of an observation, as the laser that is told has it.

        Raises:
            InputError: If it has not as many beams as the robot's laser.
        """
        return np.where(self._missing, NOTHING, scan_of(observation, self._count)[self._beams])


def _nearest(own: NDArray[np.float64], told: NDArray[np.float64]) -> tuple[NDArray[np.intp], NDArray[np.float64]]:
    """Return which of `own` (n,) in [-pi, pi) is nearest to each of `told` (m,), and how far off it is [rad]."""
    order = np.argsort(own)
    around = np.concatenate((own[order[-1:]] - 2.0 * np.pi, own[order], own[order[:1]] + 2.0 * np.pi))
    after = np.clip(np.searchsorted(around, told), 1, len(around) - 1)
    nearest = after - (told - around[after - 1] < around[after] - told)
    return np.concatenate((order[-1:], order, order[:1]))[nearest], np.abs(around[nearest] - told)
