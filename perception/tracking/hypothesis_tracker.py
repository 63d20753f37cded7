"""People as hypotheses, each of which explains one cluster, two legs, or nothing that is seen, by likelihood.

Predict, associate, correct, weigh, begin, merge, end: a track-oriented multi-target filter with existence probabilities
(Musicki, Evans, Stanicic, "Integrated probabilistic data association", IEEE TAC 39(6), 1994). The evidence is that of
`PersonEvidenceConfig`: what the clusters look like, and whether their place was empty a moment ago.
"""

from dataclasses import dataclass, replace

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
from .local_grid import OCCUPIED, LocalGrid
from .lost_people import LostPeople
from .people import People, SeenLegs
from .still_frame import StillFrame
from .track_kernels import points_of_things
from .tracker import TrackerUpdate

Array = NDArray[np.float64]
Rows = NDArray[np.intp]

_VOTES = (0.01, 0.99)
"""A forest of some ten trees is no surer than this."""


_LONG_AGO_S = 1e3
"""A leg that was never seen is as uncertain as one that was last seen so long ago."""


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
        self._now = RecentViews(replace(self._config.views, count=1))
        self._frame = StillFrame(self._config.frame)
        self._lost = LostPeople(self._tracker)
        config = self._config
        self._grid = LocalGrid(self._tracker.grid.resolution, config.still_s / OCCUPIED, config.fade_s)
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
        sight = self._look(scan, detections, transform_points(pose, detections.positions), lidar, dt)
        self._now.reset()
        self._now.keep(scan, lidar)
        kernels.predict(self._rows, dt, self._tracker.motion.process_variance(dt))
        self._associate(sight)
        self._correct(sight.z, dt)
        self._note_path(sight.z, lidar, scan.time_s, dt)
        self._weigh(sight, lidar, dt)
        self._begin(sight, lidar)
        self._views.keep(scan, lidar)
        self._end(sight, scan.time_s)
        self._believe(scan.time_s)
        self._mark_grid(transform_points(lidar, scan.points), pose, scan.time_s, dt)
        return TrackerUpdate(self._people(scan.time_s, sight.z), self._remembering(detections, sight.free), pose)

    def _step(self, time_s: float) -> float:
        before, self._time_s = self._time_s, time_s
        if before is not None and not time_s > before:
            self._time_s = before
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        return 1.0 / self._tracker.motion.reference_rate_hz if before is None else time_s - before

    def _look(self, scan: LaserScan, detections: Detections, z: Array, lidar: Array, dt: float) -> "_Sight":
        """Return what the clusters at `z` (m, 2) show."""
        config = self._config.evidence
        vote = np.clip(detections.confidence, *_VOTES)
        vote = np.log(vote / (1.0 - vote))
        walls = transform_points(lidar, self._frame.walls(detections.clusters))
        shares, free = self._views.look(np.concatenate((z, walls))), self._grid.is_free(z, scan.time_s)
        self._frame.update(shares[len(z) :], dt)
        shares = shares[: len(z)]
        empty = shares[:, 0] / (shares.sum(axis=1) + self._config.unknown)
        first = config.base + config.vote * vote + config.empty * self._frame.known * empty
        second = np.maximum(0.0, config.second * (vote - config.second_from))
        apart = np.hypot(*(detections.positions - np.asarray(scan.T_robot_lidar[:2])).T)
        possible = (detections.confidence > 0.0) & (apart >= self._config.near)
        affinity = np.clip(first - self._config.indifferent, *self._config.affinity)
        affinity = np.where(possible, affinity, -np.inf)
        return _Sight(z, first, second, affinity, free, empty >= self._config.came)

    def _remembering(self, detections: Detections, free: NDArray[np.bool_]) -> Detections:
        """Return `detections` (m,) less sure where something has stood still, and surer where it is `free` (m,)."""
        vote = np.clip(detections.confidence, 1e-6, 1.0 - 1e-6)
        odds = vote / (1.0 - vote) * np.exp(np.where(free, 1.0, -1.0) * self._config.memory * self._frame.known)
        confidence = np.where(detections.confidence > 0.0, odds / (1.0 + odds), 0.0)
        return replace(detections, confidence=confidence, human=confidence >= self._tracker.confirmation.gamma)

    def _associate(self, sight: "_Sight") -> None:
        """Give the legs of all hypotheses the clusters that they are together most likely.

        A cluster where something has stood still is that thing: it is somewhere in three by three cells of the grid,
        not anywhere; who steps there is seen beside it.
        """
        config, rows, z = self._config, self._rows, sight.z
        cost, side = np.empty((2 * len(rows), len(z))), 3.0 * self._tracker.grid.resolution
        thing = np.where(sight.free, 0.0, -self._frame.known * np.log(side**2 * config.clutter))
        legs = config.leg**2, config.pace, 0.5 * config.stride, config.clutter
        kernels.leg_costs(rows, z, sight.affinity, thing, *legs, cost)
        clusters = np.full(2 * len(rows), -1)
        i, j = assign(cost, 0.0)
        clusters[i] = j
        rows["clusters"] = clusters.reshape(-1, 2)

    def _correct(self, z: Array, dt: float) -> None:
        motion = self._tracker.motion
        fade = float(np.exp(-dt / self._tracker.pairing.offset_s))
        kernels.correct(self._rows, z, motion.r, motion.r + motion.one_leg_variance, dt, fade)
        rows = self._rows
        rows["placed_s"] = np.where(rows["p"][:, 0] <= self._config.told, rows["placed_s"] + dt, 0.0)

    def _note_path(self, z: Array, lidar: Array, time_s: float, dt: float) -> None:
        rows, config = self._rows, self._config
        seen, free = transform_points(inverse(lidar), z), self._grid.is_free(rows["x"][:, :2], time_s)
        known, spacing_s = self._frame.known, self._config.views.spacing_s
        least = config.least_way, config.least_pace, config.evidence.jitter
        kernels.note_path(rows, seen, free, known, dt, spacing_s, *least)
        stood = rows["stands_s"] >= config.stand_s
        rows["moved"][stood], rows["born"][stood] = 0.0, rows["x"][stood, :2]

    def _weigh(self, sight: "_Sight", lidar: Array, dt: float) -> None:
        rows, config = self._rows, self._config.evidence
        places = rows["x"][:, :2]
        viewed = transform_points(inverse(lidar), places)
        looks = config.look, config.jitter, config.most_looks, config.hidden_rate, config.missing_rate
        empty = self._now.look(places, self._config.body)
        kernels.weigh(rows, sight.first, sight.second, empty, viewed, self._frame.known, dt, *looks)

    def _begin(self, sight: "_Sight", lidar: Array) -> None:
        """Begin hypotheses at clusters that no hypothesis explains."""
        z, first, second = sight.z, sight.first, sight.second
        config, motion = self._config, self._tracker.motion
        able, order = sight.affinity >= config.begin, np.argsort(-first, kind="stable")
        found = kernels.fresh_clusters(self._rows, z, order, able, config.merge, config.own)
        if len(found) == 0:
            return
        a, b = found.T
        paired, other = b >= 0, np.where(b >= 0, b, a)
        fresh = np.zeros(len(found), dtype=HYPOTHESIS)
        fresh["id"], fresh["clusters"], fresh["looks"] = -1, found, 1.0
        fresh["x"][:, :2] = centre = 0.5 * (z[a] + z[other])
        fresh["p"] = (motion.initial_variance, 0.0, 4.0 * motion.initial_variance)  # nobody begins at rest
        fresh["leg_unseen_s"] = np.where(found >= 0, 0.0, _LONG_AGO_S)
        fresh["legs"] = np.stack((z[a], z[other]), axis=1) - centre[:, None]
        fresh["evidence"] = first[a] + np.where(paired, np.minimum(second[a], second[other]), 0.0)
        fresh["viewed"] = transform_points(inverse(lidar), centre)
        fresh["stood"] = fresh["born"] = centre
        fresh["path"][:, 0], fresh["seen"][:, 0], fresh["places"] = centre, transform_points(inverse(lidar), z[a]), 1
        self._rows = np.concatenate((self._rows, fresh))

    def _end(self, sight: "_Sight", time_s: float) -> None:
        """End duplicates, and hypotheses that nobody believes in."""
        config, rows, evidence = self._config, self._rows, self._config.evidence
        odds = kernels.log_odds(rows, evidence.prior, evidence.alike, evidence.moved, config.least_way)
        still = 2.0 * config.memory * self._may_stand(sight, time_s) + rows["stands_s"] / config.stand_s
        odds -= self._frame.known * still
        keep = kernels.without_duplicates(rows, odds, config.merge, config.own)
        known = rows["id"] >= 0
        keep &= (rows["p"][:, 0] <= config.vague) & np.where(known, odds >= config.stop, True)
        keep &= known | (rows["unseen_s"] <= config.tentative_s)
        self._lost.add(rows[~keep & known], time_s)
        self._rows, self._odds = rows[keep], odds[keep]

    def _believe(self, time_s: float) -> None:
        """Give a number to those who are people now; somebody lost is found again sooner, under the old number."""
        config, rows, odds = self._config, self._rows, self._odds
        for i in np.flatnonzero((rows["id"] < 0) & (odds >= config.start - config.again)):
            lost = self._lost.nearest(rows[i], time_s)
            if lost >= 0:
                rows["id"][i] = self._lost.take(lost)
            elif odds[i] >= config.start:
                rows["id"][i] = self._next_id
                self._next_id += 1

    def _may_stand(self, sight: "_Sight", time_s: float) -> NDArray[np.bool_]:
        """Return (n,) which hypotheses are where something stands still, or may do so for all that is known yet."""
        config, rows = self._config, self._rows
        leg = rows["clusters"].max(axis=1)
        free = self._grid.is_free(rows["x"][:, :2], time_s) & np.append(sight.free, True)[leg]
        return ~free | ((rows["age_s"] < config.still_s) & ~np.append(sight.came, False)[leg])

    def _mark_grid(self, points: Array, pose: Array, time_s: float, dt: float) -> None:
        """Mark where something stands by the returns `points` (k, 2) of a scan, but not where somebody who came is."""
        rows = self._rows
        known = rows[(rows["id"] >= 0) & (rows["moved"] >= self._config.least_way)]
        people = np.concatenate((known["x"][:, None, :2], known["x"][:, None, :2] + known["legs"]), axis=1)
        all_of_them = np.zeros(1, dtype=np.int64), np.array([len(points)]), np.ones(1, dtype=np.bool_)
        things = points_of_things(points, *all_of_them, people.reshape(-1, 2), self._tracker.grid.clearance)
        self._grid.mark(things, pose[:2], time_s, dt)

    def _people(self, time_s: float, z: Array) -> People:
        """Return who is believed in and where they are is known: who is hidden for longer is not told of meanwhile."""
        known = (self._rows["id"] >= 0) & (self._rows["p"][:, 0] <= self._config.told)
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
            age_s=rows["placed_s"].copy(),
            seen_legs=legs,
        )


@dataclass(frozen=True, eq=False)
class _Sight:
    """What the clusters of one scan show.

    Attributes:
        z: (m, 2) where they are [m].
        first: (m,) evidence of each as the better leg.
        second: (m,) as the other one.
        affinity: (m,) what each says to association.
        free: (m,) whether nothing has stood still there.
        came: (m,) whether nothing at all was there a moment ago.
    """

    z: Array
    first: Array
    second: Array
    affinity: Array
    free: NDArray[np.bool_]
    came: NDArray[np.bool_]
