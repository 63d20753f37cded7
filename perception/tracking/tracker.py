"""People from leg detections, scan by scan (Ye 2021, section II.A)."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.rigid_kernel import moved_points
from ...slam.scan import LaserScan
from ..legs.detection_kernel import Found
from ..legs.detector import Detections, Detector
from ..legs.range_view import Fan, RangeView, fan_of, seen_in
from ..legs.recent_views import no_views
from . import following
from .camera import SeenPeople, take_in
from .config import TrackerConfig
from .evidence import remembered
from .local_grid import make_pages, with_more_pages
from .numbers import Numbers, numbers_of
from .people import People, SeenLegs
from .tracks import HYPOTHESIS, Tracks, has_room, hypotheses_of, no_tracks, tracks_of, with_room

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrackerUpdate:
    """What the tracker made of one scan.

    Attributes:
        people: The people believed in now, in the odometry frame.
        detections: What the detector said about this scan, in the robot frame.
        odometry: (3,) T_odom_robot of this scan.
        hypotheses: (n,) of `tracks.HYPOTHESIS`, all that may be people; empty of a tracker without any.
    """

    people: People
    detections: Detections
    odometry: Array
    hypotheses: NDArray[Any] = field(default_factory=lambda: np.zeros(0, HYPOTHESIS))

    @property
    def people_robot(self) -> People:
        """The people in the robot frame."""
        return self.people.in_frame_of(self.odometry)


class PeopleTracker:
    """Tracks people in the odometry frame, with moving or standing robots, by hypotheses of whole people.

    Each hypothesis explains one cluster, two legs, or nothing that is seen, by likelihood: a track-oriented
    multi-target filter with existence probabilities (Musicki, Evans, Stanicic, "Integrated probabilistic data
    association", IEEE TAC 39(6), 1994). A scan goes through its stages, see `following`; a camera may add what it saw.

    Args:
        config: Its numbers, a node for each stage.
        detector: Finds legs in single scans.
    """

    def __init__(self, config: TrackerConfig, detector: Detector) -> None:
        self._config, self._numbers, self._detector = config, numbers_of(config), detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._all = no_tracks(1, 0, self._config.views)
        self._fan: Fan | None = None
        self._time_s: float | None = None

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan, the robot's odometry pose T_odom_robot (3,) at that time, and what a camera saw, if it did.

        Raises:
            InputError: If the scan is not later than the one before.
        """
        pose, dt, time_s = checked_pose(odometry), self._step(scan.time_s), float(scan.time_s)
        detections, view = self._detector.detect(scan), self._view(scan, pose)
        found, c = found_in(detections), self._numbers
        points = moved_points(view.laser, scan.points)
        fresh = len(detections) + (0 if seen is None else len(seen.positions))
        tracks = self._with_room(fresh, points, pose, time_s)
        sight = following.follow(tracks, found, view, pose, time_s, dt, c)
        if seen is not None:
            places, delay = np.ascontiguousarray(seen.positions, dtype=np.float64), max(0.0, time_s - seen.time_s)
            take_in(tracks, places, np.asarray(seen.likelihood, dtype=np.float64), delay, view.laser, c)
        following.maintain(tracks, sight, view, pose, points, time_s, dt, c)
        existence, still_s = self._config.existence, float(self._config.things.still_s)
        confidence = remembered(found.confidence, sight, float(existence.memory), still_s)
        human = confidence >= existence.gamma
        told = replace(detections, confidence=confidence, human=human)
        rows = hypotheses_of(tracks).copy()
        return TrackerUpdate(people_of(rows, time_s, c), told, pose, rows)

    def _step(self, time_s: float) -> float:
        """Return the time since the last scan [s]; before the first, that between two scans at the reference rate."""
        before = self._time_s
        if before is not None and not time_s > before:
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        self._time_s = time_s
        return 1.0 / self._config.motion.reference_rate_hz if before is None else time_s - before

    def _view(self, scan: LaserScan, pose: Array) -> RangeView:
        """Return how far is seen along the beams of the first scan; another laser's are forgotten."""
        if self._fan is None or not self._fan.may_be_of(scan):
            self._fan = fan_of(scan)
            self._all = self._all._replace(views=no_views(1, len(scan), self._config.views))
        return seen_in(scan, pose, self._fan)

    def _with_room(self, fresh: int, points: Array, pose: Array, time_s: float) -> Tracks:
        """Return the tracks, with room for `fresh` more and for things at `points` (k, 2) around `pose` (3,)."""
        resolution, forget_s = float(self._config.things.resolution), float(self._config.things.forget_s)
        while not make_pages(tracks_of(self._all, 0).cells, points, pose, resolution, time_s, forget_s):
            self._all = self._all._replace(cells=with_more_pages(self._all.cells))
        while not has_room(tracks_of(self._all, 0), fresh):
            self._all = with_room(self._all)
        return tracks_of(self._all, 0)


def found_in(detections: Detections) -> Found:
    """Return `detections` as kernels take them."""
    clusters = detections.clusters
    return Found(
        points=np.ascontiguousarray(clusters.points, dtype=np.float64),
        numbers=np.ascontiguousarray(clusters.beams, dtype=np.int64),
        start=np.ascontiguousarray(clusters.start, dtype=np.int64),
        end=np.ascontiguousarray(clusters.end, dtype=np.int64),
        positions=np.ascontiguousarray(detections.positions, dtype=np.float64),
        confidence=np.ascontiguousarray(detections.confidence, dtype=np.float64),
        human=np.ascontiguousarray(detections.human, dtype=np.bool_),
    )


def people_of(hypotheses: NDArray[Any], time_s: float, c: Numbers) -> People:
    """Return the people among `hypotheses` (n,), as they were at `time_s`."""
    told = following.told_people(hypotheses, c)
    rows = hypotheses[told]
    return People(
        time_s=time_s,
        ids=rows["id"],
        positions=rows["x"][:, :2].copy(),
        velocities=rows["x"][:, 2:].copy(),
        confidence=1.0 / (1.0 + np.exp(-rows["odds"])),
        legs=rows["x"][:, None, :2] + rows["legs"],
        variance=rows["p"][:, 0].copy(),
        unseen_s=rows["unseen_s"],
        age_s=rows["placed_s"],
        seen_legs=SeenLegs(*following.seen_legs(hypotheses, told, c)),
    )
