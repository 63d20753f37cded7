"""Re-identification: people whose track has ended get their number back when they are seen again."""

import numpy as np
from numpy.typing import NDArray

from . import kalman
from .config import TrackerConfig
from .data_association import assign, distances
from .leg_tracks import LegTracks
from .person_tracks import PERSON

Array = NDArray[np.float64]


class Reidentification:
    """Predicts people whose track has ended, their velocity fading, and re-identifies them by place and time.

    Whoever starts within two standard deviations of such a prediction, but no farther than the configured distance, and
    was not yet there when the old track was last seen, is that person.
    """

    def __init__(self, config: TrackerConfig) -> None:
        self._config, self._motion = config.reidentification, config.motion
        self._people = np.zeros(0, dtype=PERSON)

    def __len__(self) -> int:
        return len(self._people)

    def predict(self, dt: float) -> None:
        """Move the predictions `dt` seconds ahead; drop those of people unseen for too long."""
        people, motion = self._people, self._motion
        if len(people) == 0:
            return
        people["x"][:, 2:] *= np.exp(-dt / motion.coast_s)
        people["x"], people["p"] = kalman.predict(people["x"], people["p"], dt, motion.process_variance(dt))
        people["unseen_s"] += dt
        self._people = people[people["unseen_s"] <= self._config.max_age_s]

    def add(self, people: NDArray[np.void]) -> None:
        """Take `people` (k,) whose tracks end now; those who were hardly known are dropped."""
        if len(people):
            known = people[people["age_s"] >= self._config.known_s]
            self._people = np.concatenate((self._people, known))

    @property
    def positions(self) -> Array:
        """(k, 2) predictions, in the odometry frame [m]."""
        return self._people["x"][:, :2]

    def identify(self, positions: Array, age_s: Array, unsure: NDArray[np.void]) -> NDArray[np.int64]:
        """Return (n,) the old numbers of new people at `positions` (n, 2) whose legs are known for `age_s` (n,).

        -1: somebody new. `unsure` people (k,) still have a track, but it may have slid off to something else; they can
        be re-identified too. Who is re-identified is predicted here no more.
        """
        people = np.concatenate((self._people, unsure))
        numbers = np.full(len(positions), -1, dtype=np.int64)
        cost = self._cost(people, positions, age_s)
        rows, columns = assign(cost, self._config.distance)
        numbers[rows] = people["id"][columns]
        self._people = np.delete(self._people, columns[columns < len(self._people)])
        return numbers

    def may_be_legs(self, legs: LegTracks, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Return (k,) whether the leg tracks `rows` (k,) stand where somebody whose track has ended must be by now."""
        age_s = legs.rows["age_s"][rows]
        old_enough = age_s >= self._config.near_age_s
        if len(self._people) == 0:
            return np.zeros(len(rows), dtype=bool)
        cost = self._cost(self._people, legs.positions[rows], age_s)
        return old_enough & (cost.min(axis=1, initial=np.inf) <= self._config.near)

    def _cost(self, people: NDArray[np.void], positions: Array, age_s: Array) -> Array:
        cost = distances(positions, people["x"][:, :2])
        gate = np.minimum(2.0 * np.sqrt(people["p"][:, 0]), self._config.distance)
        cost[(cost > gate) | (age_s[:, None] > people["unseen_s"] + self._config.overlap_s)] = np.inf
        return cost
