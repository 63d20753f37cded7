"""Data association: which detection belongs to which leg track (Ye 2021, section II.A)."""

import numpy as np
from numpy.typing import NDArray

from . import leg_kernels
from .config import TrackerConfig
from .data_association import assign, distances
from .tracks import Rows, Tracks


class LegAssociation:
    """Assigns detections to leg tracks within their gates, and tentative tracks to people of whom a leg is missing."""

    def __init__(self, config: TrackerConfig) -> None:
        self._gating, self._pairing = config.gating, config.pairing

    def associate(self, tracks: Tracks, z: NDArray[np.float64]) -> Rows:
        """Return (n,) the detection of `z` (m, 2) that each leg track matches, or -1; tracks may change their order."""
        cost, gates = tracks.legs.cost(z, tracks.centres)
        match = np.full(len(tracks.legs), -1)
        rows, columns = assign(cost, gates)
        match[rows] = columns
        return self._fill_missing_legs(tracks, match, z)

    def _fill_missing_legs(self, tracks: Tracks, match: Rows, z: NDArray[np.float64]) -> Rows:
        """Give people with a missing leg the tentative tracks that could be it; the missing leg's own track ends."""
        legs, owned = tracks.legs, tracks.owned
        missing, free = np.flatnonzero(match[:owned] < 0), owned + np.flatnonzero(match[owned:] >= 0)
        if len(missing) == 0 or len(free) == 0:
            return match
        candidates = z[match[free]]
        cost = distances(legs.positions[missing], candidates)
        cost[distances(tracks.people["x"][missing // 2, :2], candidates) > self._gating.reach] = np.inf
        other = missing + 1 - 2 * (missing % 2)
        known = legs.rows["age_s"][free] > self._pairing.stride_s / 2.0
        limit = np.where(known, self._pairing.width, self._pairing.distance)
        cost[leg_kernels.spread_between(legs.apart, other, free) > limit] = np.inf
        rows, columns = assign(cost, self._gating.reach)
        slots, taken = missing[rows], free[columns]
        order = np.arange(len(legs))
        order[slots] = taken
        order = np.delete(order, taken)
        legs.take(order)
        return match[order]
