"""The features of clusters in plain numpy, to check the kernels by: slow, and one formula a line."""

import numpy as np
from numpy.typing import NDArray
from tagalong.perception.legs.clusters import Clusters
from tagalong.perception.legs.features import beam_spacing, is_wide
from tagalong.perception.legs.shape_kernels import LEG_WIDTH, RADIUS_LIMIT, STEP
from tagalong.perception.legs.surroundings_kernels import (
    AT_MOST,
    BESIDE,
    FAR_BESIDE,
    IN_LINE,
    JUMP_LIMIT,
    LONGEST_STANCE,
    MISSING_BEAMS,
    NEARER_LIMIT,
    OPEN,
    RADII,
    USUAL_STANCE,
    WIDEST_MATE,
)
from tagalong.slam import LaserScan

Array = NDArray[np.float64]


def cluster_features_reference(scan: LaserScan, clusters: Clusters) -> Array:
    """Return what `features.cluster_features` returns, as float64."""
    spacing = beam_spacing(scan)
    ranges, bearings = scan.ranges[clusters.beams], scan.bearings[clusters.beams]
    wide = is_wide(clusters)
    rows: list[dict[str, float]] = []
    for i, (a, b) in enumerate(zip(clusters.start, clusters.end, strict=True)):
        row = {} if wide[i] else _shape(clusters.points[a:b], ranges[a:b], bearings[a:b], spacing)
        if row:
            row |= _ends(clusters.points, ranges, bearings, a, b, spacing)
            row |= _beside(ranges, bearings, a, b, spacing)
            row |= _rings(clusters.points, ranges, bearings, a, b, spacing)
        rows.append(row)
    described = [row | _mate(clusters, rows, i) if row else row for i, row in enumerate(rows)]
    width = max((len(row) for row in described), default=0)
    return np.array([list(row.values()) or [np.nan] * width for row in described]).reshape(len(rows), -1)


