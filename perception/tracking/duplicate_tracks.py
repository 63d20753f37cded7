"""Second tracks of the leader: each of its legs can have started a person."""

import numpy as np
from numpy.typing import NDArray

from ..leader.selector import LeaderEstimate
from .people import People


class DuplicateTracks:
    """Remembers who was where the leader is for too long to be somebody else.

    Args:
        distance: No two bodies are nearer to each other than this for long [m].
        time_s: A double is nearer for longer than this, both in view [s].
    """

    def __init__(self, distance: float, time_s: float) -> None:
        self._distance, self._time_s = distance, time_s
        self._near_s: dict[int, float] = {}

    def watch(self, people: People, leader: LeaderEstimate | None, dt: float) -> None:
        """Take the people of a scan, `dt` [s] after the last one; who is seen somewhere else is no double any more."""
        if leader is None or leader.track_id < 0 or not leader.visible or len(people) < 2:
            return
        apart = np.hypot(*(people.positions - leader.position).T)
        for number, away, unseen_s in zip(people.ids.tolist(), apart.tolist(), people.unseen_s.tolist(), strict=True):
            if number == leader.track_id or unseen_s > 0.0:
                continue
            if away < self._distance:
                self._near_s[number] = self._near_s.get(number, 0.0) + dt
            elif away > 2.0 * self._distance:
                self._near_s.pop(number, None)

    def among(self, people: People) -> NDArray[np.bool_]:
        """Return (n,) which of `people` are doubles."""
        return np.array([self._near_s.get(number, 0.0) > self._time_s for number in people.ids.tolist()], dtype=bool)
