"""People from leg detections, scan by scan (Ye 2021, section II.A)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose
from ...slam.rigid_kernel import moved_points
from ...slam.scan import LaserScan
from ..legs.detection_kernel import Found
from ..legs.detector import Detections, Detector
from . import following, leg_kernels
from .camera import CameraTracking, SeenPeople
from .config import TrackerConfig
from .local_grid import make_pages, with_more_pages
from .numbers import numbers_of
from .people import People, SeenLegs
from .tracks import LEGS, PEOPLE, Tracks, has_room, no_tracks, tracks_of, with_room

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TrackerUpdate:
    """What the tracker made of one scan.

    Attributes:
        people: The people believed in now, in the odometry frame.
        detections: What the detector said about this scan, in the robot frame.
        odometry: (3,) T_odom_robot of this scan.
    """

    people: People
    detections: Detections
    odometry: Array

    @property
    def people_robot(self) -> People:
        """The people in the robot frame."""
        return self.people.in_frame_of(self.odometry)


class PeopleTracker:
    """Tracks legs and people in the odometry frame.

    A scan goes through the stages of multi-target tracking, see `following`; a camera may add what it saw.

    Args:
        config: Its numbers, a node for each stage.
        detector: Finds legs in single scans.
    """

    def __init__(self, config: TrackerConfig, detector: Detector) -> None:
        self._config, self._numbers, self._detector = config, numbers_of(config), detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._all = no_tracks(1)
        self._camera = CameraTracking(self._config, self._numbers)
        self._time_s: float | None = None

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan, the robot's odometry pose T_odom_robot (3,) at that time, and what a camera saw, if it did.

        Raises:
            InputError: If the scan is not later than the one before.
        """
        pose, dt = checked_pose(odometry), self._step(scan.time_s)
        detections = self._detector.detect(scan)
        found, lidar = found_in(detections), compose(pose, scan.T_robot_lidar)
        points = moved_points(np.asarray(lidar), found.points)
        tracks = self._with_room(len(detections) + (0 if seen is None else 2 * len(seen.positions)), points, pose)
        things = following.follow(tracks, found, points, pose, scan.time_s, dt, self._numbers)
        if seen is not None:
            self._camera.update(tracks, seen, scan.time_s, dt)
        following.mark_things(tracks, found, points, things, pose, scan.time_s, dt, self._numbers)
        return TrackerUpdate(_as_people(tracks, scan.time_s), detections, pose)

    def _step(self, time_s: float) -> float:
        """Return the time since the last scan [s]; before the first, that between two scans at the reference rate."""
        before = self._time_s
        if before is not None and not time_s > before:
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        self._time_s = time_s
        return 1.0 / self._config.motion.reference_rate_hz if before is None else time_s - before

    def _with_room(self, fresh: int, points: Array, pose: Array) -> Tracks:
        """Return the tracks, with room for `fresh` more and for things at `points` (k, 2) around `pose` (3,)."""
        while not make_pages(tracks_of(self._all, 0).cells, points, pose, self._config.grid.resolution):
            self._all = self._all._replace(cells=with_more_pages(self._all.cells))
        while not has_room(tracks_of(self._all, 0), fresh):
            self._all = with_room(self._all, 2 * self._all.legs.shape[1])
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


def _as_people(tracks: Tracks, time_s: float) -> People:
    """Return copies of what is known of the people at `time_s`."""
    people, legs = tracks.people[: tracks.counts[PEOPLE]], tracks.legs[: tracks.counts[LEGS]]
    rows, owner = leg_kernels.seen_now(legs, len(people))
    return People(
        time_s=time_s,
        ids=people["id"].copy(),
        positions=people["x"][:, :2].copy(),
        velocities=people["x"][:, 2:].copy(),
        confidence=people["confidence"].copy(),
        legs=legs["x"][: 2 * len(people), :2].reshape(-1, 2, 2).copy(),
        variance=people["p"][:, 0].copy(),
        unseen_s=people["unseen_s"].copy(),
        age_s=people["age_s"].copy(),
        seen_legs=SeenLegs(legs["seen"][rows], legs["confidence"][rows], owner),
    )
