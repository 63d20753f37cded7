"""What the kernels of `perception.legs.centres_kernel` compute, in plain numpy."""

import numpy as np


def move_to_centres_reference(points, start, end, widest, depth_per_width, centres):
    """Write what `move_to_centres` writes, in plain numpy."""
    sums = np.concatenate((np.zeros((1, 2)), np.cumsum(points, axis=0)))
    means = (sums[end] - sums[start]) / np.maximum(end - start, 1)[:, None]
    ends = points[end - 1] - points[start]
    distance = np.maximum(np.hypot(means[:, 0], means[:, 1]), 1e-6)
    sight = means / distance[:, None]
    across = np.abs(ends[:, 0] * sight[:, 1] - ends[:, 1] * sight[:, 0])
    centres[:] = means + (depth_per_width * np.minimum(across, widest))[:, None] * sight
