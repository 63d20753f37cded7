"""The leader known by its body, not by the number of a track.

Tracks change bodies when people pass each other closely or hide each other. Beside the tracks, a cloud of the places
where the leader's body may be (`leader_cloud.py`) is fed with every leg seen, as far as nobody else explains it. The
leader is whatever track most of the cloud is at; where there is none, legs that are nobody's, or nothing.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import Endless, check_numbers, check_positive
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ..tracking.data_association import distances
from ..tracking.people import People, SeenLegs
from . import cloud_kernels as kernels
from .cloud import BodyCloud, CloudConfig, LeaderView
from .duplicate_tracks import DuplicateTracks
from .estimate import LeaderEstimate, as_leader
from .legs_of_others import LegsOfOthers
from .onset import LeaderConfig, LeaderOnset

Array = NDArray[np.float64]
_NOBODY = -2
"""No row of people, nor the -1 of legs that are nobody's."""


@dataclass(frozen=True, kw_only=True)
class BodyConfig:
    """Which legs count, and when the cloud decides.

    Attributes:
        cloud: Of the bodies.
        alone: While nobody's legs are nearer to the leader's own than this, there is no doubt, and no cloud [m].
        own_weight: What legs of the leader's own track count.
        weight: What all others count.
        sure: Legs whose track has at least this confidence count fully.
        other_claim: How much more an other person has a right to the legs of its own track than the leader.
        own_claim: The same to legs of the leader's track, which may be stolen.
        other_deviation: Of somebody's leg from where that person is expected [m].
        forget_s: How fast an unseen person's right to legs fades [s].
        newborn_s: Who appears while the leader is out of sight may be it, and has no right to legs for so long [s].
        known_again: A leg this near to where a leg was that was not the leader's is none of the leader's either [m].
        known_apart: A leg that is nobody's, this far from the leader in view, is not the leader's [m].
        followed_apart: The same while that leg is followed from scan to scan, though the leader's track may take it
            [m].
        duplicate_s: Somebody tracked at the leader's own place for longer than this is a second track of the leader,
            and has no right to legs of its own [s].
        radius: A track this near to bodies is theirs [m].
        take: A track takes over as the leader when more than this share of the cloud is at it.
        keep: The leader's own track stays the leader with this share, unless one has `lead` more.
        lead: See there.
        drop: A track that is seen with less than this is not the leader's any more.
        patience_s: A track unseen for longer than this is not followed [s].
        gathered: A cloud that is spread no farther than this, around legs that are nobody's, is the leader seen [m].
        loose_confidence: Confidence of a leader seen so.
    """

    cloud: CloudConfig = field(default_factory=CloudConfig)
    alone: float = 1.5
    own_weight: float = 4.0
    weight: float = 1.5
    sure: float = 0.5
    other_claim: float = 2.0
    own_claim: float = 0.5
    other_deviation: float = 0.35
    forget_s: float = 0.5
    newborn_s: float = 1.0
    known_again: float = 0.3
    known_apart: float = 1.0
    followed_apart: Endless = 0.7
    duplicate_s: Endless = 0.8
    radius: float = 0.5
    take: float = 0.5
    keep: float = 0.25
    lead: float = 0.2
    drop: float = 0.1
    patience_s: float = 0.35
    gathered: float = 0.35
    loose_confidence: float = 0.3

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "sure", "other_deviation", "forget_s", "radius")


