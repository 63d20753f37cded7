"""The one person to follow: chosen at onset, looked for when lost, never told from outside (Ye 2021, section II.C)."""

from dataclasses import dataclass, replace

import numpy as np
from filterpy.kalman import KalmanFilter
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import check_numbers, checked_pose
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ..tracking.config import MotionConfig
from ..tracking.kalman import predict_single, single_target
from ..tracking.people import People

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LeaderConfig:
    """How a leader is chosen and looked for.

    Attributes:
        onset_s: The choice may still change for this long after the first one, if somebody else is nearer [s].
        onset_near: Somebody this near the robot is chosen at once [m].
        onset_far: Nobody farther from the robot than this is ever chosen [m].
        patience_s: Somebody between the two only when nobody came nearer for this long after the first was seen [s].
        search_sigmas: A lost leader is looked for within this many standard deviations of its prediction.
        search_distance: And never farther from it than this [m].
        search_overlap_s: How long somebody may have been tracked before the leader was last seen and still be it: the
            old track may have slid off to something else [s].
        twin_distance: Somebody tracked nearer to the leader than this is a second track of the leader: no two bodies
            are that near [m]. A twin takes over when the leader's own track is unseen.
        twin_patience_s: For how long it must be unseen [s].
    """

    onset_s: float = 1.0
    onset_near: float = 2.2
    onset_far: float = 4.0
    patience_s: float = 1.0
    search_sigmas: float = 2.0
    search_distance: float = 8.0
    search_overlap_s: float = 3.0
    twin_distance: float = 0.4
    twin_patience_s: float = 0.3

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("onset_near", "onset_far", "search_sigmas", "search_distance"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class LeaderEstimate:
    """The leader as known at one scan.

    Attributes:
        id: The leader's number, the same for the whole drive, whatever track carries it.
        track_id: The tracked person who is the leader now; -1 while it is lost.
        position: (2,) in the odometry frame, predicted while it is lost [m].
        velocity: (2,) [m/s].
        visible: Whether a leg of it was seen in this scan.
        confidence: Of its track, by eq. 6; 0 while it is lost.
        unseen_s: Time since a leg of it was last seen [s].
    """

    id: int
    track_id: int
    position: Array
    velocity: Array
    visible: bool
    confidence: float
    unseen_s: float


class LeaderSelector:
    """Chooses the person closest to the robot at onset, and keeps to that person.

    A leader whose track ended is predicted on by a Kalman filter of its own; whoever appears within its growing
    uncertainty, as a track younger than the loss, is the leader again.
    """

    def __init__(self, config: LeaderConfig | None = None, motion: MotionConfig | None = None) -> None:
        self._leader_config, self._motion = config or LeaderConfig(), motion or MotionConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self._leader: LeaderEstimate | None = None
        self._time_s = self._chosen_s = 0.0
        self._waiting_since = np.inf
        self._search: KalmanFilter | None = None
        self._twins: set[int] = set()

    def update(self, people: People, robot_pose: ArrayLike, scan: LaserScan | None = None) -> LeaderEstimate | None:
        """Return the leader among `people` with the robot at `robot_pose` (3,), both in the odometry frame.

        None means: nobody has been chosen yet. The scan does not matter here.
        """
        dt, self._time_s = people.time_s - self._time_s, people.time_s
        before = self._leader
        if self._choose(people, checked_pose(robot_pose, "robot_pose")[:2]) or before is None:
            return self._leader
        if before.track_id in people.ids:
            self._search = None
            self._keep(people, before)
        else:
            self._look_for(people, before, dt)
        return self._leader

    def _choose(self, people: People, robot: Array) -> bool:
        """Take the nearest of `people` as the leader; return False after onset, and if there is nobody to choose."""
        onset = self._leader is None or people.time_s - self._chosen_s < self._leader_config.onset_s
        if not onset or len(people) == 0:
            return False
        config, apart = self._leader_config, np.hypot(*(people.positions - robot).T)
        self._waiting_since = min(self._waiting_since, people.time_s)
        patient = self._leader is None and people.time_s - self._waiting_since < config.patience_s
        if apart.min() > (config.onset_near if patient else config.onset_far):
            return False
        if self._leader is None:
            self._chosen_s = people.time_s
        nearest = int(apart.argmin())
        self._leader, self._search = as_leader(people, nearest, int(people.ids[nearest])), None
        return True

    def _keep(self, people: People, before: LeaderEstimate) -> None:
        """Go on with the leader's track, or with its twin once it is unseen."""
        config = self._leader_config
        own = int(np.flatnonzero(people.ids == before.track_id)[0])
        apart = np.hypot(*(people.positions - people.positions[own]).T)
        apart[own] = np.inf
        self._twins |= {int(number) for number in people.ids[apart < config.twin_distance]}
        able = self._is_twin(people) & (people.unseen_s == 0.0) & (apart < np.inf)
        if people.unseen_s[own] > config.twin_patience_s and able.any():
            own = int(np.argmin(np.where(able, apart, np.inf)))
        self._leader = as_leader(people, own, before.id)

    def _is_twin(self, people: People) -> NDArray[np.bool_]:
        return np.array([int(number) in self._twins for number in people.ids], dtype=bool)

    def _look_for(self, people: People, before: LeaderEstimate, dt: float) -> None:
        search, config = self._search, self._leader_config
        if search is None:
            search = single_target(before.position, self._motion.initial_variance, self._motion.r)
            search.x[2:] = before.velocity
            self._search = search
        search.x[2:] *= np.exp(-dt / self._motion.coast_s)
        predict_single(search, dt, self._motion.process_variance(dt))
        unseen_s = before.unseen_s + dt
        gate = min(config.search_distance, config.search_sigmas * float(np.sqrt(search.P[0, 0])))
        apart = np.hypot(*(people.positions - search.x[:2]).T)
        apart[(people.age_s > unseen_s + config.search_overlap_s) & ~self._is_twin(people)] = np.inf
        if len(people) and apart.min() < gate:
            self._search = None
            self._leader = as_leader(people, int(apart.argmin()), before.id)
        else:
            position, velocity = search.x[:2].copy(), search.x[2:].copy()
            self._leader = LeaderEstimate(before.id, -1, position, velocity, False, 0.0, unseen_s)


def numbered_by_leader(people: People, leader: LeaderEstimate | None) -> People:
    """Return `people` with the leader's number on the track that is the leader now."""
    if leader is None or leader.track_id < 0 or leader.id in people.ids:
        return people
    return replace(people, ids=np.where(people.ids == leader.track_id, leader.id, people.ids))


def as_leader(people: People, index: int, number: int) -> LeaderEstimate:
    """Return person `index` of `people` as the leader, who has that `number`."""
    return LeaderEstimate(
        id=number,
        track_id=int(people.ids[index]),
        position=people.positions[index].copy(),
        velocity=people.velocities[index].copy(),
        visible=bool(people.unseen_s[index] == 0.0),
        confidence=float(people.confidence[index]),
        unseen_s=float(people.unseen_s[index]),
    )
