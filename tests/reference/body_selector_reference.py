"""What the kernels of `perception.leader.body_kernels` do, in plain numpy: one object a leader."""

import cloud_reference as kernels
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.distance import cdist
from tagalong.perception.leader.body_selector import BodyConfig
from tagalong.perception.leader.cloud import CloudConfig
from tagalong.perception.leader.estimate import LeaderEstimate, as_leader
from tagalong.perception.leader.legs_of_others import EXPLAINED, SCANS, STEP_M, UNEXPLAINED_S, UNSEEN_S
from tagalong.perception.leader.onset import LeaderConfig, LeaderOnset
from tagalong.perception.legs.range_view import RangeView, seen_in
from tagalong.perception.tracking.people import People, SeenLegs
from tagalong.slam.scan import LaserScan

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
_NOBODY = -2


class PlainLegsOfOthers:
    """Follows, from scan to scan, the legs that were seen apart from the leader: they are somebody else's."""

    def __init__(self) -> None:
        self._legs, self._unseen_s = np.zeros((0, 2)), np.zeros(0)
        self._apart = np.zeros(0, dtype=np.int64)  # scans in a row; somebody else's from `SCANS` on
        self._now = 0
        self._unexplained_s = 0.0

    def update(self, legs: Array, dt: float) -> None:
        """Take the `legs` (k, 2) of a scan, `dt` [s] after the last one, in the odometry frame."""
        apart, gone = np.zeros(len(legs), dtype=np.int64), np.zeros(len(self._legs), dtype=bool)
        if self._apart.any():
            away = cdist(legs, self._legs)
            if len(legs):
                apart = np.where(away.min(axis=1) < STEP_M, self._apart[away.argmin(axis=1)], 0)
            gone = (self._apart >= SCANS) & (self._unseen_s + dt < UNSEEN_S)
            gone &= away.min(axis=0, initial=np.inf) >= STEP_M
        self._now = len(legs)
        self._legs = np.concatenate((legs, self._legs[gone]))
        self._unseen_s = np.concatenate((np.zeros(len(legs)), self._unseen_s[gone] + dt))
        self._apart = np.concatenate((apart, self._apart[gone]))

    @property
    def places(self) -> Array:
        """(n, 2) where legs of others are, or were a moment ago [m]."""
        return self._legs[self._apart >= SCANS]

    def among(self, own: Mask, explained: Array, dt: float) -> Mask:
        """Return (k,) which of the last legs are somebody else's.

        Args:
            own: (k,) which are of the track that carries the leader.
            explained: (k,) how well the leader's body explains each, in [0, 1].
            dt: Since this was last asked [s].
        """
        others = self._apart[: self._now] >= SCANS
        unexplained = bool((others & own).any()) and not bool((~others & (explained > EXPLAINED)).any())
        self._unexplained_s = self._unexplained_s + dt if unexplained else 0.0
        if self._unexplained_s > UNEXPLAINED_S:
            self._apart[: self._now][own] = 0
            others = others & ~own
        return others

    def observe(self, apart: Mask) -> None:
        """Take which of the last legs, (k,), are nobody's and apart from a leader in view."""
        now = self._apart[: self._now]
        now[:] = np.where(now >= SCANS, now, np.where(apart, now + 1, 0))


class PlainCloud:
    """The bodies, each (x, y, vx, vy) in the odometry frame, with weights that sum to one.

    Args:
        config: How a body walks and shows.
        rng: Of all draws.
        position: (2,) of the person who is to be known again [m].
        velocity: (2,) [m/s].
    """

    def __init__(self, config: CloudConfig, rng: np.random.Generator, position: Array, velocity: Array) -> None:
        self.config, self._rng = config, rng
        deviation = np.repeat((config.place_deviation, config.velocity_deviation), 2)
        self.bodies = np.concatenate((position, velocity)) + deviation * rng.standard_normal((config.count, 4))
        self.weights = np.full(config.count, 1.0 / config.count)

    def advance(self, dt: float, view: RangeView) -> None:
        """Let the bodies walk for `dt` [s], and not through what the laser sees."""
        c = self.config
        pushes = c.push * np.sqrt(dt) * self._rng.standard_normal((c.count, 2))
        beams = view.ranges, view.first, view.step, view.laser
        calm = float(np.exp(-dt / c.calm_s))
        kernels.advance(self.bodies, self.weights, pushes, dt, calm, c.top_speed, *beams)
        self.weights /= self.weights.sum()

    def explained(self, legs: Array) -> Array:
        """Return (k,) how well the bodies explain each of `legs` (k, 2), in [0, 1]."""
        return kernels.explained(self.bodies, self.weights, legs, self.config.leg_deviation)

    def weigh(self, legs: Array, count: Array, view: RangeView) -> None:
        """Weigh the bodies by `legs` (k, 2), each counting `count` (k,), and by the view; draw them anew if needed."""
        c = self.config
        unseen = np.array((c.hidden, c.empty, c.instead))
        beams = view.ranges, view.first, view.step, view.laser
        kernels.weigh(self.bodies, self.weights, legs, count, c.leg_deviation, c.most, unseen, *beams)
        self.weights /= self.weights.sum()
        if 1.0 / float(self.weights @ self.weights) < c.resample * c.count:
            self._draw_anew()

    def near(self, places: Array, radius: float) -> Array:
        """Return (k,) the share of the cloud nearer than `radius` [m] to each of `places` (k, 2)."""
        return kernels.mass_near(self.bodies, self.weights, places, radius)

    @property
    def mean(self) -> Array:
        """(4,) mean of the bodies."""
        return np.asarray(self.weights @ self.bodies)

    @property
    def spread(self) -> float:
        """Root mean square distance of the bodies from their mean place [m]."""
        return float(np.sqrt((self.weights @ (self.bodies[:, :2] - self.mean[:2]) ** 2).sum()))

    def _draw_anew(self) -> None:
        """Draw the bodies by their weights, at equal steps of the sum (Kitagawa 1996)."""
        count = self.config.count
        marks = (self._rng.random() + np.arange(count)) / count
        chosen = np.searchsorted(np.cumsum(self.weights), marks)
        self.bodies = self.bodies[np.minimum(chosen, count - 1)]
        self.weights = np.full(count, 1.0 / count)


