"""Legs that are not the leader's, whoever's track takes them later.

Somebody who stands is no person for the tracker before moving, and in passing the leader's track can slide over to such
legs. But they were seen apart from the leader before: from scan to scan each leg inherits that from the leg nearest to
where it is.
"""

import numpy as np
from numpy.typing import NDArray

from ..tracking.data_association import distances

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

STEP_M = 0.25
"""No leg moves farther than this from one scan to the next [m]."""
SCANS = 3
"""In so many scans in a row a leg must be seen apart from the leader to count as somebody else's."""
UNSEEN_S = 0.5
"""A leg of somebody else is recognised for this long after it was seen [s]."""
EXPLAINED = 0.1
"""A leg that the leader's body explains so well may be the leader's."""
UNEXPLAINED_S = 0.4
"""If the leader's own track has had nothing but legs of others for so long, those are the leader's after all [s]."""


class LegsOfOthers:
    """Follows, from scan to scan, the legs that were seen apart from the leader: they are somebody else's."""

    def __init__(self) -> None:
        self._legs, self._unseen_s = np.zeros((0, 2)), np.zeros(0)
        self._apart = np.zeros(0, dtype=np.int64)  # scans in a row; somebody else's from `SCANS` on
        self._now = 0
        self._unexplained_s = 0.0

    def update(self, legs: Array, dt: float) -> None:
        """Take the `legs` (k, 2) of a scan, `dt` [s] after the last one, in the odometry frame."""
        apart, gone = np.zeros(len(legs), dtype=np.int64), np.zeros(len(self._legs), dtype=bool)
        if self._apart.any():
            away = distances(legs, self._legs)
            if len(legs):
                apart = np.where(away.min(axis=1) < STEP_M, self._apart[away.argmin(axis=1)], 0)
            gone = (self._apart >= SCANS) & (self._unseen_s + dt < UNSEEN_S)
            gone &= away.min(axis=0, initial=np.inf) >= STEP_M
        self._now = len(legs)
        self._legs = np.concatenate((legs, self._legs[gone]))
        self._unseen_s = np.concatenate((np.zeros(len(legs)), self._unseen_s[gone] + dt))
        self._apart = np.concatenate((apart, self._apart[gone]))

    @property
    def places(self) -> Array:
        """(n, 2) where legs of others are, or were a moment ago [m]."""
        return self._legs[self._apart >= SCANS]

    def among(self, own: Mask, explained: Array, dt: float) -> Mask:
        """Return (k,) which of the last legs are somebody else's.

        Args:
            own: (k,) which are of the track that carries the leader.
            explained: (k,) how well the leader's body explains each, in [0, 1].
            dt: Since this was last asked [s].
        """
        others = self._apart[: self._now] >= SCANS
        unexplained = bool((others & own).any()) and not bool((~others & (explained > EXPLAINED)).any())
        self._unexplained_s = self._unexplained_s + dt if unexplained else 0.0
        if self._unexplained_s > UNEXPLAINED_S:
            self._apart[: self._now][own] = 0
            others = others & ~own
        return others

    def observe(self, apart: Mask) -> None:
        """Take which of the last legs, (k,), are nobody's and apart from a leader in view."""
        now = self._apart[: self._now]
        now[:] = np.where(now >= SCANS, now, np.where(apart, now + 1, 0))
