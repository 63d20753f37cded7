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
        foot: (2,) the laser.
        surface: (N, 2) points on what the beams met.
        returns: The first so many of them are ends of beams, the others lie between.
        free_ends: (M, 2) ends of the rays that are known to be free.
    """

    foot: Array
    surface: Array
    returns: int
    free_ends: Array

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
        bearings = scan.bearings[scan.is_no_return]
        ends = min(free_ray_length, scan.range_max) * np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)
        return cls(mount[:2], transform_points(mount, surface), returns, transform_points(mount, ends))

    def at(self, pose: Array) -> Self:
        """Return the sweep in the frame in which its own frame has the `pose` (3,)."""
        foot = transform_points(pose, self.foot[None])[0]
        return type(self)(
            foot, transform_points(pose, self.surface), self.returns, transform_points(pose, self.free_ends)
        )
