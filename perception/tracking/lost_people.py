"""People whose hypothesis has ended, to be known again."""

import numpy as np
from numpy.typing import NDArray

from .config import TrackerConfig
from .hypotheses import HYPOTHESIS

KNOWN_S = 1.0
"""Who was tracked for less than a step of each leg is not remembered [s]."""


class LostPeople:
    """Remembers people who are lost, and where their velocity, fading, takes them.

    Args:
        config: How fast it fades, and how long and how far somebody is remembered.
    """

    def __init__(self, config: TrackerConfig) -> None:
        self._coast_s, self._config = config.motion.coast_s, config.reidentification
        self._people, self._seen_s = np.zeros(0, dtype=HYPOTHESIS), np.zeros(0)

    def add(self, people: NDArray[np.void], time_s: float) -> None:
        """Take `people` (k,) who are lost at `time_s`; forget those lost for too long."""
        people = people[people["age_s"] >= KNOWN_S]
        if len(people) + len(self._people) == 0:
            return
        self._people = np.concatenate((self._people, people))
        self._seen_s = np.concatenate((self._seen_s, time_s - people["unseen_s"]))
        self._keep(time_s - self._seen_s <= self._config.max_age_s)

    def nearest(self, somebody: np.void, time_s: float) -> int:
        """Return the row of the lost person who may be `somebody` and is nearest; -1: there is none.

        It is within a step and what somebody walks in the time since, and was not there long before the other was lost.
        """
        if len(self._people) == 0:
            return -1
        gone_s = time_s - self._seen_s
        drift = self._coast_s * (1.0 - np.exp(-gone_s / self._coast_s))
        places = self._people["x"][:, :2] + drift[:, None] * self._people["x"][:, 2:]
        apart = np.hypot(*(places - somebody["x"][:2]).T)
        gate = np.minimum(self._config.distance, 0.5 + gone_s)
        apart[(apart > gate) | (somebody["age_s"] > gone_s + self._config.overlap_s)] = np.inf
        row = int(apart.argmin())
        return row if np.isfinite(apart[row]) else -1

    def take(self, row: int) -> int:
        """Return the number of the lost person in this `row`, who is found again."""
        number = int(self._people["id"][row])
        self._keep(np.arange(len(self._people)) != row)
        return number

    def _keep(self, kept: NDArray[np.bool_]) -> None:
        self._people, self._seen_s = self._people[kept], self._seen_s[kept]
