"""Numba kernel of `detector.leg_centres`."""

import numpy as np

from ...slam.view_kernel import kernel

WIDEST_SINGLE_LEG = 0.16
MEAN_DEPTH_PER_WIDTH = np.pi / 8  # the seen half of a circle: its mean point lies pi/4 radii before its centre


@kernel
def move_to_centres(points, start, end, widest, depth_per_width, centres):
    """Write into `centres` (m, 2) the mean point of each cluster, moved on along the line of sight by the depth of a
    leg as wide as it is seen, at most `widest`."""
    sums = np.zeros((len(points) + 1, 2))
    for i in range(len(points)):
        sums[i + 1, 0] = sums[i, 0] + points[i, 0]
        sums[i + 1, 1] = sums[i, 1] + points[i, 1]
    for c in range(len(start)):
        size = max(end[c] - start[c], 1)
        x = (sums[end[c], 0] - sums[start[c], 0]) / size
        y = (sums[end[c], 1] - sums[start[c], 1]) / size
        u = points[end[c] - 1, 0] - points[start[c], 0]
        v = points[end[c] - 1, 1] - points[start[c], 1]
        distance = max(np.hypot(x, y), 1e-6)
        sight_x, sight_y = x / distance, y / distance
        deeper = depth_per_width * min(abs(u * sight_y - v * sight_x), widest)
        centres[c, 0] = x + deeper * sight_x
        centres[c, 1] = y + deeper * sight_y


@kernel
def leg_centres_of(points, start, end):
    """Return (m, 2) as `detector.leg_centres` does."""
    centres = np.empty((len(start), 2))
    move_to_centres(points, start, end, WIDEST_SINGLE_LEG, MEAN_DEPTH_PER_WIDTH, centres)
    return centres