class PlainSelector:
    """Chooses the person closest to the robot at onset, and keeps to that person's body.

    Args:
        rng: Of the cloud's draws.
        body: Which legs count, and when the cloud decides.
        leader: How the leader is chosen at onset.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        body: BodyConfig | None = None,
        leader: LeaderConfig | None = None,
    ) -> None:
        self._rng, self._body, self._config = rng, body or BodyConfig(), leader or LeaderConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self._leader: LeaderEstimate | None = None
        self._time_s = 0.0
        self._onset = LeaderOnset(self._config)
        self._cloud: PlainCloud | None = None
        self._before: People | None = None
        self._own = -1
        self._others = np.zeros((0, 2))
        self._met_s: dict[int, float] = {}
        self._beside_s: dict[int, float] = {}
        self._others_legs = PlainLegsOfOthers()

    def update(self, people: People, robot_pose: ArrayLike, scan: LaserScan) -> LeaderEstimate | None:
        """Return the leader among `people` with the robot at `robot_pose` (3,), both in the odometry frame.

        None means: nobody has been chosen yet.

        Args:
            people: With the legs seen (`seen_legs`).
            robot_pose: T_odom_robot.
            scan: In which they were seen.
        """
        dt, self._time_s = people.time_s - self._time_s, people.time_s
        before = self._leader
        self._others_legs.update(people.seen_legs.positions, dt)
        chosen = self._onset.choose(people, np.asarray(robot_pose, dtype=np.float64)[:2], before)
        if chosen is not None:
            self._leader, self._own, self._cloud = chosen, chosen.track_id, None
        elif before is not None:
            own = int(np.argmax(people.ids == self._own)) if self._own in people.ids else _NOBODY
            if before.track_id == self._own and self._is_alone(people, own):
                self._cloud, self._leader = None, as_leader(people, own, before.id)
            else:
                self._leader = self._find(people, own, before, dt, seen_in(scan, robot_pose))
            self._keep_others(people.seen_legs, self._leader)
        self._note_people(people)
        self._before = people
        return self._leader

    def _is_alone(self, people: People, own: int) -> bool:
        """Return whether person `own` is seen, with nobody and nobody's legs nearby."""
        if own < 0 or people.unseen_s[own] > 0.0:
            return False
        place, legs = people.positions[own], people.seen_legs
        bodies = people.positions[:own], people.positions[own + 1 :]
        others = np.concatenate((legs.positions[legs.owner != own], *bodies, self._others_legs.places))
        apart = others - place
        return bool(((apart * apart).sum(axis=1) > self._body.alone**2).all())

    def _find(self, people: People, own: int, before: LeaderEstimate, dt: float, view: RangeView) -> LeaderEstimate:
        """Return the leader by its body."""
        legs, c = people.seen_legs, self._body
        if self._cloud is None:
            self._cloud = PlainCloud(c.cloud, self._rng, before.position, before.velocity)
        cloud = self._cloud
        cloud.advance(dt, view)
        free = self._free(cloud, legs, own, dt)
        count = np.where(legs.owner == own, c.own_weight, c.weight) * np.minimum(legs.confidence / c.sure, 1.0) * free
        places = legs.positions
        if own >= 0 and people.unseen_s[own] == 0.0 and not (legs.owner == own).any():  # both legs were seen as one
            places, count = np.vstack((places, people.positions[own])), np.append(count, c.own_weight)
        cloud.weigh(places, count, view)
        return self._decide(cloud, people, before, dt, free)

    def _free(self, cloud: PlainCloud, legs: SeenLegs, own: int, dt: float) -> Array:
        """Return (k,) how likely each of `legs` is the leader's, by who else explains it."""
        c, before = self._body, self._before
        claim = np.zeros(len(legs))
        if before is not None and len(legs):
            others = before.ids != self._own
            places = before.positions[others] + dt * before.velocities[others]
            known = np.array([self._time_s - self._met_s[int(number)] > c.newborn_s for number in before.ids[others]])
            seen = np.exp(-before.unseen_s[others] / c.forget_s) * known
            rights = c.own_claim, c.other_claim, c.other_deviation
            claim = kernels.claimed(legs.positions, legs.owner, own, places, seen, *rights)
            loose = legs.owner < 0
            apart = cdist(legs.positions[loose], self._others).min(axis=1, initial=np.inf)
            claim[loose] = apart < c.known_again
        explained = cloud.explained(legs.positions) + 1e-6
        claim[self._others_legs.among(legs.owner == own, explained, dt)] = c.other_claim
        return explained / (explained + claim)

    def _decide(
        self, cloud: PlainCloud, people: People, before: LeaderEstimate, dt: float, free: Array
    ) -> LeaderEstimate:
        c = self._body
        share = cloud.near(people.positions, c.radius)
        able = np.where(people.unseen_s < c.patience_s, share, 0.0)
        own = np.flatnonzero(people.ids == self._own)
        best = int(able.argmax()) if len(able) else -1
        if len(own) and able[own[0]] > c.keep and able[own[0]] >= able[best] - c.lead:
            return as_leader(people, int(own[0]), before.id)
        if best >= 0 and able[best] > c.take:
            self._own = int(people.ids[best])
            return as_leader(people, best, before.id)
        exchanged = self._exchanged(people, before)
        if before.unseen_s > c.exchange_wait_s and exchanged >= 0:
            self._own, self._cloud = int(people.ids[exchanged]), None
            return as_leader(people, exchanged, before.id)
        if len(own) and people.unseen_s[own[0]] == 0.0 and share[own[0]] < c.drop:
            self._own = -1
        mean = cloud.mean
        legs = people.seen_legs.positions[free > 0.5]
        gathered = cloud.spread < c.gathered and bool((np.hypot(*(legs - mean[:2]).T) < c.radius).any())
        confidence, unseen_s = (c.loose_confidence, 0.0) if gathered else (0.0, before.unseen_s + dt)
        return LeaderEstimate(before.id, -1, mean[:2], mean[2:], gathered, confidence, unseen_s)

    def _exchanged(self, people: People, before: LeaderEstimate) -> int:
        """Return who is in view and was the last to be beside the leader, shortly before it was lost; -1 for nobody."""
        found, latest = -1, self._time_s - before.unseen_s - self._body.exchange_s
        walks = np.hypot(*people.velocities.T) >= self._body.walks
        for i, number in enumerate(people.ids.tolist()):
            beside_s = self._beside_s.get(number, -np.inf)
            if people.unseen_s[i] == 0.0 and number != self._own and walks[i] and beside_s > latest:
                found, latest = i, beside_s
        return found

    def _note_people(self, people: People) -> None:
        """Note when each person was first seen, and when beside the leader.

        Who is there while the leader is in view is somebody else for good.
        """
        leader, c = self._leader, self._body
        if leader is not None and leader.unseen_s < c.exchange_wait_s:
            near = ((people.positions - leader.position) ** 2).sum(axis=1) <= c.beside**2
            for number in people.ids[near & (people.ids != leader.track_id)].tolist():
                self._beside_s[number] = self._time_s
        in_view = self._leader is not None and self._leader.visible
        for number in people.ids.tolist():
            if in_view or number not in self._met_s:
                self._met_s[number] = -np.inf if in_view else people.time_s

    def _keep_others(self, legs: SeenLegs, leader: LeaderEstimate) -> None:
        """Keep the places of legs that are nobody's and not the leader's, while it is in view; follow them later."""
        c, loose = self._body, legs.positions[legs.owner < 0]
        if leader.visible:
            self._others_legs.observe(
                (legs.owner < 0) & (np.hypot(*(legs.positions - leader.position).T) > c.followed_apart)
            )
            self._others = loose[np.hypot(*(loose - leader.position).T) > c.known_apart]
        elif len(self._others) and len(loose):
            apart = cdist(loose, self._others)
            still, gone = apart.min(axis=1) < c.known_again, apart.min(axis=0) >= c.known_again
            self._others = np.vstack((loose[still], self._others[gone]))
