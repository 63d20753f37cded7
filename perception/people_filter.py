"""Keeps people out of scans before they reach a map (Ye 2021, section II.B)."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..slam.bounds import check_numbers, check_positive
from ..slam.errors import InputError, unknown_name
from ..slam.geometry import inverse, transform_points
from ..slam.scan import LaserScan
from ..slam.scan_to_scan.laser_odometry import ScanToScanOdometry
from .legs.detector import Detections, Detector, LegDetector, LegDetectorConfig
from .legs.forest import LegForest
from .nearness_kernel import near_any
from .tracking.camera import SeenPeople
from .tracking.config import TrackerConfig
from .tracking.people import People
from .tracking.tracker import PeopleTracker, TrackerUpdate
from .tracking.ye2021_config import Ye2021Config


@dataclass(frozen=True, kw_only=True)
class RemovalConfig:
    """Which returns are dropped from a scan.

    Attributes:
        zeta: Returns this close to a tracked person or one of its legs (Table II) [m].
        unconfirmed_radius: So are returns this close to what looks like a leg and may be that of somebody who has not
            moved enough to be tracked yet; 0 keeps them in the scan, as the paper does [m].
        unconfirmed_confidence: From this confidence on a cluster looks like a leg for that, in [0, 1].
    """

    zeta: float = 0.35
    unconfirmed_radius: float = 0.1
    unconfirmed_confidence: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "zeta", "unconfirmed_confidence")
        if self.unconfirmed_radius < 0.0:
            raise InputError(f"`unconfirmed_radius` must be positive or 0, got {self.unconfirmed_radius}")


METHODS = ("hypotheses", "ye2021")
"""How people are tracked: as hypotheses of whole people, or as Ye 2021 tells it."""


@dataclass(frozen=True, kw_only=True)
class PeopleFilterConfig:
    """Numbers of the people filter and of all that it consists of.

    Attributes:
        forest: Leg forest: "real" for recorded scans, "simulation" for those of the environments, or a file that
            `tagalong train legs` wrote.
        detector: Of legs in single scans.
        method: How people are tracked, one of `METHODS`: "hypotheses" asks for what is more likely a person than a
            thing, be it one cluster, from moving robots, too, and takes what a camera saw; "ye2021" is the paper's own
            tracker and nothing more, for comparison.
        tracker: Of people, by hypotheses.
        paper: Of the tracker of Ye 2021.
        removal: Which returns are dropped.
    """

    forest: str = "real"
    detector: LegDetectorConfig = field(default_factory=LegDetectorConfig)
    method: str = "hypotheses"
    tracker: TrackerConfig = field(default_factory=TrackerConfig)
    paper: Ye2021Config = field(default_factory=Ye2021Config)
    removal: RemovalConfig = field(default_factory=RemovalConfig)

    def __post_init__(self) -> None:
        if self.method not in METHODS:
            raise unknown_name("method", self.method, METHODS)


@dataclass(frozen=True, eq=False)
class FilteredScan:
    """A scan, the people in it, and the scan without them, which is computed when it is first asked for.

    Attributes:
        scan: As measured.
        odometry: (3,) T_odom_robot at its time, as it was given or made of the scans.
        people: Who is tracked, in the odometry frame.
        detections: Every cluster of the scan and how much it looks like a leg, in the robot frame.
        config: Which returns are dropped.
    """

    scan: LaserScan
    odometry: NDArray[np.float64]
    people: People
    detections: Detections
    config: RemovalConfig = field(default_factory=RemovalConfig)

    @property
    def unconfirmed_legs(self) -> NDArray[np.float64]:
        """(n, 2) centres of the clusters that look like legs, of tracked people or not, in the robot frame [m].

        A person is tracked only after moving; until then these keep its legs out of a map, at the price of a chair leg
        now and then, which other scans draw.
        """
        return self.detections.positions[self.detections.confidence >= self.config.unconfirmed_confidence]

    @cached_property
    def removed(self) -> NDArray[np.bool_]:
        """(N,) the beams whose return is near somebody, or near what may become somebody."""
        config, scan = self.config, self.scan
        near = near_points(scan, points_lidar(scan, self.people.points, self.odometry), config.zeta)
        if config.unconfirmed_radius == 0.0:
            return near
        return near | near_points(scan, points_lidar(scan, self.unconfirmed_legs), config.unconfirmed_radius)

    @cached_property
    def without_people(self) -> LaserScan:
        """The scan with these beams dropped: they are NaN, neither a hit nor a free ray."""
        return self.scan.without(self.removed)


class PeopleFilter:
    """Takes people out of the scans of a drive, one after the other: detects legs, tracks people, drops their returns.

    Args:
        config: Its numbers, the leg forest among them.
        detector: Finds legs, in place of the configured one.

    Raises:
        InputError: If there is no such forest.
    """

    def __init__(self, config: PeopleFilterConfig | None = None, detector: Detector | None = None) -> None:
        self.config = config or PeopleFilterConfig()
        detector = detector or LegDetector(LegForest.load(self.config.forest), self.config.detector)
        if self.config.method == "ye2021":
            from .tracking.ye2021 import (
                Ye2021Tracker,
            )  # and filterpy and scipy's assignment, only where it is asked for

            self._tracker = Ye2021Tracker(self.config.paper, detector)
        else:
            self._tracker = PeopleTracker(self.config.tracker, detector)
        self._odometry = ScanToScanOdometry()

    def update(
        self, scan: LaserScan, odometry: ArrayLike | None = None, seen: SeenPeople | None = None
    ) -> FilteredScan:
        """Take the next scan of a drive; return it with the people in it and without them.

        Args:
            scan: One sweep, later than the one before.
            odometry: (3,) T_odom_robot at its time [m, m, rad], with every scan or with none; None: it is made of the
                scans, by scan matching, which takes some milliseconds a scan. A robot that moves and says that it
                stands hides people: of those around one that drives among them, 7 % are found then, 45 % with None.
            seen: Whom a camera saw, if there is one.

        Raises:
            InputError: If the scan is not later than the one before, or the pose is none.
        """
        update = self.track(scan, odometry, seen)
        return FilteredScan(scan, update.odometry, update.people, update.detections, self.config.removal)

    def track(
        self, scan: LaserScan, odometry: ArrayLike | None = None, seen: SeenPeople | None = None
    ) -> TrackerUpdate:
        """Take the next scan, as `update`; return what the tracker makes of it."""
        return self._tracker.update(scan, self._odometry.update(scan).pose if odometry is None else odometry, seen)


def near_points(scan: LaserScan, points_lidar: ArrayLike, distance: float) -> NDArray[np.bool_]:
    """Return (N,) the beams whose return is within `distance` [m] of any of the points (n, 2) in the laser frame."""
    points = np.ascontiguousarray(points_lidar, dtype=np.float64).reshape(-1, 2)
    return near_any(scan.beam_points, points, distance)


def points_lidar(
    scan: LaserScan, points: NDArray[np.float64], odometry: ArrayLike | None = None
) -> NDArray[np.float64]:
    """Return `points` (n, 2) in the frame of the laser that took `scan`.

    Args:
        scan: One sweep.
        points: In the odometry frame with the robot at `odometry` (3,); without it, in the robot frame [m].
        odometry: T_odom_robot.
    """
    points_robot = points if odometry is None else transform_points(inverse(odometry), points)
    return transform_points(inverse(np.asarray(scan.T_robot_lidar)), points_robot)
