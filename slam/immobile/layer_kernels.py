"""Kernel of the layered grid. Lengths along the plane are in cells, heights in m."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel

_SLACK = 0.01  # so much beyond where it was seen a thing may reach [m]


class Rays(NamedTuple):
    """What a camera saw along its rays.

    Attributes:
        origin: (3,) where they begin: x, y [cells], height [m].
        ends: (n, 3) where they end; where two hit the same cell the earlier one counts.
        log_beta: (n,) what a hit adds to the log-odds; NaN where the ray ends in the open.
        above: (n,) a ray frees nothing where it is lower than this [m]: it grazes what it ends on.
        known: (n,) whether what it ends on was recognised as something that stays: 0 no, 1 yes, 2 as a level top.
    """

    origin: NDArray[np.float64]
    ends: NDArray[np.float64]
    log_beta: NDArray[np.float64]
    above: NDArray[np.float64]
    known: NDArray[np.int8]


class Layers(NamedTuple):
    """The arrays of a grid of `b` layers, which are written into.

    Attributes:
        edges: (b + 1,) heights between the layers [m]; the last layer has no upper end.
        log_odds: (b, rows, cols).
        stamps: (b, rows, cols) number of the observation that changed a cell last.
        spans: (2, b, rows, cols) lowest and highest of what was recognised [m], 0 for nothing.
        tops: (b, rows, cols) where level tops were recognised.
    """

    edges: NDArray[np.float64]
    log_odds: NDArray[np.float32]
    stamps: NDArray[np.int32]
    spans: NDArray[np.float32]
    tops: NDArray[np.bool_]


@kernel
def write_view(rays: Rays, layers: Layers, near: int, miss: float, limit: float, stamp: int) -> None:
    """Update each cell of each layer that the rays met once: by the first hit in it, else by `miss`.

    A ray frees, in each cell that it passes, the one layer that holds its height there; but what was recognised there
    only if it passes between the heights at which that was seen: a ray just above a desk does not free the desk.

    Args:
        rays: What was seen.
        layers: The grid, changed.
        near: Nothing is freed nearer than this [cells].
        miss: What a ray adds to a cell that it passes.
        limit: Log-odds stay within +-limit.
        stamp: Number of this observation.
    """
    for k in range(len(rays.ends)):
        if not np.isnan(rays.log_beta[k]) and rays.ends[k, 2] >= layers.edges[0]:
            _hit(rays.ends[k], rays.log_beta[k], rays.known[k], layers, limit, stamp)
    for k in range(len(rays.ends)):
        hits = not np.isnan(rays.log_beta[k])
        _free(rays.origin, rays.ends[k], hits, rays.above[k], layers, near, miss, limit, stamp)


@kernel
def _hit(end, log_beta, known, layers, limit, stamp):
    """Write the hit of one ray."""
    edges, log_odds, stamps, spans, tops = layers
    layer = 0
    while layer < len(edges) - 2 and end[2] >= edges[layer + 1]:
        layer += 1
    row, col = int(np.floor(end[1])), int(np.floor(end[0]))
    if known > 0:
        low, high = spans[0, layer, row, col], spans[1, layer, row, col]
        spans[0, layer, row, col] = end[2] if high == 0.0 else min(low, end[2])
        spans[1, layer, row, col] = max(high, end[2])
        tops[layer, row, col] |= known == 2
    if stamps[layer, row, col] != stamp:
        stamps[layer, row, col] = stamp
        log_odds[layer, row, col] = max(min(log_odds[layer, row, col] + log_beta, limit), -limit)


@kernel
def _free(origin, end, hits, above, layers, near, miss, limit, stamp):
    """Free what one ray passes; a ray that hits something stops one cell before it."""
    edges, log_odds, stamps, spans, _ = layers
    dx, dy, dz = end[0] - origin[0], end[1] - origin[1], end[2] - origin[2]
    length = np.sqrt(dx * dx + dy * dy)
    layer = 0
    for step in range(near, int(length - 1.0) if hits else int(length)):
        share = (step + 0.5) / length
        height = origin[2] + share * dz
        if height < edges[0] or height < above:
            break
        while layer < len(edges) - 2 and height >= edges[layer + 1]:
            layer += 1
        while height < edges[layer]:
            layer -= 1
        row, col = int(np.floor(origin[1] + share * dy)), int(np.floor(origin[0] + share * dx))
        low, high = spans[0, layer, row, col], spans[1, layer, row, col]
        if stamps[layer, row, col] != stamp and (high == 0.0 or low - _SLACK <= height <= high + _SLACK):
            stamps[layer, row, col] = stamp
            log_odds[layer, row, col] = max(min(log_odds[layer, row, col] + miss, limit), -limit)
