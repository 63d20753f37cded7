"""The people tracker of Ye et al. 2021, section II.A, as the paper tells it: one filterpy filter a track, and Munkres.

`PeopleTracker` is what became of it here; this one is for comparison. Where the paper is silent, it does as the work
that it builds on: Leigh, Pineau, Olmedo, Zhang, "Person tracking and following with 2D laser scanners", ICRA 2015.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose, transform_points
from ...slam.scan import LaserScan
from ..legs.detector import Detections, Detector
from .camera import SeenPeople
from .geometry_kernels import points_of_things
from .kalman import predict_single, single_target
from .local_grid import LocalGrid
from .people import People, SeenLegs
from .tracker import TrackerUpdate
from .ye2021_config import Ye2021Config

if TYPE_CHECKING:
    from filterpy.kalman import KalmanFilter

Array = NDArray[np.float64]


@dataclass(eq=False)
class PaperTrack:
    """A leg, or a person: a pair of legs.

    Attributes:
        filter: Its Kalman filter, state (x, y, vx, vy).
        confidence: By eq. 6, in [0, 1].
        start: (2,) where it began [m].
        number: Of the person; -1 for a leg.
        legs: (k, 2) its detections in this scan [m].
        age_s: Since it began [s].
        unseen_s: Since it was last detected [s].
    """

    filter: "KalmanFilter"
    confidence: float
    start: Array
    number: int = -1
    legs: Array = field(default_factory=lambda: np.empty((0, 2)))
    age_s: float = 0.0
    unseen_s: float = 0.0

    @property
    def position(self) -> Array:
        """(2,) [m]."""
        return np.asarray(self.filter.x[:2], dtype=np.float64)


class Ye2021Tracker:
    """Tracks people in the odometry frame.

    Args:
        config: Its numbers.
        detector: Finds legs in single scans (clusters by alpha and beta, the forest's confidence above gamma).
    """

    def __init__(self, config: Ye2021Config, detector: Detector) -> None:
        self._config, self._detector = config, detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        config = self._config
        self._tracks: list[PaperTrack] = []
        self._grid = LocalGrid(config.resolution, config.still_s, config.forget_s)
        self._time_s: float | None = None
        self._people = 0

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time.

        Raises:
            InputError: If the scan is not later than the one before, or a camera has seen people.
        """
        if seen is not None:
            raise InputError('the method "ye2021" takes no camera; give "hypotheses"')
        pose, dt = checked_pose(odometry), self._step(scan.time_s)
        detections = self._detector.detect(scan)
        y = transform_points(pose, detections.positions[detections.human])  # eq. 1
        d = detections.confidence[detections.human]
        self._predict(dt)
        matched = self._match(y)
        self._correct(matched, y, d, dt)
        self._begin(np.setdiff1d(np.arange(len(y)), np.concatenate([*matched, []])).astype(int), y, d)
        self._mark_grid(scan, detections, pose, dt)
        self._initiate_people(scan.time_s)
        self._delete()
        return TrackerUpdate(self._as_people(scan.time_s), detections, pose)

    def _step(self, time_s: float) -> float:
        before = self._time_s
        if before is not None and not time_s > before:
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        self._time_s = time_s
        return 1.0 / self._config.motion.reference_rate_hz if before is None else time_s - before

    def _predict(self, dt: float) -> None:
        """Predict all tracks (eq. 3, 4a, 4b)."""
        for track in self._tracks:
            predict_single(track.filter, dt, self._config.motion.process_variance(dt))
            track.age_s += dt
            track.unseen_s += dt

    def _match(self, y: Array) -> list[list[int]]:
        """Return for each track its detections of `y` (m, 2), by global nearest neighbour (Munkres) within the gate.

        A person is in the cost matrix twice, once for each leg (Leigh 2015).
        """
        rows = [n for n, track in enumerate(self._tracks) for _ in range(2 if track.number >= 0 else 1)]
        cost = cdist(np.array([self._tracks[n].position for n in rows]).reshape(-1, 2), y)
        gate = self._config.gate
        cost = np.where(cost < gate, cost, 1e3 * gate)  # beyond the gate: only if nothing else is left
        matched: list[list[int]] = [[] for _ in self._tracks]
        for row, column in zip(*linear_sum_assignment(cost), strict=True):
            if cost[row, column] < gate:
                matched[rows[row]].append(int(column))
        return matched

    def _correct(self, matched: list[list[int]], y: Array, d: Array, dt: float) -> None:
        """Correct the matched tracks by their detections (eq. 4c to 4e) and their confidence (eq. 6)."""
        weight = self._config.confidence_weight(dt)
        for track, detections in zip(self._tracks, matched, strict=True):
            track.legs = y[detections]
            if detections:
                track.filter.update(track.legs.mean(axis=0))
                track.confidence += weight * (float(d[detections].mean()) - track.confidence)
                track.unseen_s = 0.0

    def _begin(self, rows: NDArray[np.int64], y: Array, d: Array) -> None:
        """Begin tracks at the detections `rows` of nobody (eq. 5)."""
        motion = self._config.motion
        for row in rows:
            filter_ = single_target(y[row], motion.initial_variance, motion.r)
            self._tracks.append(PaperTrack(filter_, float(d[row]), y[row].copy(), legs=y[[row]]))

    def _mark_grid(self, scan: LaserScan, detections: Detections, pose: Array, dt: float) -> None:
        """Mark the local grid where clusters are that are not human; all other cells are free."""
        clusters, people = detections.clusters, [track.position for track in self._tracks if track.number >= 0]
        points = transform_points(compose(pose, scan.T_robot_lidar), clusters.points)
        places = np.array(people).reshape(-1, 2)
        clearance = self._config.clearance
        things = points_of_things(points, clusters.start, clusters.end, ~detections.human, places, clearance)
        self._grid.mark(things, pose[:2], scan.time_s, dt)

    def _initiate_people(self, time_s: float) -> None:
        """Make people of pairs of legs that both moved delta, have a confidence above c_min, and are in free cells."""
        config = self._config
        legs = [track for track in self._tracks if track.number < 0 and self._may_be_a_leg(track, time_s)]
        places = np.array([track.position for track in legs]).reshape(-1, 2)
        apart = cdist(places, places) + np.where(np.eye(len(legs)), np.inf, 0.0)
        while apart.size and apart.min() <= config.distance:
            i, j = np.unravel_index(apart.argmin(), apart.shape)
            first, second = legs[i], legs[j]
            first.number, self._people = self._people, self._people + 1
            first.filter.x = 0.5 * (first.filter.x + second.filter.x)
            first.legs = np.concatenate((first.legs, second.legs))
            first.confidence = 0.5 * (first.confidence + second.confidence)
            self._tracks.remove(second)
            apart[[i, j]] = apart[:, [i, j]] = np.inf

    def _may_be_a_leg(self, track: PaperTrack, time_s: float) -> bool:
        moved = float(np.hypot(*(track.position - track.start))) >= self._config.delta
        sure = track.confidence > self._config.c_min
        return moved and sure and bool(self._grid.is_free(track.position[None], time_s)[0])

    def _delete(self) -> None:
        """Delete tracks whose place is too uncertain (epsilon) or whose confidence is too small (c_min)."""
        limits = self._config
        self._tracks = [
            track
            for track in self._tracks
            if track.filter.P[0, 0] <= limits.epsilon and track.confidence >= limits.c_min
        ]

    def _as_people(self, time_s: float) -> People:
        people = [track for track in self._tracks if track.number >= 0]
        states = np.array([track.filter.x for track in people]).reshape(-1, 4)
        legs = np.repeat(states[:, None, :2], 2, axis=1)
        for row, track in enumerate(people):
            legs[row, : len(track.legs)] = track.legs
        owner = np.repeat(np.arange(len(people)), [len(track.legs) for track in people])
        confidence = np.array([track.confidence for track in people])
        return People(
            time_s=time_s,
            ids=np.array([track.number for track in people], dtype=np.int64),
            positions=states[:, :2].copy(),
            velocities=states[:, 2:].copy(),
            confidence=confidence,
            legs=legs,
            variance=np.array([track.filter.P[0, 0] for track in people]),
            unseen_s=np.array([track.unseen_s for track in people]),
            age_s=np.array([track.age_s for track in people]),
            seen_legs=SeenLegs(
                np.concatenate([np.empty((0, 2)), *(track.legs for track in people)]), confidence[owner], owner
            ),
        )
