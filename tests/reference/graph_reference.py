"""The plain numpy twins of the kernels of this package: slow, and what the tests compare the kernels with."""

import numpy as np
from numpy.typing import NDArray
from tagalong.slam.geometry import transform_points

Array = NDArray[np.float64]
Grid = NDArray[np.float32]

_SATURATION = 3.0
# Row k: the cubic in t that weighs tap k of a uniform cubic B-spline, lowest power first.
_BASIS = np.array([[1.0, -3.0, 3.0, -1.0], [4.0, 0.0, -6.0, 3.0], [1.0, 3.0, 3.0, -3.0], [0.0, 0.0, 0.0, 1.0]]) / 6.0


def taps(t: Array) -> tuple[Array, Array, Array]:
    """Return (n, 4) weights of the four taps at `t` (n,) in [0, 1), their first and their second derivatives."""
    one, zero = np.ones_like(t), np.zeros_like(t)
    powers = np.stack((one, t, t**2, t**3), axis=-1)
    first = np.stack((zero, one, 2.0 * t, 3.0 * t**2), axis=-1)
    second = np.stack((zero, zero, 2.0 * one, 6.0 * t), axis=-1)
    return powers @ _BASIS.T, first @ _BASIS.T, second @ _BASIS.T


def spline(field: Grid, cells: Array) -> tuple[Array, Array, Array]:
    """Return value (n,), gradient (n, 2) and Hessian (n, 2, 2) of the B-spline over `field` at `cells` (n, 2): x, y."""
    corner = np.floor(cells).astype(np.int64)
    inside = np.all((corner >= 1) & (corner + 2 < np.array(field.shape[::-1])), axis=-1)
    corner = np.where(inside[:, None], corner, 1)
    columns, rows = (corner[:, k, None] + np.arange(-1, 3) for k in range(2))
    patch = np.where(inside[:, None, None], field[rows[:, :, None], columns[:, None, :]], 0.0).astype(np.float64)
    x, y = taps(cells[:, 0] - np.floor(cells[:, 0])), taps(cells[:, 1] - np.floor(cells[:, 1]))

    def product(down: Array, across: Array) -> Array:
        return np.einsum("nr,nrc,nc->n", down, patch, across)

    gradient = np.stack((product(y[0], x[1]), product(y[1], x[0])), axis=-1)
    mixed = product(y[1], x[1])
    second = np.stack((product(y[0], x[2]), mixed, mixed, product(y[2], x[0])), axis=-1)
    return product(y[0], x[0]), gradient, second.reshape(-1, 2, 2)


def expansion(
    field: Grid, corner: Array, resolution: float, points: Array, pose: Array, newton: bool
) -> tuple[float, Array, Array]:
    """Return cost, gradient (3,) and curvature (3, 3): those of `expand` if `newton`, else those of `linearize`."""
    cells = (transform_points(pose, points) - corner) / resolution
    value, slope, bend = spline(field, cells)
    rest = np.exp(-_SATURATION * value)
    by_place = -_SATURATION * rest[:, None] * slope / resolution
    if newton:
        curved = _SATURATION * rest[:, None, None] / resolution**2
        curved = curved * (_SATURATION * slope[:, :, None] * slope[:, None, :] - bend)
        values, vectors = np.linalg.eigh(curved)
        curved = (vectors * np.maximum(values, 0.0)[:, None, :]) @ vectors.swapaxes(1, 2)
    else:
        curved = 0.5 / (rest + 0.05)[:, None, None] * by_place[:, :, None] * by_place[:, None, :]
    away = transform_points((0.0, 0.0, pose[2]), points)
    J = np.zeros((len(points), 2, 3))  # of a point's place by the pose
    J[:, 0, 0] = J[:, 1, 1] = 1.0
    J[:, 0, 2], J[:, 1, 2] = -away[:, 1], away[:, 0]
    gradient, curvature = np.einsum("nik,ni->k", J, by_place), np.einsum("nik,nij,njl->kl", J, curved, J)
    return float(rest.sum()), gradient, curvature


