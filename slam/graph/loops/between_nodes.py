"""Poses of all scans of a drive from those of the nodes among them."""

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, wrap_angle

Array = NDArray[np.float64]


def between_nodes(local: Array, scans: NDArray[np.int64], nodes: Array, breaks: list[int]) -> Array:
    """Return (n, 3) T_global_robot of all scans: extrapolated from the nodes before and after, and interpolated.

    From both nodes the local trajectory, which is smooth, leads to the scan; the two results are mixed by how far the
    scan is from each.

    Args:
        local: (n, 3) T_local_robot of all scans.
        scans: (k,) ascending, the scans that are nodes.
        nodes: (k, 3) T_global_robot of the nodes.
        breaks: First scans of drive segments; nothing is mixed across such a break.
    """
    every = np.arange(len(local))
    after = np.minimum(np.searchsorted(scans, every), len(scans) - 1)
    before = np.maximum(np.searchsorted(scans, every, side="right") - 1, 0)
    gap = np.maximum(scans[after] - scans[before], 1)
    share = np.clip((every - scans[before]) / gap, 0.0, 1.0)[:, None]
    segment = np.searchsorted(breaks, every, side="right")
    segment_before = np.searchsorted(breaks, scans[before], side="right")
    segment_after = np.searchsorted(breaks, scans[after], side="right")
    apart = segment_before != segment_after
    share[apart, 0] = segment[apart] == segment_after[apart]
    first = compose(nodes[before], between(local[scans[before]], local))
    second = compose(nodes[after], between(local[scans[after]], local))
    difference = second - first
    difference[:, 2] = wrap_angle(difference[:, 2])
    mixed = first + share * difference
    mixed[:, 2] = wrap_angle(mixed[:, 2])
    return mixed
