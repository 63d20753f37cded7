"""What the kernels of `perception.tracking.following` do with a scan, stage by stage in plain numpy and scipy."""

import leg_tracks_reference as legs_of
import numpy as np
import tracking_reference as tracks_of
from numpy.typing import NDArray
from pairing_reference import better_pairs_reference, mutual_pairs_reference
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from tagalong.perception.legs.detector import Detections
from tagalong.perception.tracking import kalman
from tagalong.perception.tracking.config import TrackerConfig
from tagalong.perception.tracking.tracks import LEG, PERSON
from tagalong.slam.geometry import transform_points

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
Mask = NDArray[np.bool_]


def assign_reference(cost: Array, gate: float | Array) -> tuple[Rows, Rows]:
    """Return the pairs of least total cost, where leaving a row unmatched costs its `gate`."""
    limit = np.full(len(cost), gate, dtype=np.float64)
    rows, columns = np.flatnonzero((cost < limit[:, None]).any(axis=1)), np.flatnonzero((cost < limit[:, None]).any(0))
    gain = np.minimum(cost - limit[:, None], 0.0)[np.ix_(rows, columns)]
    i, j = linear_sum_assignment(gain)
    real = gain[i, j] < 0.0
    return rows[i[real]], columns[j[real]]


class PlainGrid:
    """The rules of `LocalGrid`, cell by cell in a dictionary."""

    def __init__(self, resolution: float, rise_s: float, fade_s: float) -> None:
        self.resolution, self.rise_s, self.fade_s = resolution, rise_s, fade_s
        self.cells: dict[tuple[int, int], tuple[float, float]] = {}

    def mark(self, points: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of `points` (k, 2)."""
        for x, y in {tuple(cell) for cell in np.floor(points / self.resolution).astype(int).tolist()}:
            self.cells[x, y] = (min(1.0, self.evidence((x, y), time_s) + dt / self.rise_s), time_s)

    def evidence(self, cell: tuple[int, int], time_s: float) -> float:
        """Return that of a `cell`, faded."""
        value, seen_s = self.cells.get(cell, (0.0, time_s))
        return value * float(np.exp((seen_s - time_s) / self.fade_s))

    def is_free(self, points: Array, time_s: float) -> Mask:
        """Return (n,) whether the cells of `points` (n, 2) and those around are free."""
        around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        cells = np.floor(points / self.resolution).astype(int).tolist()
        return np.array(
            [max(self.evidence((x + i, y + j), time_s) for i, j in around) < 0.5 for x, y in cells], dtype=bool
        )


class PlainTracker:
    """Rows of legs, of people, and of the lost; `see` takes one scan."""

    def __init__(self, config: TrackerConfig) -> None:
        self.config = config
        self.legs, self.apart = np.zeros(0, LEG), np.zeros((0, 0, 2))
        self.people, self.lost, self.next_id = np.zeros(0, PERSON), np.zeros(0, PERSON), 0
        self.grid = PlainGrid(config.grid.resolution, config.grid.rise_s, config.grid.fade_s)

    @property
    def owned(self) -> int:
        """How many legs are those of people: so many come first."""
        return 2 * len(self.people)

    def see(self, found: Detections, pose: Array, lidar: Array, time_s: float, dt: float) -> None:
        """Take one scan."""
        c = self.config
        places, points = transform_points(pose, found.positions), transform_points(lidar, found.clusters.points)
        z, d, q = places[found.human], found.confidence[found.human], c.motion.process_variance(dt)
        tracks_of.predict(self.legs, dt, q)
        self.people["camera_s"] += dt
        self.people["offset"] *= np.exp(-dt / c.pairing.offset_s)
        tracks_of.predict(self.people, dt, q)
        self._predict_lost(dt, q)
        match = self._associate(z)
        self._correct(match, z, d, found, places, time_s, dt)
        match = self._exchange(match)
        things = ~found.human
        still = c.grid.still_s, c.confirmation.delta, len(z)
        things[found.human] = legs_of.still(self.legs, self.owned, match, *still)
        self._terminate()
        fresh = legs_of.unmatched(match, len(z))
        self._begin(z[fresh], d[fresh])
        self._confirm(points, time_s)
        humans = legs_of.human_places(self.people, self.legs, c.confirmation.delta / 2.0, self.lost["x"][:, :2])
        edges = found.clusters.start, found.clusters.end
        kept = tracks_of.points_of_things(points, *edges, things, humans, c.grid.clearance)
        self.grid.mark(kept, time_s, dt)

    def _predict_lost(self, dt: float, q: float) -> None:
        lost = self.lost
        lost["x"][:, 2:] *= np.exp(-dt / self.config.motion.coast_s)
        lost["x"], lost["p"] = kalman.predict(lost["x"], lost["p"], dt, q)
        lost["unseen_s"] += dt
        self.lost = lost[lost["unseen_s"] <= self.config.reidentification.max_age_s]

    def _take(self, order: Rows) -> None:
        self.legs, self.apart = self.legs[order], self.apart[np.ix_(order, order)]

    def _begin(self, z: Array, d: Array) -> None:
        fresh, variance = np.zeros(len(z), LEG), self.config.motion.initial_variance
        fresh["x"][:, :2] = fresh["seen"] = fresh["first"] = fresh["low"] = fresh["high"] = z
        fresh["p"], fresh["confidence"] = (variance, 0.0, variance), d
        self.legs = np.concatenate((self.legs, fresh))
        self.apart = tracks_of.with_fresh(self.apart, self.legs["x"][:, :2])

    def _associate(self, z: Array) -> Rows:
        g, legs = self.config.gating, self.legs
        gates = np.minimum(g.gate + g.gate_speed * legs["unseen_s"], g.gate_max)
        cost = tracks_of.leg_costs(legs, self.people["x"][:, :2], z, g.reach, g.anchor_s, gates)
        match = np.full(len(legs), -1)
        rows, columns = assign_reference(cost, gates)
        match[rows] = columns
        return self._fill_missing(match, z)

    def _fill_missing(self, match: Rows, z: Array) -> Rows:
        p, owned = self.config.pairing, self.owned
        missing, free = np.flatnonzero(match[:owned] < 0), owned + np.flatnonzero(match[owned:] >= 0)
        if len(missing) == 0 or len(free) == 0:
            return match
        candidates = z[match[free]]
        cost = cdist(self.legs["x"][missing, :2], candidates)
        cost[cdist(self.people["x"][missing // 2, :2], candidates) > self.config.gating.reach] = np.inf
        other = missing + 1 - 2 * (missing % 2)
        limit = np.where(self.legs["age_s"][free] > p.stride_s / 2.0, p.width, p.distance)
        cost[np.linalg.norm(self.apart[np.ix_(other, free)], axis=2) > limit] = np.inf
        rows, columns = assign_reference(cost, self.config.gating.reach)
        order = np.arange(len(self.legs))
        order[missing[rows]] = free[columns]
        order = np.delete(order, free[columns])
        self._take(order)
        return match[order]

    def _correct(
        self, match: Rows, z: Array, d: Array, found: Detections, places: Array, time_s: float, dt: float
    ) -> None:
        m, gain = self.config.motion, self.config.motion.confidence_weight(dt)
        tracks_of.correct_legs(self.legs, match, z, d, m.r, gain)
        offset = self.people["offset"]
        seen, one, centre, sure = tracks_of.measure_people(offset, match[: self.owned].reshape(-1, 2), z, d)
        self._merged(seen, centre, sure, found, places, time_s)
        variance = np.where(one, m.r + m.one_leg_variance, m.r)
        tracks_of.correct_people(self.people, seen, centre, sure, variance, gain)
        legs_of.carry_hidden(self.legs, self.people, match)
        stride = dt, self.config.pairing.stride_s
        self.apart = tracks_of.average_apart(self.legs["x"][:, :2], self.legs["age_s"], self.apart, *stride)
        self.legs["owned_s"][: self.owned] += dt
        self.legs["owned_s"][self.owned :] = 0.0

    def _merged(self, seen: Mask, centre: Array, sure: Array, found: Detections, places: Array, time_s: float) -> None:
        c, points = self.config.merged_legs, found.clusters.points
        unseen = np.flatnonzero(~seen & (legs_of.since_leg(self.legs, len(self.people)) < c.duration_s))
        width = np.hypot(*(points[found.clusters.end - 1] - points[found.clusters.start]).T)
        wide = np.flatnonzero(~found.human & (width > c.width_min) & (width < c.width_max))
        wide = wide[self.grid.is_free(places[wide], time_s)]
        rows, columns = assign_reference(cdist(self.people["x"][unseen, :2], places[wide]), c.gate)
        seen[unseen[rows]], centre[unseen[rows]] = True, places[wide[columns]]
        sure[unseen[rows]] = found.confidence[wide[columns]]

    def _exchange(self, match: Rows) -> Rows:
        before, margin = np.arange(self.owned).reshape(-1, 2), self.config.pairing.margin
        tentative = self.legs[self.owned :]
        known = (tentative["age_s"] > self.config.pairing.stride_s / 2.0) & (tentative["unseen_s"] == 0.0)
        free, spread = self.owned + np.flatnonzero(known), np.linalg.norm(self.apart, axis=2)
        pairs = better_pairs_reference(spread, before, self.legs["owned_s"], free, margin)
        changed = (pairs != before).any(axis=1)
        self.people["x"][changed, :2] = self.legs["x"][pairs[changed], :2].mean(axis=1)
        order = np.concatenate((pairs.ravel(), np.setdiff1d(np.arange(len(self.legs)), pairs)))
        self._take(order)
        self.legs["owned_s"][self.owned :] = 0.0
        return match[order]

    def _terminate(self) -> None:
        t = self.config.termination
        alive, keep = (
            (rows["p"][:, 0] <= t.epsilon) & (rows["confidence"] >= t.c_min) for rows in (self.people, self.legs)
        )
        keep[: self.owned] = np.repeat(alive, 2)
        ended, self.people = self.people[~alive], self.people[alive]
        self.lost = np.concatenate((self.lost, ended[ended["age_s"] >= self.config.reidentification.known_s]))
        self._take(np.flatnonzero(keep))

    def _confirm(self, points: Array, time_s: float) -> None:
        c, legs = self.config.confirmation, self.legs
        rows = legs_of.promising(legs, self.owned, self.config.termination.c_min, c.unseen_s)
        moved, known = legs_of.moved(legs)[rows], self._may_be_legs(rows)
        if (known | (moved >= c.delta / 2.0)).any():
            self._confirm_pairs(rows, moved, known, points, time_s)
            self._confirm_one_leg(points, time_s)

    def _confirm_pairs(self, rows: Rows, moved: Array, known: Mask, points: Array, time_s: float) -> None:
        c, p, legs = self.config.confirmation, self.config.pairing, self.legs
        spread = np.linalg.norm(self.apart[np.ix_(rows, rows)], axis=2)
        spread[cdist(legs["x"][rows, :2], legs["x"][rows, :2]) > p.distance] = np.inf
        np.fill_diagonal(spread, np.inf)
        pairs = mutual_pairs_reference(spread, p.width)
        pairs = pairs[legs["confidence"][rows][pairs].min(axis=1, initial=np.inf) >= c.gamma]
        moves, sure = moved > c.origin_radius, (legs["confidence"][rows] >= c.sure_confidence)[pairs].all(axis=1)
        ways = np.where(known, np.maximum(moved, c.delta), moved)[pairs].sum(axis=1)
        enough = ways >= np.where(sure, c.delta, 2.0 * c.delta)
        asked = np.isin(np.arange(len(rows)), pairs[enough]) & moves & ~known
        left = np.ones(len(rows), bool)
        left[asked] = self._left_origin(rows[asked], points, time_s)
        went = known | (moves & left)
        pairs = pairs[enough & left[pairs].all(axis=1) & (sure | went[pairs].all(axis=1))]
        free = self.grid.is_free(legs["x"][rows[pairs.ravel()], :2], time_s).reshape(-1, 2).all(axis=1)
        self._make_people(rows[pairs[free]])

    def _left_origin(self, rows: Rows, points: Array, time_s: float) -> Mask:
        first = self.legs["first"][rows]
        left = cdist(first, points).min(axis=1, initial=np.inf) > self.config.confirmation.origin_radius
        anew = rows[~left & ~self.grid.is_free(first, time_s)]
        for name in ("first", "low", "high"):
            self.legs[name][anew] = self.legs["x"][anew, :2]
        return left

    def _confirm_one_leg(self, points: Array, time_s: float) -> None:
        c, legs = self.config.confirmation, self.legs
        rows = np.arange(self.owned, len(legs))
        old = legs["age_s"][rows] >= self.config.reidentification.one_leg_age_s
        rows = rows[(legs["unseen_s"][rows] == 0.0) & old]
        known = self._may_be_legs(rows)
        walked = ~known & (legs_of.moved(legs)[rows] >= 2.0 * c.delta) & (legs["confidence"][rows] >= c.sure_confidence)
        walked[walked] = self._left_origin(rows[walked], points, time_s)
        rows = rows[known | walked]
        rows = rows[self.grid.is_free(legs["x"][rows, :2], time_s)]
        if len(rows):
            apart = cdist(legs["x"][rows, :2], self.lost["x"][:, :2]).min(axis=1, initial=np.inf)
            chosen = rows[apart.argmin()]
            self._take(np.append(np.arange(len(legs)), chosen))
            self._make_people(np.array([[chosen, len(self.legs) - 1]]))

    def _farness(self, people: NDArray[np.void], positions: Array, age_s: Array) -> Array:
        c = self.config.reidentification
        cost = cdist(positions, people["x"][:, :2])
        gate = np.minimum(2.0 * np.sqrt(people["p"][:, 0]), c.distance)
        cost[(cost > gate) | (age_s[:, None] > people["unseen_s"] + c.overlap_s)] = np.inf
        return cost

    def _may_be_legs(self, rows: Rows) -> Mask:
        c, age_s = self.config.reidentification, self.legs["age_s"][rows]
        cost = self._farness(self.lost, self.legs["x"][rows, :2], age_s)
        return (age_s >= c.near_age_s) & (cost.min(axis=1, initial=np.inf) <= c.near)

    def _make_people(self, pairs: Rows) -> None:
        legs, fresh = self.legs[pairs], np.zeros(len(pairs), PERSON)
        for name in ("x", "p", "confidence"):
            fresh[name] = legs[name].mean(axis=1)
        fresh["age_s"], fresh["camera_s"] = legs["age_s"].min(axis=1), np.inf
        fresh["offset"] = (legs["x"][:, 0, :2] - legs["x"][:, 1, :2]) / 2.0
        since_s = np.minimum(legs_of.since_leg(self.legs, len(self.people)), self.people["camera_s"])
        unsure = self.people[since_s > self.config.reidentification.unseen_s]
        among, fresh["id"] = np.concatenate((self.lost, unsure)), -1
        cost = self._farness(among, fresh["x"][:, :2], fresh["age_s"])
        rows, columns = assign_reference(cost, self.config.reidentification.distance)
        fresh["id"][rows] = among["id"][columns]
        self.lost = np.delete(self.lost, columns[columns < len(self.lost)])
        double = np.isin(self.people["id"], fresh["id"])
        self.people["confidence"][double] = self.people["age_s"][double] = 0.0
        for ids, anew in ((self.people["id"], double), (fresh["id"], fresh["id"] < 0)):
            ids[anew] = self.next_id + np.arange(np.count_nonzero(anew))
            self.next_id += np.count_nonzero(anew)
        owned, self.people = self.owned, np.concatenate((self.people, fresh))
        rest = np.setdiff1d(np.arange(owned, len(self.legs)), pairs)
        self._take(np.concatenate((np.arange(owned), pairs.ravel(), rest)))
