"""Duplicate tracks: one person tracked twice, since each of its legs can have started a person."""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from ..tracking.people import People

ACQUAINTANCE = np.dtype(
    [
        ("number", np.int64),  # of a track
        ("met_s", np.float64),  # when it was first seen; -inf: somebody else for good
        ("near_s", np.float64),  # for how long it was at the leader's own place
        ("beside_s", np.float64),  # when it was last so near to the leader that their tracks may have been exchanged
    ]
)


class DuplicateTracks:
    """Tells who is tracked at the leader's own place for too long to be somebody else.

    Args:
        distance: No two bodies are nearer to each other than this for long [m].
        time_s: A duplicate is nearer for longer than this [s].
        separation: Who is farther away than this is no duplicate any more [m].
    """

    def __init__(self, distance: float, time_s: float = 0.0, separation: float = np.inf) -> None:
        self._distance, self._time_s, self._separation = distance, time_s, separation
        self._met, self._count = np.zeros(16, ACQUAINTANCE), 0

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
            if self._count == len(self._met):
                self._met = np.concatenate((self._met, np.zeros_like(self._met)))
            self._count = met_by(self._met, self._count, number)
            note_nearness(self._met, self._count, away, self._distance, self._separation, dt)

    def among(self, people: People) -> NDArray[np.bool_]:
        """Return (n,) which of `people` are duplicates."""
        near_s = [nearness(self._met, self._count, number) for number in people.ids.tolist()]
        return np.array(near_s) > self._time_s if near_s else np.zeros(0, dtype=bool)


@kernel
def met_by(met, count, number):
    """Make the one of that `number` the last of the first `count` of `met`, as somebody new if need be; how many now.

    So those who are about are found soon, however many came and went.
    """
    for row in range(count - 1, -1, -1):
        if met[row].number == number:
            last = count - 1
            met_s, near_s, beside_s = met[row].met_s, met[row].near_s, met[row].beside_s
            met[row].number, met[row].met_s, met[row].near_s = met[last].number, met[last].met_s, met[last].near_s
            met[row].beside_s = met[last].beside_s
            met[last].number, met[last].met_s, met[last].near_s, met[last].beside_s = number, met_s, near_s, beside_s
            return count
    met[count].number, met[count].met_s, met[count].near_s, met[count].beside_s = number, np.inf, 0.0, -np.inf
    return count + 1


@kernel
def note_nearness(met, count, away, distance, separation, dt):
    """Note of the last of `met` that it was so far `away` from the leader for `dt` [s]."""
    if away < distance:
        met[count - 1].near_s += dt
    elif away > separation:
        met[count - 1].near_s = 0.0


@kernel
def nearness(met, count, number):
    """Return for how long the one of that `number` was at the leader's own place [s]."""
    for row in range(count - 1, -1, -1):
        if met[row].number == number:
            return met[row].near_s
    return 0.0
