"""People as hypotheses, each of which explains one cluster, two legs, or nothing that is seen, by likelihood.

Predict, associate, correct, weigh, begin, merge, end: a track-oriented multi-target filter with existence probabilities
(Musicki, Evans, Stanicic, "Integrated probabilistic data association", IEEE TAC 39(6), 1994). The evidence is that of
`PersonEvidenceConfig`: what the clusters look like, and whether their place was empty a moment ago.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose, inverse, transform_points
from ...slam.scan import LaserScan
from ..legs.detector import Detections, Detector
from ..legs.recent_views import RecentViews
from . import hypotheses as kernels
from .camera import SeenPeople
from .config import TrackerConfig
from .data_association import assign
from .hypotheses import HYPOTHESIS
from .hypothesis_config import HypothesisConfig
from .lost_people import LostPeople
from .people import People, SeenLegs
from .tracker import TrackerUpdate

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

_VOTES = (0.01, 0.99)
"""A forest of some ten trees is no surer than this."""


class HypothesisTracker:
    """Tracks people in the odometry frame, with moving or standing robots, by hypotheses of whole people.

    Unlike `PeopleTracker` it takes every cluster of legs, however doubtful, and no pair of legs is needed.

    Args:
        config: Its numbers.
        tracker: Numbers that it shares with `PeopleTracker`: motion, termination by variance, re-identification.
        detector: Finds legs in single scans.
    """

    def __init__(self, config: HypothesisConfig, tracker: TrackerConfig, detector: Detector) -> None:
        self._config, self._tracker, self._detector = config, tracker, detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        self._rows = np.zeros(0, dtype=HYPOTHESIS)
        self._odds = np.zeros(0)
        self._views = RecentViews(self._config.views)
        self._lost = LostPeople(self._tracker)
        self._time_s: float | None = None
        self._next_id = 0

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time.

        Raises:
            InputError: If the scan is not later than the one before, or a camera has seen people.
        """
        if seen is not None:
            raise InputError('the method "hypotheses" takes no camera; give "leg pairs"')
        pose, dt = checked_pose(odometry), self._step(scan.time_s)
        lidar, detections = compose(pose, scan.T_robot_lidar), self._detector.detect(scan)
        z = transform_points(pose, detections.positions)
        first, second, affinity = self._evidence(scan, detections, z)
        kernels.predict(self._rows, dt, self._tracker.motion.process_variance(dt))
        self._associate(z, affinity)
        self._correct(z, dt)
        kernels.note_path(self._rows, z, self._config.views.spacing_s)
        self._weigh(scan, lidar, first, second, dt)
        self._begin(z, first, second, affinity, lidar)
        self._views.keep(scan, lidar)
        self._end(scan.time_s)
        self._believe(scan.time_s)
        return TrackerUpdate(self._people(scan.time_s, z), detections, pose)

    def _step(self, time_s: float) -> float:
        before, self._time_s = self._time_s, time_s
        if before is not None and not time_s > before:
            self._time_s = before
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        return 1.0 / self._tracker.motion.reference_rate_hz if before is None else time_s - before

    def _evidence(self, scan: LaserScan, detections: Detections, z: Array) -> tuple[Array, Array, Array]:
        """Return (m,) what each cluster at `z` (m, 2) says as the better leg, as the other one, and to association."""
        config = self._config.evidence
        vote = np.clip(detections.confidence, *_VOTES)
        vote = np.log(vote / (1.0 - vote))
        first = config.base + config.vote * vote + config.empty * self._views.look(z)[:, 0]
        second = np.maximum(0.0, config.second * (vote - config.second_from))
        apart = np.hypot(*(detections.positions - np.asarray(scan.T_robot_lidar[:2])).T)
        possible = (detections.confidence > 0.0) & (apart >= self._config.near)
        affinity = np.clip(first - self._config.indifferent, *self._config.affinity)
        return first, second, np.where(possible, affinity, -np.inf)

    def _associate(self, z: Array, affinity: Array) -> None:
        """Give each hypothesis its most likely cluster, then another of those left as its other leg."""
        rows, config, r = self._rows, self._config, self._tracker.motion.r
        cost = np.empty((len(rows), len(z)))
        kernels.first_costs(rows, z, affinity, r, config.clutter, cost)
        clusters = np.full((len(rows), 2), -1)
        i, j = assign(cost, 0.0)
        clusters[i, 0] = j
        kernels.second_costs(rows, clusters[:, 0], z, affinity, r, config.stride, config.clutter, cost)
        cost[:, j] = np.inf
        i, j = assign(cost, 0.0)
        clusters[i, 1] = j
        rows["clusters"] = clusters

    def _correct(self, z: Array, dt: float) -> None:
        motion = self._tracker.motion
        fade = float(np.exp(-dt / self._tracker.pairing.offset_s))
        kernels.correct(self._rows, z, motion.r, motion.r + motion.one_leg_variance, dt, fade)

    def _weigh(self, scan: LaserScan, lidar: Array, first: Array, second: Array, dt: float) -> None:
        rows, config = self._rows, self._config.evidence
        now = RecentViews(replace(self._config.views, count=1))
        now.keep(scan, lidar)
        places = rows["x"][:, :2]
        viewed = transform_points(inverse(lidar), places)
        looks = config.look, config.jitter, config.most_looks, config.hidden_rate, config.missing_rate
        kernels.weigh(rows, first, second, now.look(places), viewed, dt, *looks)

    def _begin(self, z: Array, first: Array, second: Array, affinity: Array, lidar: Array) -> None:
        """Begin hypotheses at clusters that no hypothesis explains."""
        config, motion = self._config, self._tracker.motion
        able, order = affinity >= config.begin, np.argsort(-first, kind="stable")
        found = kernels.fresh_clusters(self._rows, z, order, able, config.merge, config.own)
        if len(found) == 0:
            return
        a, b = found.T
        paired, other = b >= 0, np.where(b >= 0, b, a)
        fresh = np.zeros(len(found), dtype=HYPOTHESIS)
        fresh["id"], fresh["clusters"], fresh["looks"] = -1, found, 1.0
        fresh["x"][:, :2] = centre = 0.5 * (z[a] + z[other])
        fresh["p"] = (motion.initial_variance, 0.0, 4.0 * motion.initial_variance)  # nobody begins at rest
        fresh["legs"] = np.stack((z[a], z[other]), axis=1) - centre[:, None]
        fresh["evidence"] = first[a] + np.where(paired, np.minimum(second[a], second[other]), 0.0)
        fresh["viewed"] = transform_points(inverse(lidar), centre)
        fresh["path"][:, 0], fresh["places"] = z[a], 1
        self._rows = np.concatenate((self._rows, fresh))

    def _end(self, time_s: float) -> None:
        """End duplicates, and hypotheses that nobody believes in."""
        config = self._config
        rows, odds = self._rows, kernels.log_odds(self._rows, config.evidence.prior, config.evidence.alike)
        keep = kernels.without_duplicates(rows, odds, config.merge, config.own)
        known = rows["id"] >= 0
        keep &= (rows["p"][:, 0] <= self._tracker.termination.epsilon) & np.where(known, odds >= config.stop, True)
        keep &= known | (rows["unseen_s"] <= config.tentative_s)
        self._lost.add(rows[~keep & known], time_s)
        self._rows, self._odds = rows[keep], odds[keep]

    def _believe(self, time_s: float) -> None:
        """Give a number to those who are people now: their old one, where they are somebody lost."""
        config, rows = self._config, self._rows
        sure = (self._odds >= config.sure) | (rows["way"] >= config.least_way)
        for i in np.flatnonzero((rows["id"] < 0) & (self._odds >= config.start) & sure):
            number = self._lost.identify(rows[i], time_s)
            rows["id"][i] = self._next_id if number < 0 else number
            self._next_id += number < 0

    def _people(self, time_s: float, z: Array) -> People:
        known = self._rows["id"] >= 0
        rows, probability = self._rows[known], 1.0 / (1.0 + np.exp(-self._odds))
        i, slot = np.nonzero(self._rows["clusters"] >= 0)
        legs = SeenLegs(
            z[self._rows["clusters"][i, slot]], probability[i], np.where(known, np.cumsum(known) - 1, -1)[i]
        )
        return People(
            time_s=time_s,
            ids=rows["id"].copy(),
            positions=rows["x"][:, :2].copy(),
            velocities=rows["x"][:, 2:].copy(),
            confidence=probability[known],
            legs=rows["x"][:, None, :2] + rows["legs"],
            variance=rows["p"][:, 0].copy(),
            unseen_s=rows["unseen_s"].copy(),
            age_s=rows["age_s"].copy(),
            seen_legs=legs,
        )
