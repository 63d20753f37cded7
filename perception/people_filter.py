"""Keeps people out of scans before they reach a map (Ye 2021, section II.B)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..slam.geometry import inverse, transform_points
from ..slam.scan import LaserScan
from .config import PerceptionConfig
from .legs.detector import Detections
from .nearness_kernel import near_any
from .tracking.people import People


def near_points(scan: LaserScan, people_points_lidar: ArrayLike, zeta: float) -> NDArray[np.bool_]:
    """Return (N,) the beams whose return is within `zeta` [m] of any of the points (n, 2) in the laser frame."""
    points = np.ascontiguousarray(people_points_lidar, dtype=np.float64).reshape(-1, 2)
    return near_any(scan.beam_points, points, zeta)


def filter_people(scan: LaserScan, people_points_lidar: ArrayLike, zeta: float) -> LaserScan:
    """Return `scan` without the returns near people: dropped beams are NaN, neither a hit nor a free ray.

    Args:
        scan: One sweep.
        people_points_lidar: (n, 2) centres of people and of their legs in the laser frame [m].
        zeta: Distance within which a return is a person's [m].
    """
    return scan.without(near_points(scan, people_points_lidar, zeta))


def suspect_points_lidar(detections: Detections, scan: LaserScan, confidence: float) -> NDArray[np.float64]:
    """Return (n, 2) the centres of all clusters of at least `confidence`, in the laser frame [m].

    A person counts as one only after moving; until then these keep their legs out of a map, at the price of a chair leg
    now and then, which other scans draw.
    """
    return transform_points(inverse(scan.T_robot_lidar), detections.positions[detections.confidence >= confidence])


def people_points_lidar(people: People, odometry: ArrayLike, scan: LaserScan) -> NDArray[np.float64]:
    """Return (3 n, 2) centres and legs of `people` (odometry frame) in the frame of the laser that took `scan`."""
    points_robot = transform_points(inverse(odometry), people.points)
    return transform_points(inverse(np.asarray(scan.T_robot_lidar)), points_robot)


@dataclass(frozen=True, eq=False)
class FilteredScan:
    """A scan that people can be taken out of; that is done when somebody asks, once.

    Attributes:
        scan: As measured.
        odometry: (3,) T_odom_robot at its time.
        people: Who is known, odometry frame.
        detections: What the leg detector said about the scan.
        config: How near to people, and to what may be people, returns are dropped.
    """

    scan: LaserScan
    odometry: NDArray[np.float64]
    people: People
    detections: Detections
    config: PerceptionConfig

    @cached_property
    def near_people(self) -> NDArray[np.bool_]:
        """(N,) the beams whose return is near somebody, or near what may become somebody."""
        config, scan = self.config, self.scan
        near = near_points(scan, people_points_lidar(self.people, self.odometry, scan), config.zeta)
        if config.suspect_radius == 0.0:
            return near
        suspects = suspect_points_lidar(self.detections, scan, config.suspect_confidence)
        return near | near_points(scan, suspects, config.suspect_radius)

    @cached_property
    def without_people(self) -> LaserScan:
        """The scan with these beams dropped: neither a hit nor a free ray."""
        return self.scan.without(self.near_people)
