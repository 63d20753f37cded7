"""What one scan draws into a submap."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from ..geometry import transform_points
from ..scan import LaserScan
from .surface import surface_points

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sweep:
    """Where a scan saw walls and where it saw none, all in one frame [m].

    Attributes:
        points: (1 + N + M, 2) the laser, N points on what the beams met, M ends of the rays that are known to be free.
        returns: The first so many of the N are ends of beams, the others lie between.
        between: So many they are.
    """

    points: Array
    returns: int
    between: int

    @property
    def sensor(self) -> Array:
        """(2,) the laser."""
        return self.points[0]

    @property
    def surface(self) -> Array:
        """(N, 2) points on what the beams met, ends of beams first."""
        return self.points[1 : 1 + self.returns + self.between]

    @classmethod
    def of(cls, scan: LaserScan, spacing: float, free_ray_length: float) -> Self:
        """Return the sweep of a scan in the robot's frame.

        Args:
            scan: The scan.
            spacing: Returns nearer to each other than this are joined, gaps on a surface filled [m].
            free_ray_length: A beam without a return is free so far [m].
        """
        mount = np.asarray(scan.T_robot_lidar)
        surface, returns = surface_points(scan.beam_points, spacing)
        ends = min(free_ray_length, scan.range_max) * scan.directions[scan.is_open]
        points = np.concatenate((np.zeros((1, 2)), surface, ends))
        return cls(transform_points(mount, points), returns, len(surface) - returns)

    def at(self, pose: Array) -> Self:
        """Return the sweep in the frame in which its own frame has the `pose` (3,)."""
        return type(self)(transform_points(pose, self.points), self.returns, self.between)
