"""Duplicate tracks: one person tracked twice, since each of its legs can have started a person."""

import numpy as np
from numpy.typing import NDArray

from ..tracking.people import People


class DuplicateTracks:
    """Tells who is tracked at the leader's own place for too long to be somebody else.

    Args:
        distance: No two bodies are nearer to each other than this for long [m].
        time_s: A duplicate is nearer for longer than this [s].
        separation: Who is farther away than this is no duplicate any more [m].
    """

    def __init__(self, distance: float, time_s: float = 0.0, separation: float = np.inf) -> None:
        self._distance, self._time_s, self._separation = distance, time_s, separation
        self._near_s: dict[int, float] = {}

    def update(self, people: People, place: NDArray[np.float64], others: NDArray[np.bool_], dt: float) -> None:
        """Take the people of a scan, `dt` [s] after the last one.

        Args:
            people: In the odometry frame.
            place: (2,) of the leader in it [m].
            others: (n,) which of the people to compare: not the leader's own track.
            dt: Since the last scan [s].
        """
        apart = np.hypot(*(people.positions - place).T)
        for number, away in zip(people.ids[others].tolist(), apart[others].tolist(), strict=True):
            if away < self._distance:
                self._near_s[number] = self._near_s.get(number, 0.0) + dt
            elif away > self._separation:
                self._near_s.pop(number, None)

    def among(self, people: People) -> NDArray[np.bool_]:
        """Return (n,) which of `people` are duplicates."""
        return np.array([self._near_s.get(number, 0.0) > self._time_s for number in people.ids.tolist()], dtype=bool)
