"""A whole sweep of evenly spaced beams among outlines: each thing is met by the beams of its own sector only.

The reference is `outlines.cast`, which asks each beam about each thing; the ranges are the same to the bit.
"""

import numpy as np

from ...slam.view_kernel import ieee_kernel
from .outlines import meet_ellipse, meet_segment

_MARGIN = 1e-9


@ieee_kernel
def sweep(x, y, angles, limit, ellipses, segments):
    """Return (n,) ranges from (x, y) along evenly spaced `angles` (n,), inf beyond `limit`.

    Args:
        x: Of the laser [m].
        y: Of the laser [m].
        angles: (n,) ascending over a whole circle at most [rad].
        limit: [m].
        ellipses: (k, 7) as of `Outlines.arrays`.
        segments: (m, 6) likewise.
    """
    count = len(angles)
    first, spacing = angles[0], (angles[-1] - angles[0]) / (count - 1)
    dx, dy = np.cos(angles), np.sin(angles)
    best = np.full(count, limit)
    for k in range(len(ellipses) + len(segments)):
        is_round = k < len(ellipses)
        if is_round:
            start, width = _ellipse_sector(x, y, ellipses[k])
        else:
            start, width = _segment_sector(x, y, segments[k - len(ellipses)])
        start = (start - _MARGIN - first) % (2.0 * np.pi)
        for behind in (0.0, 2.0 * np.pi):
            low = max(int(np.floor((start - behind) / spacing)), 0)
            high = min(int(np.ceil((start - behind + width + 2.0 * _MARGIN) / spacing)) + 1, count)
            for i in range(low, high):
                if is_round:
                    t = meet_ellipse(x, y, dx[i], dy[i], ellipses[k])
                else:
                    t = meet_segment(x, y, dx[i], dy[i], segments[k - len(ellipses)])
                best[i] = min(best[i], t)
    return np.where(best < limit, best, np.inf)


@ieee_kernel
def _segment_sector(x, y, segment):
    """Return where the sector begins in which a segment is seen, and how wide it is [rad]."""
    ax, ay, bx, by = segment[0] - x, segment[1] - y, segment[2] - x, segment[3] - y
    cross = ax * by - ay * bx
    start = np.arctan2(ay, ax) if cross > 0.0 else np.arctan2(by, bx)
    return start, np.arctan2(abs(cross), ax * bx + ay * by)


@ieee_kernel
def _ellipse_sector(x, y, ellipse):
    ex, ey, reach = ellipse[0] - x, ellipse[1] - y, max(ellipse[2], ellipse[3])
    away = np.sqrt(ex * ex + ey * ey)
    half = np.arcsin(reach / away) if away > reach else np.pi
    return np.arctan2(ey, ex) - half, 2.0 * half
