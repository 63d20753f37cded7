"""Point-to-line registration from both sides: each scan's points against the other's lines, in numba."""

import numpy as np

from ..view_kernel import kernel
from .registration import LINE, correspond, normal_equations, solve_step


@kernel
def inverse_pose(pose, inverted, jacobian):  # pragma: no cover
    """Write the inverse of a pose (3,) and the derivative (3, 3) of the one by the other."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    inverted[0] = -cos * pose[0] - sin * pose[1]
    inverted[1] = sin * pose[0] - cos * pose[1]
    inverted[2] = -pose[2]
    jacobian[:] = 0.0
    jacobian[0, 0], jacobian[0, 1], jacobian[0, 2] = -cos, -sin, sin * pose[0] - cos * pose[1]
    jacobian[1, 0], jacobian[1, 1], jacobian[1, 2] = sin, -cos, cos * pose[0] + sin * pose[1]
    jacobian[2, 2] = -1.0


@kernel
def add_transformed(system, other, jacobian):  # pragma: no cover
    """Add J^T H J and J^T g of `other` (3, 4; upper triangle) to `system`."""
    for a in range(3):
        for b in range(3):
            value = 0.0
            for c in range(3):
                for d in range(3):
                    value += jacobian[c, a] * other[min(c, d), max(c, d)] * jacobian[d, b]
            system[a, b] += value
            system[a, 3] += jacobian[b, a] * other[b, 3]


@kernel
def line_equations(
    pose, points, lines, more_lines, limit, scale, index, square, moved, system, other
):  # pragma: no cover
    """Fill `system` (3, 4) with the equations of points (N, 2) on both kinds of lines; returns (found, weights)."""
    found = correspond(points, pose, np.inf, lines, limit, index, square, moved)
    weights, _ = normal_equations(LINE, pose, np.inf, lines, scale, index, moved, system)
    if len(more_lines[3]) > 0:
        more, _ = normal_equations(LINE, pose, np.inf, more_lines, scale, index, moved, other)
        weights += more
        system += other
    return found, weights


@kernel
def register_both(
    guess, reference, new, more_reference, more_new, reach, scales, ridge, most, rest
):  # pragma: no cover
    """Return (pose, iterations, at rest), as `registration.register` with LINE, for the lines of both scans.

    `reference` and `new` are (points, rays, feet, normals, linked, first) of `Surfaces`, `more_reference` and
    `more_new` the same with other lines through the points, which count as well, or empty.
    """
    pose = guess.copy()
    n, m = len(new[0]), len(reference[0])
    index, square, moved = np.empty(max(n, m), dtype=np.int32), np.empty(max(n, m)), np.empty((max(n, m), 2))
    system, other, back, step = np.empty((3, 4)), np.empty((3, 4)), np.empty((3, 4)), np.zeros(3)
    inverted, jacobian = np.empty(3), np.empty((3, 3))
    limit, scale = reach[0], scales[0]
    for iteration in range(most):
        found, weights = line_equations(
            pose, new[0], reference, more_reference, limit, scale, index[:n], square[:n], moved[:n], system, other
        )
        inverse_pose(pose, inverted, jacobian)
        met, more = line_equations(
            inverted, reference[0], new, more_new, limit, scale, index[:m], square[:m], moved[:m], back, other
        )
        add_transformed(system, back, jacobian)
        found, weights = found + met, weights + more
        if found < 6 or weights < 1e-9 or not solve_step(system, ridge * weights, step):
            return pose, iteration, False
        pose += step
        settled = limit <= reach[1] and scale <= scales[1]
        if settled and max(abs(step[0]), abs(step[1]), abs(step[2])) < rest:
            return pose, iteration + 1, True
        limit, scale = max(limit * scales[2], reach[1]), max(scale * scales[2], scales[1])
    return pose, most, False
