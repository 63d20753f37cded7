"""The plain numpy twin of `layer_kernels.py`."""

import numpy as np
from tagalong.slam.immobile.layer_kernels import _SLACK, Layers, Rays


def write_view_reference(rays: Rays, layers: Layers, near: int, miss: float, limit: float, stamp: int) -> None:
    """Do what `write_view` does, in numpy."""
    (origin, ends, log_beta, above, known), (edges, log_odds, stamps, spans, tops) = rays, layers
    change = np.full(log_odds.shape, np.nan)
    for (x, y, z), value, stays in zip(ends, log_beta, known, strict=True):
        layer = min(int(np.searchsorted(edges, z, side="right")) - 1, len(edges) - 2)
        cell = (layer, int(np.floor(y)), int(np.floor(x)))
        if np.isnan(value) or layer < 0:
            continue
        if stays:
            spans[(0, *cell)] = z if spans[(1, *cell)] == 0.0 else min(spans[(0, *cell)], z)
            spans[(1, *cell)] = max(spans[(1, *cell)], z)
            tops[cell] |= stays == 2
        if np.isnan(change[cell]):
            change[cell] = value
    for end, value, lowest in zip(ends, log_beta, above, strict=True):
        length = float(np.hypot(*(end - origin)[:2]))
        steps = int(length) if np.isnan(value) else int(length - 1.0)
        shares = (np.arange(near, max(near, steps)) + 0.5) / length
        points = origin + shares[:, None] * (end - origin)
        low = (points[:, 2] < edges[0]) | (points[:, 2] < lowest)
        points = points[: int(np.argmax(low))] if low.any() else points
        layer = np.minimum(np.searchsorted(edges, points[:, 2], side="right") - 1, len(edges) - 2)
        col, row = np.floor(points[:, :2]).astype(int).T
        low, high = spans[:, layer, row, col]
        through = (high == 0.0) | ((low - _SLACK <= points[:, 2]) & (points[:, 2] <= high + _SLACK))
        free = np.isnan(change[layer, row, col]) & through
        change[layer[free], row[free], col[free]] = miss
    met = ~np.isnan(change)
    log_odds[met] = np.clip(log_odds[met] + change[met], -limit, limit)
    stamps[met] = stamp