class BodyLeaderSelector:
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
        self._cloud: BodyCloud | None = None
        self._before: People | None = None
        self._own = -1
        self._others = np.zeros((0, 2))
        self._met_s: dict[int, float] = {}
        self._others_legs = LegsOfOthers()
        apart = self._config.duplicate_distance
        self._duplicates = DuplicateTracks(apart, self._body.duplicate_s, separation=2.0 * apart)

    def update(self, people: People, robot_pose: ArrayLike, scan: LaserScan | None = None) -> LeaderEstimate | None:
        """Return the leader among `people` with the robot at `robot_pose` (3,), both in the odometry frame.

        None means: nobody has been chosen yet.

        Args:
            people: With the legs seen (`seen_legs`).
            robot_pose: T_odom_robot.
            scan: In which they were seen.

        Raises:
            InputError: If there is no scan.
        """
        if scan is None:
            raise InputError("a leader is known by its body only with the scan at hand, got None")
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
                self._leader = self._find(people, own, before, dt, LeaderView.of(scan, robot_pose))
            self._keep_others(people.seen_legs, self._leader)
        self._note_people(people)
        leader = self._leader
        if leader is not None and leader.track_id >= 0 and leader.visible:
            others = (people.ids != leader.track_id) & (people.unseen_s == 0.0)
            self._duplicates.update(people, leader.position, others, dt)
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

    def _find(self, people: People, own: int, before: LeaderEstimate, dt: float, view: LeaderView) -> LeaderEstimate:
        """Return the leader by its body."""
        legs, c = people.seen_legs, self._body
        if self._cloud is None:
            self._cloud = BodyCloud(c.cloud, self._rng, before.position, before.velocity)
        cloud = self._cloud
        cloud.advance(dt, view)
        free = self._free(cloud, legs, own, dt)
        count = np.where(legs.owner == own, c.own_weight, c.weight) * np.minimum(legs.confidence / c.sure, 1.0) * free
        places = legs.positions
        if own >= 0 and people.unseen_s[own] == 0.0 and not (legs.owner == own).any():  # both legs were seen as one
            places, count = np.vstack((places, people.positions[own])), np.append(count, c.own_weight)
        cloud.weigh(places, count, view)
        return self._decide(cloud, people, before, dt, free)

    def _free(self, cloud: BodyCloud, legs: SeenLegs, own: int, dt: float) -> Array:
        """Return (k,) how likely each of `legs` is the leader's, by who else explains it."""
        c, before = self._body, self._before
        claim = np.zeros(len(legs))
        if before is not None and len(legs):
            others = (before.ids != self._own) & ~self._duplicates.among(before)
            places = before.positions[others] + dt * before.velocities[others]
            known = np.array([self._time_s - self._met_s[int(number)] > c.newborn_s for number in before.ids[others]])
            seen = np.exp(-before.unseen_s[others] / c.forget_s) * known
            rights = c.own_claim, c.other_claim, c.other_deviation
            kernels.claimed(legs.positions, legs.owner, own, places, seen, *rights, claim)
            loose = legs.owner < 0
            apart = distances(legs.positions[loose], self._others).min(axis=1, initial=np.inf)
            claim[loose] = apart < c.known_again
        explained = cloud.explained(legs.positions) + 1e-6
        claim[self._others_legs.among(legs.owner == own, explained, dt)] = c.other_claim
        return explained / (explained + claim)

    def _decide(
        self, cloud: BodyCloud, people: People, before: LeaderEstimate, dt: float, free: Array
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
        if len(own) and people.unseen_s[own[0]] == 0.0 and share[own[0]] < c.drop:
            self._own = -1
        mean = cloud.mean
        legs = people.seen_legs.positions[free > 0.5]
        gathered = cloud.spread < c.gathered and bool((np.hypot(*(legs - mean[:2]).T) < c.radius).any())
        confidence, unseen_s = (c.loose_confidence, 0.0) if gathered else (0.0, before.unseen_s + dt)
        return LeaderEstimate(before.id, -1, mean[:2], mean[2:], gathered, confidence, unseen_s)

    def _note_people(self, people: People) -> None:
        """Note when each person was first seen; who is there while the leader is in view is somebody else for good."""
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
            apart = distances(loose, self._others)
            still, gone = apart.min(axis=1) < c.known_again, apart.min(axis=0) >= c.known_again
            self._others = np.vstack((loose[still], self._others[gone]))
