"""Turns a sweep into evenly spaced points on the surfaces it saw.

A wall that is seen at a flat angle shows as dots, and the dots move with the robot: matched against the dots of the
last scan a scan sticks to them, and the robot seems to stand. So gaps along a straight surface are filled.
"""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel

Points = NDArray[np.float64]

_MAX_GAP = 2.0  # [m] longer gaps are never filled
_GAP_RATIO = 4.0  # a gap is filled if it is not longer than so many times the longer one beside it
_COS_BEND = np.cos(np.deg2rad(25.0))  # a surface does not bend more than this from one gap to the next


@kernel
def surface_points(beam_points: Points, spacing: float) -> tuple[Points, int]:
    """Return (points (M, 2), n): first n means of runs of returns, then points that fill the gaps on surfaces.

    Args:
        beam_points: (N, 2) ends of the beams in the order of the sweep, NaN where there is no return.
        spacing: Returns of neighbouring beams are joined while nearer than this to the first of them, and gaps are
            filled at this distance [m].
    """
    means, ends = _runs(beam_points, spacing)
    count = len(means)
    filled = np.empty((count * (int(_MAX_GAP / spacing) + 1) + 1, 2))
    filled[:count] = means
    total = count
    for k in range(count - 1):
        if ends[k] or not _straight(means, ends, k):
            continue
        gap = np.hypot(means[k + 1, 0] - means[k, 0], means[k + 1, 1] - means[k, 1])
        steps = int(np.ceil(gap / spacing - 0.5))
        for step in range(1, steps):
            share = step / steps
            filled[total, 0] = means[k, 0] + share * (means[k + 1, 0] - means[k, 0])
            filled[total, 1] = means[k, 1] + share * (means[k + 1, 1] - means[k, 1])
            total += 1
    return filled[:total].copy(), count


@kernel
def _runs(beam_points: Points, spacing: float) -> tuple[Points, NDArray[np.bool_]]:
    """Return (M, 2) means of runs of neighbouring returns, and whether a beam without return follows each."""
    means = np.empty_like(beam_points)
    ends = np.zeros(len(beam_points), np.bool_)
    count, size = 0, 0
    first_x, first_y, sum_x, sum_y = 0.0, 0.0, 0.0, 0.0
    for k in range(len(beam_points)):
        x, y = beam_points[k, 0], beam_points[k, 1]
        valid = not np.isnan(x)
        if size > 0 and (not valid or (x - first_x) ** 2 + (y - first_y) ** 2 >= spacing * spacing):
            means[count, 0], means[count, 1] = sum_x / size, sum_y / size
            ends[count] = not valid
            count += 1
            size = 0
        if valid:
            if size == 0:
                first_x, first_y, sum_x, sum_y = x, y, 0.0, 0.0
            sum_x += x
            sum_y += y
            size += 1
    if size > 0:
        means[count, 0], means[count, 1] = sum_x / size, sum_y / size
        count += 1
    if count > 0:
        ends[count - 1] = True
    return means[:count], ends[:count]


@kernel
def _straight(means: Points, ends: NDArray[np.bool_], k: int) -> bool:
    """Return whether the gap after point k continues the surface on both sides."""
    if k == 0 or k + 2 >= len(means) or ends[k - 1] or ends[k + 1]:
        return False
    gap_x, gap_y = means[k + 1, 0] - means[k, 0], means[k + 1, 1] - means[k, 1]
    before_x, before_y = means[k, 0] - means[k - 1, 0], means[k, 1] - means[k - 1, 1]
    after_x, after_y = means[k + 2, 0] - means[k + 1, 0], means[k + 2, 1] - means[k + 1, 1]
    gap, before, after = np.hypot(gap_x, gap_y), np.hypot(before_x, before_y), np.hypot(after_x, after_y)
    if gap > _MAX_GAP or gap > _GAP_RATIO * max(before, after):
        return False
    if gap_x * before_x + gap_y * before_y < _COS_BEND * gap * before:
        return False
    return gap_x * after_x + gap_y * after_y >= _COS_BEND * gap * after
