"""People from leg detections, scan by scan (Ye 2021, section II.A)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.errors import InputError
from ...slam.geometry import compose, transform_points
from ...slam.scan import LaserScan
from ..legs.clusters import Clusters
from ..legs.detector import Detections, Detector
from . import leg_kernels, person_tracks
from .camera import CameraSightings, SeenPeople
from .config import TrackerConfig
from .data_association import assign, distances
from .leg_tracks import LegTracks
from .local_grid import LocalGrid
from .pairing import better_pairs, mutual_pairs
from .people import People
from .person_tracks import Sightings
from .reidentification import ReidentificationMemory
from .track_kernels import any_moved, any_sure_walker, any_wide, points_of_things, spread_among, surviving

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

    Rows 2 i and 2 i + 1 of the leg tracks are the legs of person i; the rows after them are nobody's legs yet.
    """

    def __init__(self, config: TrackerConfig, detector: Detector) -> None:
        self._config, self._detector = config, detector
        self.reset()

    def reset(self) -> None:
        """Forget everything."""
        config = self._config
        self._legs = LegTracks(config)
        self._people = np.zeros(0, dtype=person_tracks.PERSON)
        self._lost = ReidentificationMemory(config)
        self._grid = LocalGrid(config.grid.resolution, config.grid.rise_s, config.grid.fade_s)
        self._camera = CameraSightings(config)
        self._time_s: float | None = None
        self._next_id = 0

    def update(self, scan: LaserScan, odometry: ArrayLike, seen: SeenPeople | None = None) -> TrackerUpdate:
        """Take one scan, the robot's odometry pose T_odom_robot (3,) at that time, and what a camera saw, if it did.

        Raises:
            InputError: If the scan is not later than the one before.
        """
        pose, dt = checked_pose(odometry), self._step(scan.time_s)
        detections = self._detector.detect(scan)
        z = transform_points(pose, detections.positions[detections.human])
        d = detections.confidence[detections.human]
        self._legs.predict(dt)
        person_tracks.predict(self._people, dt, self._config)
        self._lost.predict(dt)
        match = self._reassign_legs(self._associate(z), z)
        self._legs.correct(match, z, d, dt)
        sightings = person_tracks.measure(self._people, match[: 2 * len(self._people)].reshape(-1, 2), z, d)
        sightings = self._see_legs_in_one(sightings, detections, pose, scan.time_s)
        person_tracks.correct(self._people, sightings, dt, self._config)
        self._carry_hidden_legs(match)
        self._legs.measure_apart(dt)
        self._count_owned(dt)
        match = self._exchange_legs(match)
        thing = ~detections.human
        thing[detections.human] = self._is_still(match, len(z))
        self._end_tracks()
        self._begin_legs(match, z, d)
        T_odom_lidar = compose(pose, scan.T_robot_lidar)
        points = transform_points(T_odom_lidar, detections.clusters.points)
        self._start_people(points, scan.time_s)
        if seen is not None:
            self._see_by_camera(seen, scan.time_s, dt)
        self._mark_grid(points, detections.clusters, thing, pose, scan.time_s, dt)
        return TrackerUpdate(self._result(scan.time_s), detections, pose)

    def _step(self, time_s: float) -> float:
        before, self._time_s = self._time_s, time_s
        if before is None:
            return 1.0 / self._config.motion.reference_rate_hz
        if not time_s > before:
            self._time_s = before
            raise InputError(f"scan times must increase [s], got {time_s} after {before}")
        return time_s - before

    def _associate(self, z: Array) -> NDArray[np.intp]:
        """Return each leg track's detection or -1."""
        cost, gates = self._legs.cost(z, self._people["x"][:, :2])
        match = np.full(len(self._legs), -1)
        rows, columns = assign(cost, gates)
        match[rows] = columns
        return match

    def _reassign_legs(self, match: NDArray[np.intp], z: Array) -> NDArray[np.intp]:
        """Give people with a missing leg the lone tracks that could be it; a lone track so taken ends."""
        owned = 2 * len(self._people)
        missing, lone = np.flatnonzero(match[:owned] < 0), owned + np.flatnonzero(match[owned:] >= 0)
        if len(missing) == 0 or len(lone) == 0:
            return match
        candidates = z[match[lone]]
        cost = distances(self._legs.positions[missing], candidates)
        cost[distances(self._people["x"][missing // 2, :2], candidates) > self._config.gating.reach] = np.inf
        other = missing + 1 - 2 * (missing % 2)
        known = self._legs.rows["age_s"][lone] > self._config.pairing.stride_s / 2.0
        limit = np.where(known, self._config.pairing.width, self._config.pairing.distance)
        cost[leg_kernels.spread_between(self._legs.apart, other, lone) > limit] = np.inf
        rows, columns = assign(cost, self._config.gating.reach)
        slots, taken = missing[rows], lone[columns]
        order = np.arange(len(self._legs))
        order[slots] = taken
        order = np.delete(order, taken)
        self._legs.take(order)
        return match[order]

    def _see_legs_in_one(self, sightings: Sightings, found: Detections, pose: Array, time_s: float) -> Sightings:
        """Let people of whom no leg was seen be seen as one cluster of both legs, which no forest of legs believes in.

        It must be wider than a leg, stand where the person was predicted, and on free cells; its confidence counts.
        """
        config = self._config
        unseen = np.flatnonzero(~sightings.seen & (self._since_leg_s() < config.merged_legs.duration_s))
        if len(unseen) == 0:
            return sightings
        ends = found.clusters.points[found.clusters.end - 1] - found.clusters.points[found.clusters.start]
        width = np.hypot(ends[:, 0], ends[:, 1])
        wide = np.flatnonzero(
            ~found.human & (width > config.merged_legs.width_min) & (width < config.merged_legs.width_max)
        )
        positions = transform_points(pose, found.positions[wide])
        free = self._grid.is_free(positions, time_s)
        rows, columns = assign(distances(self._people["x"][unseen, :2], positions[free]), config.merged_legs.gate)
        seen, centre, confidence = sightings.seen.copy(), sightings.centre.copy(), sightings.confidence.copy()
        seen[unseen[rows]] = True
        centre[unseen[rows]] = positions[free][columns]
        confidence[unseen[rows]] = found.confidence[wide][free][columns]
        return Sightings(seen, centre, confidence, sightings.one_leg)

    def _carry_hidden_legs(self, match: NDArray[np.intp]) -> None:
        """Let a person's unseen leg walk with the person, where its offset is believed to be."""
        leg_kernels.carry_hidden(self._legs.rows, self._people, match)

    def _exchange_legs(self, match: NDArray[np.intp]) -> NDArray[np.intp]:
        """Mend people who were started from, or have taken over, a leg of somebody else."""
        owned = 2 * len(self._people)
        if owned == 0:
            return match
        before = np.arange(owned).reshape(-1, 2)
        if not any_wide(self._legs.apart, before, self._config.pairing.margin):
            return match
        rows = self._legs.rows[owned:]
        lone = owned + np.flatnonzero((rows["age_s"] > self._config.pairing.stride_s / 2.0) & (rows["unseen_s"] == 0.0))
        pairs = better_pairs(self._legs.spread(), before, self._legs.rows["owned_s"], lone, self._config.pairing.margin)
        changed = (pairs != before).any(axis=1)
        if not changed.any():
            return match
        self._people["x"][changed, :2] = self._legs.positions[pairs[changed]].mean(axis=1)
        order = np.concatenate((pairs.ravel(), np.setdiff1d(np.arange(len(self._legs)), pairs)))
        self._legs.take(order)
        self._count_owned(0.0)
        return match[order]

    def _count_owned(self, dt: float) -> None:
        owned = 2 * len(self._people)
        self._legs.rows["owned_s"][:owned] += dt
        self._legs.rows["owned_s"][owned:] = 0.0

    def _is_still(self, match: NDArray[np.intp], count: int) -> NDArray[np.bool_]:
        """Return (count,) the detections of lone tracks that are old and never moved: things, not people."""
        config = self._config
        return leg_kernels.still(
            self._legs.rows, 2 * len(self._people), match, config.grid.still_s, config.confirmation.delta, count
        )

    def _end_tracks(self) -> None:
        bounds = self._config.termination.epsilon, self._config.termination.c_min
        alive, keep = surviving(self._people, *bounds), surviving(self._legs.rows, *bounds)
        keep[0 : 2 * len(alive) : 2] = keep[1 : 2 * len(alive) : 2] = alive
        if not alive.all():
            self._lost.remember(self._people[~alive])
            self._people = self._people[alive]
        if not keep.all():
            self._legs.take(np.flatnonzero(keep))

    def _begin_legs(self, match: NDArray[np.intp], z: Array, d: Array) -> None:
        fresh = leg_kernels.unmatched(match, len(z))
        self._legs.begin(z[fresh], d[fresh])

    def _start_people(self, points: Array, time_s: float) -> None:
        """Start a person from each pair of lone tracks that have moved enough, are leg-like (gamma) in the mean over
        time, stand on free cells and belong together: each the other's nearest in the mean over a stride."""
        owned, config = 2 * len(self._people), self._config
        bounds = config.confirmation.delta / 2.0, config.termination.c_min, config.confirmation.unseen_s
        if len(self._lost) == 0 and not any_moved(self._legs.rows, owned, *bounds):
            return
        alive = leg_kernels.promising(self._legs.rows, owned, config.termination.c_min, config.confirmation.unseen_s)
        moved, again = self._legs.moved[alive], self._may_be_met_again(alive)
        if not (again | (moved >= config.confirmation.delta / 2.0)).any():
            return
        spread = spread_among(self._legs.apart, self._legs.rows["x"], alive, config.pairing.distance)
        pairs = mutual_pairs(spread, config.pairing.width)
        confidence = self._legs.rows["confidence"][alive]
        pairs = pairs[confidence[pairs].min(axis=1) >= config.confirmation.gamma]
        sure = confidence >= config.confirmation.sure_confidence
        if len(pairs):
            pairs = pairs[self._moved_together(alive, moved, again, sure, pairs, points, time_s)]
            free = self._grid.is_free(self._legs.positions[alive[pairs.ravel()]], time_s).reshape(-1, 2)
            self._confirm_tracks(alive[pairs[free.all(axis=1)]])
        self._start_by_one_leg(points, time_s)

    def _moved_together(
        self,
        tracks: NDArray[np.intp],
        moved: Array,
        again: NDArray[np.bool_],
        sure: NDArray[np.bool_],
        pairs: NDArray[np.intp],
        points: Array,
        time_s: float,
    ) -> NDArray[np.bool_]:
        """Return (k,) whether both legs of each of `pairs` (k, 2) of `tracks` moved `delta` in the mean.

        So the longer way of one leg makes up for the other, whose track was renewed on the way. Two `sure` legs need
        half as much, and one of them may stand while the other swings past it. Who is met `again` has moved before.
        """
        config = self._config
        goes = moved > config.confirmation.origin_radius
        ways = np.where(again, np.maximum(moved, config.confirmation.delta), moved)[pairs].sum(axis=1)
        both_sure = sure[pairs].all(axis=1)
        enough = ways >= np.where(both_sure, config.confirmation.delta, 2.0 * config.confirmation.delta)
        asked = np.zeros(len(tracks), dtype=bool)
        asked[pairs[enough]] = True
        asked &= goes & ~again
        left = np.ones(len(tracks), dtype=bool)
        left[asked] = self._left_their_place(tracks[asked], points, time_s)
        went = again | (goes & left)
        return enough & left[pairs].all(axis=1) & (both_sure | went[pairs].all(axis=1))

    def _confirm_tracks(self, rows: NDArray[np.intp]) -> None:
        """Make people of the pairs of lone tracks `rows` (k, 2)."""
        if len(rows) == 0:
            return
        owned = 2 * len(self._people)
        self._people = np.concatenate((self._people, self._named(self._legs.rows[rows])))
        rest = np.setdiff1d(np.arange(owned, len(self._legs)), rows)
        self._legs.take(np.concatenate((np.arange(owned), rows.ravel(), rest)))

    def _start_by_one_leg(self, points: Array, time_s: float) -> None:
        """Take up a lost person of whom one leg is seen again, or start one from a sure leg that moved for both.

        It stands on a free cell; the other leg counts as hidden by it, or by what stands before it.
        """
        config, legs = self._config, self._legs
        bounds = (
            2.0 * config.confirmation.delta,
            config.confirmation.sure_confidence,
            config.reidentification.one_leg_age_s,
        )
        if len(self._lost) == 0 and not any_sure_walker(legs.rows, 2 * len(self._people), *bounds):
            return
        lone = np.arange(2 * len(self._people), len(legs))
        lone = lone[
            (legs.rows["unseen_s"][lone] == 0.0) & (legs.rows["age_s"][lone] >= config.reidentification.one_leg_age_s)
        ]
        fit = self._may_be_met_again(lone)
        far = ~fit & (legs.moved[lone] >= 2.0 * config.confirmation.delta)
        far &= legs.rows["confidence"][lone] >= config.confirmation.sure_confidence
        far[far] = self._left_their_place(lone[far], points, time_s)
        lone = lone[fit | far]
        lone = lone[self._grid.is_free(legs.positions[lone], time_s)]
        if len(lone):
            apart = distances(legs.positions[lone], self._lost.positions).min(axis=1, initial=np.inf)
            chosen = lone[apart.argmin()]
            legs.take(np.append(np.arange(len(legs)), chosen))
            self._confirm_tracks(np.array([[chosen, len(legs) - 1]]))

    def _see_by_camera(self, seen: SeenPeople, time_s: float, dt: float) -> None:
        """Correct people by the camera, and start those whom only it knows: they need not have moved.

        Lone leg tracks near such a person are its legs; those not seen yet stand where the camera saw it.
        """
        legs = self._legs
        unknown = self._camera.correct(self._people, seen, time_s, dt)
        for k in self._camera.newcomers(seen, unknown):
            place, lone = seen.positions[k], np.arange(2 * len(self._people), len(legs))
            away = distances(place[None], legs.positions[lone])[0]
            own = lone[np.argsort(away, kind="stable")[:2]]
            own = own[np.sort(away)[:2] <= self._config.pairing.distance / 2.0]
            hidden = np.arange(len(legs), len(legs) + 2 - len(own))
            legs.begin(np.repeat(place[None], len(hidden), axis=0), np.full(len(hidden), seen.likelihood[k]))
            self._confirm_tracks(np.concatenate((own, hidden))[None])
            self._people["x"][-1, :2], self._people["confidence"][-1] = place, seen.likelihood[k]
            self._people["camera_s"][-1] = 0.0

    def _may_be_met_again(self, tracks: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return (k,) whether `tracks` (k,) stand where a lost person, who moved before, must be by now."""
        age_s = self._legs.rows["age_s"][tracks]
        near = self._lost.may_be(self._legs.positions[tracks], age_s, self._config.reidentification.near)
        return near & (age_s >= self._config.reidentification.near_age_s)

    def _left_their_place(self, tracks: NDArray[np.intp], points: Array, time_s: float) -> NDArray[np.bool_]:
        """Return (k,) whether nothing of the scan stands any more where the `tracks` (k,) began.

        A track that hopped from one chair leg to the next has moved, but what it began at still stands there. Where
        that is known to be no human, the track begins anew here.
        """
        first = self._legs.rows["first"][tracks]
        left = distances(first, points).min(axis=1, initial=np.inf) > self._config.confirmation.origin_radius
        self._legs.restart_moving(tracks[~left & ~self._grid.is_free(first, time_s)])
        return left

    def _named(self, pairs: NDArray[np.void]) -> NDArray[np.void]:
        """Return people from pairs of legs (k, 2), with their old number where they are recognised."""
        people = person_tracks.new_people(pairs)
        doubtful = np.minimum(self._since_leg_s(), self._people["camera_s"]) > self._config.reidentification.unseen_s
        people["id"] = self._lost.recognise(people["x"][:, :2], people["age_s"], self._people[doubtful])
        slid = np.isin(self._people["id"], people["id"])  # off to something else: ends with the next scan
        self._people["confidence"][slid] = self._people["age_s"][slid] = 0.0  # and is not remembered as somebody lost
        fresh = np.concatenate((slid, people["id"] < 0))
        numbers = np.concatenate((self._people["id"], people["id"]))
        numbers[fresh] = self._next_id + np.arange(np.count_nonzero(fresh))
        self._next_id += np.count_nonzero(fresh)
        self._people["id"], people["id"] = np.split(numbers, [len(self._people)])
        return people

    def _since_leg_s(self) -> Array:
        """Return (n,) the time since a leg of each person was seen apart [s]."""
        return leg_kernels.since_leg(self._legs.rows, len(self._people))

    def _mark_grid(
        self, points: Array, clusters: Clusters, thing: NDArray[np.bool_], pose: Array, time_s: float, dt: float
    ) -> None:
        """Mark `points` (k, 2) of the clusters `thing`, but never where a person, or what may become one, stands."""
        least = self._config.confirmation.delta / 2.0
        human = leg_kernels.human_places(self._people, self._legs.rows, least, self._lost.positions)
        kept = points_of_things(points, clusters.start, clusters.end, thing, human, self._config.grid.clearance)
        self._grid.mark(kept, pose[:2], time_s, dt)

    def _result(self, time_s: float) -> People:
        people = self._people
        return People(
            time_s=time_s,
            ids=people["id"].copy(),
            positions=people["x"][:, :2].copy(),
            velocities=people["x"][:, 2:].copy(),
            confidence=people["confidence"].copy(),
            legs=self._legs.positions[: 2 * len(people)].reshape(-1, 2, 2).copy(),
            variance=people["p"][:, 0].copy(),
            unseen_s=people["unseen_s"].copy(),
            age_s=people["age_s"].copy(),
            seen_legs=self._legs.seen_now(len(people)),
        )
