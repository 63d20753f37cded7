"""The one person to follow: chosen at onset, looked for when lost, never told from outside (Ye 2021, section II.C)."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import checked_pose
from ...slam.scan import LaserScan
from ..tracking.config import MotionConfig
from ..tracking.kalman import predict_single, single_target
from ..tracking.people import People
from .estimate import LeaderEstimate, as_leader
from .onset import LeaderConfig, LeaderOnset

if TYPE_CHECKING:
    from filterpy.kalman import KalmanFilter

Array = NDArray[np.float64]


class LeaderSelector:
    """Chooses the person closest to the robot at onset, and keeps to that person.

    A leader whose track ended is predicted on by a Kalman filter of its own; whoever appears within its growing
    uncertainty, as a track younger than the loss, is the leader again.
    """

    def __init__(self, config: LeaderConfig | None = None, motion: MotionConfig | None = None) -> None:
        self._config, self._motion = config or LeaderConfig(), motion or MotionConfig()
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self._leader: LeaderEstimate | None = None
        self._time_s = 0.0
        self._onset = LeaderOnset(self._config)
        self._search: KalmanFilter | None = None
        self._duplicates: set[int] = set()  # whoever was ever at the leader's own place

    def update(self, people: People, robot_pose: ArrayLike, scan: LaserScan | None = None) -> LeaderEstimate | None:
        """Return the leader among `people` with the robot at `robot_pose` (3,), both in the odometry frame.

        None means: nobody has been chosen yet. The scan does not matter here.
        """
        dt, self._time_s = people.time_s - self._time_s, people.time_s
        before = self._leader
        chosen = self._onset.choose(people, checked_pose(robot_pose, "robot_pose")[:2], before)
        if chosen is not None:
            self._leader, self._search = chosen, None
        elif before is not None and before.track_id in people.ids:
            self._leader, self._search = self._keep(people, before), None
        elif before is not None:
            self._look_for(people, before, dt)
        return self._leader

    def _keep(self, people: People, before: LeaderEstimate) -> LeaderEstimate:
        """Return the leader by its track, or by a duplicate of it once it is unseen."""
        own = int(np.flatnonzero(people.ids == before.track_id)[0])
        apart = np.hypot(*(people.positions - people.positions[own]).T)
        others = people.ids != before.track_id
        self._duplicates.update(people.ids[others & (apart < self._config.duplicate_distance)].tolist())
        able = self._are_duplicates(people) & (people.unseen_s == 0.0) & others
        if people.unseen_s[own] > self._config.duplicate_patience_s and able.any():
            own = int(np.argmin(np.where(able, apart, np.inf)))
        return as_leader(people, own, before.id)

    def _are_duplicates(self, people: People) -> NDArray[np.bool_]:
        return np.array([number in self._duplicates for number in people.ids.tolist()], dtype=bool)

    def _look_for(self, people: People, before: LeaderEstimate, dt: float) -> None:
        search, config = self._search, self._config
        if search is None:
            search = single_target(before.position, self._motion.initial_variance, self._motion.r)
            search.x[2:] = before.velocity
            self._search = search
        search.x[2:] *= np.exp(-dt / self._motion.coast_s)
        predict_single(search, dt, self._motion.process_variance(dt))
        unseen_s = before.unseen_s + dt
        gate = min(config.search_distance, config.search_sigmas * float(np.sqrt(search.P[0, 0])))
        apart = np.hypot(*(people.positions - search.x[:2]).T)
        apart[(people.age_s > unseen_s + config.search_overlap_s) & ~self._are_duplicates(people)] = np.inf
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