def _shape(points: Array, ranges: Array, bearings: Array, spacing: float) -> dict[str, float]:
    n, mean = len(points), points.mean(axis=0)
    distance = float(np.linalg.norm(mean))
    sight = mean / distance
    chord = points[-1] - points[0]
    width = float(np.linalg.norm(chord))
    variances, axes = np.linalg.eigh((points - mean).T @ (points - mean) / n)
    small, large = np.sqrt(np.maximum(variances, 0.0))
    radius, circle_residual = _circle(points)
    steps = _outline(points, distance, spacing)
    lengths = np.linalg.norm(steps, axis=1)
    turns = _angles(steps[:-1], steps[1:])
    inscribed = np.abs(_angles(points[0] - points[1:-1], points[-1] - points[1:-1]))
    bulges = _cross(chord, points[1:-1] - points[0]) / max(width, 1e-3)
    before, after = np.minimum.accumulate(ranges), np.minimum.accumulate(ranges[::-1])[::-1]
    return {
        "points": n,
        "range": distance,
        "expected_points": LEG_WIDTH / (distance * spacing),
        "span": (bearings[-1] - bearings[0] + spacing) * distance,
        "width": width,
        "depth": float(np.ptp(points @ sight)),
        "fill": n / (np.floor((bearings[-1] - bearings[0]) / spacing + 0.5) + 1.0),
        "deviation": float(np.hypot(small, large)),
        "middle_deviation": float(np.linalg.norm(points - points[n // 2], axis=1).mean()),
        "line_residual": small,
        "elongation": small / large if large > 0.0 else 0.0,
        "radius": radius,
        "circle_residual": circle_residual,
        "bulge": float(bulges.sum() / max(n - 2, 1)),
        "bulge_ratio": float(bulges.sum() / max(n - 2, 1) / max(width, 0.02)),
        "boundary": float(lengths.sum()),
        "boundary_regularity": float(lengths.std()),
        "turning": float(np.abs(turns).sum() / max(len(turns), 1)),
        "curvature": float(-turns.sum() / max(len(turns), 1) / max(lengths.mean(), 1e-3)),
        "inscribed_angle": float(inscribed.sum() / max(n - 2, 1)),
        "inscribed_angle_deviation": float(inscribed.std()) if n > 2 else 0.0,
        "tilt": float(abs(axes[:, 1] @ sight)),
        "largest_step": float(np.abs(np.diff(ranges)).max(initial=0.0)),
        "roughness": float(np.sqrt(np.sum(np.diff(ranges, 2) ** 2) / max(n - 2, 1))),
        "valley": float((ranges - np.maximum(before, after)).max()),
    }


def _cross(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def _angles(u: Array, v: Array) -> Array:
    return np.arctan2(_cross(u, v), np.sum(u * v, axis=-1))


def _circle(points: Array) -> tuple[float, float]:
    """Kasa's fit as a linear least squares problem about the mean point."""
    p = points - points.mean(axis=0)
    scatter = p.T @ p
    if np.linalg.det(scatter) <= 1e-12 * np.trace(scatter) ** 2:
        return RADIUS_LIMIT, 0.0
    matrix = np.column_stack((2.0 * p, np.ones(len(p))))
    x, y, constant = np.linalg.lstsq(matrix, np.sum(p**2, axis=1), rcond=None)[0]
    radius = np.sqrt(constant + x * x + y * y)
    residuals = np.hypot(*(p - (x, y)).T) - radius
    return min(float(radius), RADIUS_LIMIT), float(np.sqrt(np.mean(residuals**2)))


def _outline(points: Array, distance: float, spacing: float) -> Array:
    stride = max(1, int(STEP / (distance * spacing)))
    stride = min(stride, (len(points) - 1) // 2) if len(points) >= 3 else 1
    return np.diff(points[::stride], axis=0)


def _ends(points: Array, ranges: Array, bearings: Array, a: int, b: int, spacing: float) -> dict[str, float]:
    jumps, gaps = [JUMP_LIMIT, JUMP_LIMIT], [JUMP_LIMIT, JUMP_LIMIT]
    for side, (inner, outer) in enumerate(((a, a - 1), (b - 1, b))):
        if 0 <= outer < len(ranges) and abs(bearings[outer] - bearings[inner]) <= MISSING_BEAMS * spacing:
            jumps[side] = float(np.clip(ranges[outer] - ranges[inner], -JUMP_LIMIT, JUMP_LIMIT))
            gaps[side] = min(float(np.linalg.norm(points[outer] - points[inner])), JUMP_LIMIT)
    return {
        "jump_low": min(jumps),
        "jump_high": max(jumps),
        "gap_low": min(gaps),
        "gap_high": max(gaps),
        "occluded_ends": sum(jump < -0.05 for jump in jumps),
    }


def _beside(ranges: Array, bearings: Array, a: int, b: int, spacing: float) -> dict[str, float]:
    sides = []
    for inner, outside in ((a, slice(0, a)), (b - 1, slice(b, None))):
        near, far = min(BESIDE / ranges[inner], 1.5), min(FAR_BESIDE / ranges[inner], 2.0)
        angles = np.abs(bearings[outside] - bearings[inner])
        differences = np.clip(ranges[outside] - ranges[inner], NEARER_LIMIT, OPEN)
        close, farther = differences[angles <= near], differences[(angles > near) & (angles <= far)]
        beams = max(np.floor(near / spacing), len(close), 1.0), max(np.floor((far - near) / spacing), len(farther), 1.0)
        sides.append(
            (
                OPEN + np.sum(close - OPEN) / beams[0],
                close.min(initial=OPEN),
                OPEN + np.sum(farther - OPEN) / beams[1],
            )
        )
    names = ("beside_mean", "beside_min", "far_beside")
    pairs = dict(zip(names, np.array(sides).T, strict=True))
    return {f"{name}_{end}": pick(pair) for name, pair in pairs.items() for end, pick in (("low", min), ("high", max))}


def _rings(points: Array, ranges: Array, bearings: Array, a: int, b: int, spacing: float) -> dict[str, float]:
    mean = points[a:b].mean(axis=0)
    distance = float(np.linalg.norm(mean))
    reach = np.arcsin(min(RADII[2] / distance, 1.0)) if distance > RADII[2] else np.pi
    stride = max(1, int(reach / spacing) // AT_MOST)
    right, left = np.arange(a - 1, -1, -1)[::stride], np.arange(b, len(ranges))[::stride]
    right = right[np.abs(bearings[right] - bearings[a]) <= reach]
    left = left[np.abs(bearings[left] - bearings[b - 1]) <= reach]
    seen = np.concatenate((right, left))
    offsets = points[seen] - mean
    away = np.linalg.norm(offsets, axis=1)
    lengths = ranges[seen] * spacing * stride * (away < RADII[2])
    chord = points[b - 1] - points[a]
    on_line = np.abs(_cross(chord, offsets)) / max(float(np.linalg.norm(chord)), 1e-6) < IN_LINE
    rings = ((0.0, RADII[0]), RADII[:2], RADII[1:])
    surface = [lengths[(away >= low) & (away < high)].sum() for low, high in rings]
    sides = [p[np.linalg.norm(p, axis=1) < 2.0 * RADII[0]] for p in (points[right] - mean, points[left] - mean)]
    return {
        "surface_030": min(surface[0], 3.0),
        "surface_060": min(surface[1], 3.0),
        "surface_120": min(surface[2], 3.0),
        "in_line": min(lengths[on_line].sum(), 3.0),
        "before_wall": _before_line(sides, mean),
    }


def _before_line(sides: list[Array], mean: Array) -> float:
    if not (len(sides[0]) and len(sides[1])):
        return 1.0
    start, end = (side.mean(axis=0) for side in sides)
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-6)
    offset, laser = float(_cross(along, -start)), float(_cross(along, -mean - start))
    return float(np.clip(offset if laser >= 0.0 else -offset, -0.6, 0.6))


def _mate(clusters: Clusters, rows: list[dict[str, float]], i: int) -> dict[str, float]:
    away = np.linalg.norm(clusters.centres - clusters.centres[i], axis=1)
    away[i] = np.inf
    row = rows[i]
    fits = [
        abs(d - USUAL_STANCE) + 2.0 * abs(other["width"] - row["width"])
        if other and d < LONGEST_STANCE and other["width"] < WIDEST_MATE
        else np.inf
        for d, other in zip(away, rows, strict=True)
    ]
    best = int(np.argmin(fits))
    mate = rows[best] if np.isfinite(fits[best]) else {}
    low, high = sorted((i, best))
    gap = clusters.points[clusters.start[high]] - clusters.points[clusters.end[low] - 1]
    widths = sorted((row["width"], mate.get("width", 0.0)))
    return {
        "mate_distance": away[best] if mate else 1.0,
        "mate_gap": float(np.linalg.norm(gap)) if mate else 1.0,
        "mate_width_ratio": widths[0] / max(widths[1], 1e-3) if mate else 0.0,
        "mate_range_difference": abs(row["range"] - mate["range"]) if mate else 1.0,
        "mate_width": mate.get("width", 0.0),
        "mate_bulge": mate.get("bulge", 0.0),
        "mate_line_residual": mate.get("line_residual", 0.0),
        "mate_jump_low": mate.get("jump_low", 0.0),
        "mate_beside_high": mate.get("beside_mean_high", 0.0),
        "clusters_050": int((away < 0.5).sum()),
        "clusters_100": int((away < 1.0).sum()),
        "second_distance": float(np.sort(np.append(away, [JUMP_LIMIT] * 2))[1]),
    }
