"""Numba kernels of the non-linear least squares of a scan on the smooth interpolation of a submap."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel
from .correlative import correlate
from .spline_kernels import expand, linearize, misfit

Grid = NDArray[np.float32]
Array = NDArray[np.float64]

FINE = 5e-5  # [m] last step of a match that carries the trajectory on
COARSE = 1e-3  # [m] of one among thousands of constraints, whose standard deviations are ten times as much


@kernel
def _add_prior(H, g, weight, pose, prior, prior_information):  # type: ignore[no-untyped-def]
    """Scale the scan's part by `weight` and add the prior's to `H` and `g`."""
    dx, dy, dt = pose[0] - prior[0], pose[1] - prior[1], pose[2] - prior[2]
    for a in range(3):
        pull = prior_information[a, 0] * dx + prior_information[a, 1] * dy + prior_information[a, 2] * dt
        g[a] = weight * g[a] + pull
        for b in range(3):
            H[a, b] = weight * H[a, b] + prior_information[a, b]


@kernel
def _total(cost, weight, pose, prior, prior_information):  # type: ignore[no-untyped-def]
    """Return the whole cost: that of the scan, scaled by `weight`, and that of the prior."""
    dx, dy, dt = pose[0] - prior[0], pose[1] - prior[1], pose[2] - prior[2]
    total = weight * cost
    for a in range(3):
        pull = prior_information[a, 0] * dx + prior_information[a, 1] * dy + prior_information[a, 2] * dt
        total += 0.5 * pull * (dx if a == 0 else (dy if a == 1 else dt))
    return total


@kernel
def _solve3(H: Array, g: Array, damping: float, step: Array) -> None:
    """Write into `step` the solution of (H + damping diag H) step = -g, by Cholesky."""
    d = 1.0 + damping
    l00 = np.sqrt(H[0, 0] * d + 1e-9)
    l10, l20 = H[1, 0] / l00, H[2, 0] / l00
    l11 = np.sqrt(max(H[1, 1] * d + 1e-9 - l10 * l10, 1e-12))
    l21 = (H[2, 1] - l20 * l10) / l11
    l22 = np.sqrt(max(H[2, 2] * d + 1e-9 - l20 * l20 - l21 * l21, 1e-12))
    y0 = -g[0] / l00
    y1 = (-g[1] - l10 * y0) / l11
    y2 = (-g[2] - l20 * y0 - l21 * y1) / l22
    step[2] = y2 / l22
    step[1] = (y1 - l21 * step[2]) / l11
    step[0] = (y0 - l10 * step[1] - l20 * step[2]) / l00


@kernel
def refine_pose(
    field: Grid,
    corner: Array,
    resolution: float,
    points: Array,
    start: Array,
    prior: Array,
    prior_information: Array,
    weight: float,
    iterations: int,
    tolerance: float = FINE,
) -> tuple[Array, Array, float, int]:
    """Return (pose (3,), information (3, 3) of the scan alone, sum of 1 - M, iterations) of the least-squares pose.

    Damped Newton steps on weight * sum (1 - M) + 1/2 the Mahalanobis distance to the prior; it ends after a step
    that is shorter than `tolerance` [m] and turns by less than a fifth of it [rad].
    """
    H, g = np.empty((3, 3)), np.empty(3)
    cost = expand(field, corner, resolution, points, start, H, g)
    return _descend(
        field, corner, resolution, points, start, cost, H, g, prior, prior_information, weight, iterations, tolerance
    )


@kernel
def _descend(  # type: ignore[no-untyped-def]
    field, corner, resolution, points, start, cost, H, g, prior, prior_information, weight, iterations, tolerance
):
    """Return what `refine_pose` does, from a `start` where the scan's `cost`, `H` and `g` are known.

    The step that may be the last asks for the information of the scan at once, not for another expansion.
    """
    pose, trial, step = start.copy(), np.empty(3), np.empty(3)
    H_trial, g_trial = np.empty((3, 3)), np.empty(3)
    _add_prior(H, g, weight, pose, prior, prior_information)
    total = _total(cost, weight, pose, prior, prior_information)
    damping, done = 1e-6, 0
    for _ in range(iterations):
        done += 1
        _solve3(H, g, damping, step)
        for a in range(3):
            trial[a] = pose[a] + step[a]
        last = abs(step[0]) + abs(step[1]) < tolerance and abs(step[2]) < 0.2 * tolerance
        if last:
            trial_cost = linearize(field, corner, resolution, points, trial, H_trial, g_trial)
        else:
            trial_cost = expand(field, corner, resolution, points, trial, H_trial, g_trial)
        trial_total = _total(trial_cost, weight, trial, prior, prior_information)
        if trial_total <= total and last:
            H_trial *= weight
            return trial, H_trial, trial_cost, done
        if trial_total <= total:
            pose, trial = trial, pose
            H, H_trial = H_trial, H
            g, g_trial = g_trial, g
            total, cost = trial_total, trial_cost
            _add_prior(H, g, weight, pose, prior, prior_information)
            damping = max(damping * 0.1, 1e-6)
        else:
            damping = max(damping, 1e-2) * 8.0
            if damping > 1e4:
                break
    linearize(field, corner, resolution, points, pose, H, g)
    H *= weight
    return pose, H, cost, done


@kernel
def refine_many(
    field: Grid,
    corner: Array,
    resolution: float,
    points: Array,
    firsts: NDArray[np.int64],
    starts: Array,
    weight: float,
    reach: int,
    angles: int,
    sure_score: float,
    min_score: float,
) -> tuple[Array, Array, Array]:
    """Return poses (n, 3), curvatures (n, 3, 3) and scores (n,) of n scans on one submap.

    Scan k has the points firsts[k] .. firsts[k + 1] of `points` and starts at starts[k], which holds it weakly. First
    it is searched for within `reach` cells and `angles` steps of heading, unless it scores `sure_score` already; where
    it scores below `min_score` then, it is left there.
    """
    n = len(starts)
    poses, curvatures, scores = starts.copy(), np.zeros((n, 3, 3)), np.zeros(n)
    hold, H, g = np.eye(3), np.empty((3, 3)), np.empty(3)
    for k in range(n):
        scan = points[firsts[k] : firsts[k + 1]]
        size = max(len(scan), 1)
        if reach > 0 and 1.0 - misfit(field, corner, resolution, scan, starts[k]) / size < sure_score:
            step = 2.0 * resolution / max(1.0, _far(scan))
            stride = max(1, size // 60)
            poses[k] = correlate(
                field, corner, resolution, scan[::stride], starts[k], hold, weight * stride, reach, angles, step
            )[0]
        cost = expand(field, corner, resolution, scan, poses[k], H, g)
        scores[k] = 1.0 - cost / size
        if scores[k] >= min_score:
            pose, curvature, rest, _ = _descend(
                field, corner, resolution, scan, poses[k], cost, H, g, starts[k], hold, weight, 12, COARSE
            )
            poses[k] = pose
            curvatures[k] = weight * curvature
            scores[k] = 1.0 - rest / size
    return poses, curvatures, scores


@kernel
def _far(points: Array) -> float:
    """Return the root mean square distance of points (N, 2) from the origin."""
    total = 0.0
    for n in range(len(points)):
        total += points[n, 0] * points[n, 0] + points[n, 1] * points[n, 1]
    return np.sqrt(total / max(len(points), 1))
