"""Legs that were assigned to the wrong people, put right."""

import numpy as np

from .config import PairingConfig
from .pairing import better_pairs
from .track_kernels import any_wide
from .tracks import Rows, Tracks


class LegExchange:
    """Exchanges legs between people, and with tentative tracks, where that makes pairs narrower over a stride."""

    def __init__(self, config: PairingConfig) -> None:
        self._config = config

    def exchange(self, tracks: Tracks, match: Rows) -> Rows:
        """Exchange legs; return `match` (n,), the detection of each leg track or -1, in the tracks' new order."""
        owned, legs, margin = tracks.owned, tracks.legs, self._config.margin
        if owned == 0:
            return match
        before = np.arange(owned).reshape(-1, 2)
        if not any_wide(legs.apart, before, margin):
            return match
        rows = legs.rows[owned:]
        free = owned + np.flatnonzero((rows["age_s"] > self._config.stride_s / 2.0) & (rows["unseen_s"] == 0.0))
        pairs = better_pairs(legs.spread(), before, legs.rows["owned_s"], free, margin)
        changed = (pairs != before).any(axis=1)
        if not changed.any():
            return match
        tracks.people["x"][changed, :2] = legs.positions[pairs[changed]].mean(axis=1)
        order = np.concatenate((pairs.ravel(), np.setdiff1d(np.arange(len(legs)), pairs)))
        legs.take(order)
        tracks.count_owned(0.0)
        return match[order]
