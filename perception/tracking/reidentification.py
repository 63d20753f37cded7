"""People whose track ended, and who may be met again under their old number."""

import numpy as np
from numpy.typing import NDArray

from . import kalman
from .config import TrackerConfig
from .data_association import assign, distances
from .person_tracks import PERSON

Array = NDArray[np.float64]


class ReidentificationMemory:
    """Predicts people who are out of sight, their velocity fading, and recognises them by place and time.

    Whoever starts within two standard deviations of such a prediction, but no farther than `memory_distance`, and was
    not yet there when the lost one was last seen, is that person.
    """

    def __init__(self, config: TrackerConfig) -> None:
        self._config = config
        self._people = np.zeros(0, dtype=PERSON)

    def __len__(self) -> int:
        return len(self._people)

    def predict(self, dt: float) -> None:
        """Move the lost `dt` seconds ahead; forget those unseen for too long."""
        lost, config = self._people, self._config
        if len(lost) == 0:
            return
        lost["x"][:, 2:] *= np.exp(-dt / config.motion.coast_s)
        lost["x"], lost["p"] = kalman.predict(lost["x"], lost["p"], dt, config.motion.process_variance(dt))
        lost["unseen_s"] += dt
        self._people = lost[lost["unseen_s"] <= config.reidentification.memory_s]

    def remember(self, people: NDArray[np.void]) -> None:
        """Take `people` (k,) whose tracks end now; those who were hardly known are forgotten."""
        known = people[people["age_s"] >= self._config.reidentification.known_s]
        self._people = np.concatenate((self._people, known))

    @property
    def positions(self) -> Array:
        """(k, 2) predictions of the lost, in the odometry frame [m]."""
        return self._people["x"][:, :2]

    def recognise(self, positions: Array, age_s: Array, doubtful: NDArray[np.void]) -> NDArray[np.int64]:
        """Return (n,) the old numbers of new people at `positions` (n, 2) whose legs are known for `age_s` (n,).

        -1: a stranger. `doubtful` people (k,) still have a track, but it may have slid off to something else; they
        can be recognised too. Recognised people are lost no more.
        """
        lost = np.concatenate((self._people, doubtful))
        numbers = np.full(len(positions), -1, dtype=np.int64)
        cost = self._cost(lost, positions, age_s)
        rows, columns = assign(cost, self._config.reidentification.distance)
        numbers[rows] = lost["id"][columns]
        self._people = np.delete(self._people, columns[columns < len(self._people)])
        return numbers

    def may_be(self, positions: Array, age_s: Array, within: float) -> NDArray[np.bool_]:
        """Return (n,) whether legs at `positions` (n, 2), known for `age_s` (n,), can be somebody lost `within` [m]."""
        if len(self._people) == 0:
            return np.zeros(len(positions), dtype=bool)
        return np.asarray(self._cost(self._people, positions, age_s).min(axis=1, initial=np.inf) <= within)

    def _cost(self, lost: NDArray[np.void], positions: Array, age_s: Array) -> Array:
        cost = distances(positions, lost["x"][:, :2])
        gate = np.minimum(2.0 * np.sqrt(lost["p"][:, 0]), self._config.reidentification.distance)
        cost[(cost > gate) | (age_s[:, None] > lost["unseen_s"] + self._config.reidentification.overlap_s)] = np.inf
        return cost
