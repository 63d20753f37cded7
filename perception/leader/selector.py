"""The one person to follow: chosen at onset, looked for when lost, never told from outside (Ye 2021, section II.C)."""

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...slam.bounds import checked_pose
from ..tracking.config import MotionConfig
from ..tracking.people import People
from .config import LeaderConfig
from .estimate import LeaderEstimate
from .selection import Company, leader_numbers, no_leaders, select


class LeaderSelector:
    """Chooses the person closest to the robot at onset, and keeps to that person's number.

    Trackers give somebody who comes back the old number. A leader whose track ended is predicted on by a Kalman filter;
    whoever appears within its growing uncertainty, as a track younger than the loss, is the leader again.

    Args:
        config: How it is chosen and looked for.
        motion: How a lost leader moves.
    """

    def __init__(self, config: LeaderConfig | None = None, motion: MotionConfig | None = None) -> None:
        self._numbers = leader_numbers(config or LeaderConfig(), motion or MotionConfig())
        self.reset()

    def reset(self) -> None:
        """Forget the leader."""
        self._leaders = no_leaders(1)

    def update(self, people: People, robot_pose: ArrayLike) -> LeaderEstimate | None:
        """Return the leader among `people` with the robot at `robot_pose` (3,), both in the odometry frame.

        None means: nobody has been chosen yet.
        """
        pose, one = checked_pose(robot_pose, "robot_pose"), self._leaders[0]
        select(one, _company(people), pose, float(people.time_s), self._numbers)
        return _estimate(one) if one["known"] else None


def _company(people: People) -> Company:
    """Return `people` as kernels take them."""
    return Company(
        ids=np.ascontiguousarray(people.ids, dtype=np.int64),
        x=np.concatenate((people.positions, people.velocities), axis=1, dtype=np.float64),
        confidence=np.ascontiguousarray(people.confidence, dtype=np.float64),
        unseen_s=np.ascontiguousarray(people.unseen_s, dtype=np.float64),
        age_s=np.ascontiguousarray(people.age_s, dtype=np.float64),
    )


def _estimate(leader: Any) -> LeaderEstimate:
    """Return a row of `LEADER` as it is told."""
    return LeaderEstimate(
        id=int(leader["id"]),
        track_id=int(leader["track"]),
        position=leader["x"][:2].copy(),
        velocity=leader["x"][2:].copy(),
        visible=bool(leader["visible"]),
        confidence=float(leader["confidence"]),
        unseen_s=float(leader["unseen_s"]),
    )


def numbered_by_leader(people: People, leader: LeaderEstimate | None) -> People:
    """Return `people` with the leader's number on the track that is the leader now."""
    if leader is None or leader.track_id < 0 or leader.id in people.ids:
        return people
    return replace(people, ids=np.where(people.ids == leader.track_id, leader.id, people.ids))
