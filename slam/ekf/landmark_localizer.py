"""Localization of a robot on a known map of landmarks, from odometry and laser scans (Urvina et al. 2023).

Each scan is clustered into objects, those that may be landmarks are measured, and the extended Kalman filter of
`localization.py` corrects the odometry by the ones that the map knows.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Reach, check_numbers, check_positive, checked_pose
from ..errors import InputError, unknown_name
from ..geometry import between
from ..landmarks.clustering import METHODS, clusterer_of_scans
from ..landmarks.landmark_map import LandmarkMap
from ..landmarks.objects import SightingConfig, see_landmarks
from ..localization.localizer import LocalizationUpdate, State
from ..scan import LaserScan
from .localization import LocalizationConfig, ObjectLocalizer

Array = NDArray[np.float64]


def _filter() -> LocalizationConfig:
    """Return settings for maps that lack landmarks and starts that are told: the paper has neither."""
    return LocalizationConfig(sigma_start=0.3, association="joint")


@dataclass(frozen=True, kw_only=True)
class LandmarkLocalizerConfig:
    """Settings of `LandmarkLocalizer`.

    Attributes:
        clustering: How scans are cut into objects: "heuristic", "kmeans", "gmm" or "dbscan".
        cluster_distance: Largest distance within an object [m], for "heuristic" and "dbscan".
        cluster_points: Fewest points of an object, for "heuristic" and "dbscan".
        filter: The filter; by default the start is known to 0.3 m and 0.3 rad, and joint compatibility associates.
        sighting: What counts as a landmark.
        travel: Scans are used once the robot went so far since the last used one [m] ...
        turn: ... or turned so far [rad].
        period: Time between two scans where the log's clock stands still [s].
        lost_sigma: It is not sure where the robot is once a standard deviation of the position exceeds this [m] ...
        patience: ... or once the map knows less than half of the landmarks in so many used scans in a row: the robot
            was carried away, or the start was wrong. Then the pose is known as badly as at the start, until two known
            landmarks, and half of those that are seen, agree on it.
    """

    clustering: str = "dbscan"
    cluster_distance: Reach = 0.5
    cluster_points: int = 1
    filter: LocalizationConfig = field(default_factory=_filter)
    sighting: SightingConfig = field(default_factory=SightingConfig)
    travel: float = 0.2
    turn: float = 0.1
    period: float = 0.1
    lost_sigma: float = 0.5
    patience: int = 3

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.clustering not in METHODS:
            raise unknown_name("clustering method", self.clustering, tuple(METHODS))
        for name in ("travel", "turn"):
            if not getattr(self, name) >= 0.0:
                raise InputError(f"`{name}` must not be negative, got {getattr(self, name)}")
        check_positive(self, "cluster_distance", "period", "lost_sigma", "patience", "cluster_points")


class LandmarkLocalizer:
    """Follows the robot on a known map of landmarks; says when it is not sure where it is.

    Other than `Localizer`, which searches a grid map, it has to be told about where the robot starts: within about
    half the distance between two landmarks.

    Args:
        landmarks: The map.
        config: Settings.
        start: (3,) T_map_robot at the first scan [m, m, rad]; None: the first odometry pose, as in the drive that
            `EkfSlam` has mapped.

    Attributes:
        lost: How often it was sure where the robot is, and then not any more.
    """

    def __init__(
        self, landmarks: LandmarkMap, config: LandmarkLocalizerConfig | None = None, start: ArrayLike | None = None
    ) -> None:
        self.config = config or LandmarkLocalizerConfig()
        self.landmarks = landmarks
        self.lost = 0
        self._clusterer = clusterer_of_scans(
            self.config.clustering, self.config.cluster_distance, self.config.cluster_points
        )
        self._start = None if start is None else checked_pose(start, "start")
        self._filter: ObjectLocalizer | None = None
        self._odometry = self._used_at = np.zeros(3)
        self._time_s = 0.0
        self._unknown = 0  # used scans in a row of whose landmarks the map knows less than half
        self._poses: list[Array | None] = []

    @property
    def pose(self) -> Array | None:
        """(3,) T_map_robot at the last scan; None: not sure."""
        last = self._poses[-1] if self._poses else None
        return None if last is None else last.copy()

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them; NaN where it was not sure."""
        nowhere = np.full(3, np.nan)
        return np.array([nowhere if pose is None else pose for pose in self._poses]).reshape(-1, 3)

    def update(self, odometry: ArrayLike, scan: LaserScan) -> LocalizationUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        now = checked_pose(odometry, before=None if self._filter is None else self._odometry)
        first = self._filter is None
        if self._filter is None:
            self._filter = self._begin(now)
        else:
            passed = scan.time_s - self._time_s
            self._filter.move(between(self._odometry, now), passed if passed > 0.0 else self.config.period)
        self._odometry, self._time_s = now, scan.time_s
        moved = between(self._used_at, now)
        far = math.hypot(moved[0], moved[1]) >= self.config.travel or abs(moved[2]) >= self.config.turn
        known, explained = self._correct(self._filter, scan) if first or far else (0, None)
        pose = self._filter.pose if self._sure(self._filter) else None
        if pose is None and self._poses and self._poses[-1] is not None:
            self.lost += 1
        self._poses.append(pose)
        state = State.SEARCHING if pose is None else State.TRACKING
        return LocalizationUpdate(pose, state, known > 0, explained, None)

    def _begin(self, odometry: Array) -> ObjectLocalizer:
        start = odometry if self._start is None else self._start
        return ObjectLocalizer(self.landmarks.places, start, self.config.filter, self.landmarks.covariances)

    def _correct(self, ekf: ObjectLocalizer, scan: LaserScan) -> tuple[int, float | None]:
        """Correct the pose by a scan; return how many of its landmarks are known, and their share, if it has any."""
        self._used_at = self._odometry
        sightings = see_landmarks(scan, self._clusterer, self.config.sighting)
        if not len(sightings.z):
            return 0, None
        known = ekf.update(sightings.z, sightings.R)
        enough = 1 if self._unknown < self.config.patience else 2
        self._unknown = 0 if known >= enough and 2 * known >= len(sightings.z) else self._unknown + 1
        if self._unknown == self.config.patience:
            ekf.restart()
        return known, known / len(sightings.z)

    def _sure(self, ekf: ObjectLocalizer) -> bool:
        sigma = math.sqrt(float(np.linalg.eigvalsh(ekf.filter.P[:2, :2])[-1]))
        return sigma <= self.config.lost_sigma and self._unknown < self.config.patience