def correlation(
    field: Grid,
    corner: Array,
    resolution: float,
    points: Array,
    prior: Array,
    prior_information: Array,
    weight: float,
    reach: int,
    angles: int,
    angle_step: float,
) -> tuple[Array, float]:
    """Return what `correlate` returns, by scoring every pose of the window."""
    rows, cols = field.shape
    best, best_pose, best_rest = np.inf, prior.copy(), float(len(points))
    worth = np.minimum(1.0, 1.7 * field.astype(np.float64))
    for turn in angle_step * np.arange(-angles, angles + 1):
        placed = transform_points(prior + np.array([0.0, 0.0, turn]), points)
        cells = np.floor((placed - corner) / resolution + 0.5).astype(np.int64)
        for b in range(-reach, reach + 1):
            for a in range(-reach, reach + 1):
                i, j = cells[:, 0] + a, cells[:, 1] + b
                inside = (i >= 0) & (i < cols) & (j >= 0) & (j < rows)
                rest = len(points) - worth[j[inside], i[inside]].sum()
                offset = np.array([a * resolution, b * resolution, turn])
                total = weight * rest + 0.5 * offset @ prior_information @ offset
                if total < best:
                    best, best_pose, best_rest = total, prior + offset, rest
    return best_pose, float(best_rest)


def inserted(
    hits_before: Grid,
    visits_before: Grid,
    origin: Array,
    cells: Array,
    returns: int,
    surface: int,
    prior_visits: float,
    margin: float,
) -> tuple[Array, Array, Array]:
    """Return hits, visits and field after `insert_scans` of a scan that no cell has counted yet."""
    hits, visits = hits_before.astype(np.float64), visits_before.astype(np.float64)
    met, passed = np.zeros(hits.shape, bool), np.zeros(hits.shape, bool)
    for x, y in cells[: returns + surface]:
        i, j = int(np.floor(x)), int(np.floor(y))
        share = np.outer([1.0 - (y - j), y - j], [1.0 - (x - i), x - i])
        hits[j : j + 2, i : i + 2] += share
        met[j : j + 2, i : i + 2] = True
    for k in [*range(returns), *range(returns + surface, len(cells))]:
        end = origin + (1.0 - margin) * (cells[k] - origin) if k < returns else cells[k]
        columns, rows = crossed(origin, end).T
        passed[rows, columns] = True
    visits += met | passed
    seen = (met | passed) & (hits > 0.0)
    field = np.zeros(hits.shape)
    field[seen] = np.minimum(1.0, hits[seen] / (visits[seen] + prior_visits))
    return hits, visits, field


def crossed(start: Array, end: Array) -> NDArray[np.int64]:
    """Return (n, 2) the cells, column first, that a segment passes through before the one it ends in."""
    cuts = [np.array([0.0, 1.0])]
    for k in range(2):
        low, high = sorted((start[k], end[k]))
        lines = np.arange(np.floor(low + 0.5), np.floor(high + 0.5)) + 0.5
        if len(lines):
            cuts.append((lines - start[k]) / (end[k] - start[k]))
    t = np.sort(np.concatenate(cuts))
    middles = start + (0.5 * (t[1:] + t[:-1]))[:, None] * (end - start)
    return np.floor(middles[:-1] + 0.5).astype(np.int64)


def first_in_voxel(points: Array, edge: float) -> NDArray[np.int64]:
    """Return what `voxel_first` returns."""
    _, first = np.unique(np.floor(points / edge), axis=0, return_index=True)
    return np.sort(first)


def mean_in_voxel(points: Array, edge: float) -> Array:
    """Return what `voxel_mean` returns."""
    voxels = np.floor(points / edge)
    return np.array([points[(voxels == voxels[k]).all(axis=1)].mean(axis=0) for k in first_in_voxel(points, edge)])
