"""The leader known by its body, not by the number of a track.

Tracks change bodies when people pass each other closely or hide each other. Beside the tracks, a cloud of the places
where the leader's body may be (`leader_cloud.py`) is fed with every leg seen, as far as nobody else explains it. The
leader is whatever track most of the cloud is at; where there is none, legs that are nobody's, or nothing.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import Endless, check_numbers, check_positive
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ...slam.view_kernel import as_record
from ..legs.range_view import seen_in
from ..tracking.people import People
from . import body_kernels as kernels
from .body_memory import CLOUD, FRESH, Company, can_hold, memory_of, nothing_remembered, with_more_room
from .cloud import CloudConfig
from .estimate import LeaderEstimate
from .onset import LeaderConfig

Array = NDArray[np.float64]


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
        radius: A track this near to bodies is theirs [m].
        take: A track takes over as the leader when more than this share of the cloud is at it.
        keep: The leader's own track stays the leader with this share, unless one has `lead` more.
        lead: See there.
        drop: A track that is seen with less than this is not the leader's any more.
        patience_s: A track unseen for longer than this is not followed [s].
        gathered: A cloud that is spread no farther than this, around legs that are nobody's, is the leader seen [m].
        loose_confidence: Confidence of a leader seen so.
        beside: Two people this near to each other may exchange their tracks [m].
        exchange_s: Tracks may be exchanged up to so long before the leader is lost [s].
        exchange_wait_s: After so long, whoever was beside the leader then, walks and is in view is taken for it [s].
        walks: Who is slower than this stands [m/s].
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
    radius: float = 0.5
    take: float = 0.5
    keep: float = 0.25
    lead: float = 0.2
    drop: float = 0.1
    patience_s: float = 0.35
    gathered: float = 0.35
    loose_confidence: float = 0.3
    beside: float = 1.0
    exchange_s: float = 0.5
    exchange_wait_s: float = 2.5
    walks: float = 0.3

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
        body = body or BodyConfig()
        self._rng, self._bodies = rng, body.cloud.count
        self._numbers = body_numbers(body, leader or LeaderConfig())
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self._all = nothing_remembered(1, self._bodies)

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
        pose, company, numbers = np.asarray(robot_pose, dtype=np.float64), _company(people), self._numbers
        while not can_hold(memory_of(self._all, 0), len(people), len(people.seen_legs)):
            self._all = with_more_room(self._all)
        memory, draw = memory_of(self._all, 0), -1.0
        doubt = kernels.meet(memory, company, pose, float(people.time_s), numbers)
        if doubt >= CLOUD:
            first, pushes = cloud_draws(self._rng, self._bodies, doubt)
            if kernels.look(memory, company, seen_in(scan, pose), first, pushes, numbers):
                draw = self._rng.random()
        kernels.decide(memory, company, draw, numbers)
        return _estimate(memory.leader[0]) if memory.leader["known"][0] else None


def body_numbers(body: BodyConfig, leader: LeaderConfig) -> kernels.BodyNumbers:
    """Return the numbers of a selector as kernels take them."""
    named: dict[str, Any] = {**vars(leader), "onset_patience_s": leader.patience_s, **vars(body)}
    named |= {f"cloud_{name}": value for name, value in vars(body.cloud).items()}
    return as_record(kernels.BodyNumbers(**{name: float(named[name]) for name in kernels.BodyNumbers._fields}))


def cloud_draws(rng: np.random.Generator, bodies: int, doubt: int) -> tuple[Array, Array]:
    """Return what `look` draws for a cloud of so many `bodies`: (n, 4), of no rows if there is one, and (n, 2)."""
    return rng.standard_normal((bodies if doubt == FRESH else 0, 4)), rng.standard_normal((bodies, 2))


def _company(people: People) -> Company:
    """Return `people` as kernels take them."""
    legs = people.seen_legs
    floats = (np.ascontiguousarray(a, dtype=np.float64) for a in (people.confidence, people.unseen_s, legs.positions))
    confidence, unseen_s, places = floats
    return Company(
        ids=np.ascontiguousarray(people.ids, dtype=np.int64),
        x=np.concatenate((people.positions, people.velocities), axis=1, dtype=np.float64),
        confidence=confidence,
        unseen_s=unseen_s,
        places=places,
        sure=np.ascontiguousarray(legs.confidence, dtype=np.float64),
        owner=np.ascontiguousarray(legs.owner, dtype=np.int64),
    )


def _estimate(leader: Any) -> LeaderEstimate:
    """Return a row of `LEADER` as it is told."""
    return LeaderEstimate(
        id=int(leader["id"]),
        track_id=int(leader["track_id"]),
        position=leader["x"][:2].copy(),
        velocity=leader["x"][2:].copy(),
        visible=bool(leader["visible"]),
        confidence=float(leader["confidence"]),
        unseen_s=float(leader["unseen_s"]),
    )
