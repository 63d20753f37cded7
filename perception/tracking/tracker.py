"""People from leg detections, scan by scan (Ye 2021, section II.A)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose, transform_points
from ...slam.scan import LaserScan
from ..legs.detector import Detections, Detector
from . import leg_kernels, person_tracks
from .camera import CameraTracking, SeenPeople
from .config import TrackerConfig
from .confirmation import TrackConfirmation
from .identities import Identities
from .leg_association import LegAssociation
from .leg_exchange import LegExchange
from .local_grid import LocalGrid
from .merged_legs import MergedLegs
from .people import People
from .reidentification import Reidentification
from .termination import TrackTermination
from .track_kernels import points_of_things
from .tracks import Rows, Tracks

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

    A scan goes through the stages of multi-target tracking: prediction, data association, correction, track
    termination, track confirmation with re-identification; and what is not human marks a local grid.

    Args:
        config: Its numbers, a node for each stage.
        detector: Finds legs in single scans.
    """

    def __init__(self, config: TrackerConfig, detector: Detector) -> None:
        self._config, self._detector = config, detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        config = self._config
        self._tracks = Tracks(config)
        self._grid = LocalGrid(config.grid.resolution, config.grid.rise_s, config.grid.fade_s)
        self._association = LegAssociation(config)
        self._merged_legs = MergedLegs(config.merged_legs, self._grid)
        self._exchange = LegExchange(config.pairing)
        self._termination = TrackTermination(config.termination)
        self._reidentification = Reidentification(config)
        identities = Identities(config.reidentification, self._reidentification)
        self._confirmation = TrackConfirmation(config, self._grid, self._reidentification, identities)
        self._camera = CameraTracking(config, identities)
        self._time_s: float | None = None

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan, the robot's odometry pose T_odom_robot (3,) at that time, and what a camera saw, if it did.

        Raises:
            InputError: If the scan is not later than the one before.
        """
        pose, dt = checked_pose(odometry), self._step(scan.time_s)
        detections = self._detector.detect(scan)
        z = transform_points(pose, detections.positions[detections.human])
        d = detections.confidence[detections.human]
        self._tracks.predict(dt)
        self._reidentification.predict(dt)
        match = self._association.associate(self._tracks, z)
        self._correct(match, z, d, detections, pose, dt)
        match = self._exchange.exchange(self._tracks, match)
        things = self._things(detections, match)
        self._reidentification.add(self._termination.terminate(self._tracks))
        self._tracks.begin(match, z, d)
        points = transform_points(compose(pose, scan.T_robot_lidar), detections.clusters.points)
        self._confirmation.confirm(self._tracks, points, scan.time_s)
        if seen is not None:
            self._camera.update(self._tracks, seen, scan.time_s, dt)
        self._mark_grid(points, detections, things, pose, dt)
        return TrackerUpdate(self._tracks.as_people(scan.time_s), detections, pose)

    def _step(self, time_s: float) -> float:
        """Return the time since the last scan [s]; before the first, that between two scans at the reference rate."""
        before = self._time_s
        if before is not None and not time_s > before:
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        self._time_s = time_s
        return 1.0 / self._config.motion.reference_rate_hz if before is None else time_s - before

    def _correct(self, match: Rows, z: Array, d: Array, detections: Detections, pose: Array, dt: float) -> None:
        """Correct legs and people (eq. 4c to 4e, 6) with detections `z` (m, 2), `d` (m,) that `match` (n,) tracks."""
        tracks = self._tracks
        tracks.legs.correct(match, z, d, dt)
        sightings = person_tracks.measure(tracks.people, match[: tracks.owned].reshape(-1, 2), z, d)
        assert self._time_s is not None
        sightings = self._merged_legs.measure(tracks, sightings, detections, pose, self._time_s)
        person_tracks.correct(tracks.people, sightings, dt, self._config)
        tracks.carry_hidden_legs(match)
        tracks.legs.measure_apart(dt)
        tracks.count_owned(dt)

    def _things(self, detections: Detections, match: Rows) -> NDArray[np.bool_]:
        """Return (c,) which clusters are not human: no leg-like ones, and old tentative tracks that never moved."""
        config, tracks, human = self._config, self._tracks, detections.human
        things = ~human
        bounds = config.grid.still_s, config.confirmation.delta, int(np.count_nonzero(human))
        things[human] = leg_kernels.still(tracks.legs.rows, tracks.owned, match, *bounds)
        return things

    def _mark_grid(
        self, points: Array, detections: Detections, things: NDArray[np.bool_], pose: Array, dt: float
    ) -> None:
        """Mark `points` (k, 2) of the clusters `things`, but never where a person, or what may become one, stands."""
        least, tracks, clusters = self._config.confirmation.delta / 2.0, self._tracks, detections.clusters
        human = leg_kernels.human_places(tracks.people, tracks.legs.rows, least, self._reidentification.positions)
        kept = points_of_things(points, clusters.start, clusters.end, things, human, self._config.grid.clearance)
        assert self._time_s is not None
        self._grid.mark(kept, pose[:2], self._time_s, dt)
