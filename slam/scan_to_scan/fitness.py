"""What the genetic matchers score a pose by, for a whole population in one call."""

import numpy as np

from ..view_kernel import kernel


@kernel
def lookup_fitness(poses, points, values, x0, y0, cell, fitness):  # pragma: no cover
    """Write the mean worth of `points` (N, 2) at each of `poses` (P, 3) into `fitness` (P,), in [0, 1].

    The text of Cuzzocrea et al. 2022: the fitness is *incremented* by the table's value (their printed Algorithm 1
    multiplies from zero).
    """
    rows, cols = values.shape
    scale = 1.0 / cell
    for p in range(len(poses)):
        cos, sin = np.cos(poses[p, 2]) * scale, np.sin(poses[p, 2]) * scale
        x, y = (poses[p, 0] - x0) * scale, (poses[p, 1] - y0) * scale
        total = 0
        for n in range(len(points)):
            u = cos * points[n, 0] - sin * points[n, 1] + x
            v = sin * points[n, 0] + cos * points[n, 1] + y
            if 0.0 <= u < cols and 0.0 <= v < rows:
                total += np.int64(values[int(v), int(u)])
        fitness[p] = total / (255.0 * len(points))


@kernel
def polar_fitness(poses, points, ranges, start, step, threshold, fitness):  # pragma: no cover
    """Write the polar fitness of `points` (N, 2) at each of `poses` (P, 3) into `fitness` (P,), in [0, 1].

    After Martinez et al. 2006: a moved point corresponds to the reference's beam at its bearing, and its error is the
    difference of the two ranges; those within `threshold` [m] count 1 - error / threshold. `ranges` (B,) are the
    reference's, NaN where there is no return, at bearings start + b step.
    """
    turn = 2.0 * np.pi / step
    for p in range(len(poses)):
        cos, sin = np.cos(poses[p, 2]), np.sin(poses[p, 2])
        total = 0.0
        for n in range(len(points)):
            x = cos * points[n, 0] - sin * points[n, 1] + poses[p, 0]
            y = sin * points[n, 0] + cos * points[n, 1] + poses[p, 1]
            beam = int(np.floor(((np.arctan2(y, x) - start) / step) % turn + 0.5))
            if beam < len(ranges):
                error = abs(np.sqrt(x * x + y * y) - ranges[beam])
                if error < threshold:
                    total += 1.0 - error / threshold
        fitness[p] = total / len(points)
