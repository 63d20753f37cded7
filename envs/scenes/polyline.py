"""Curves made of straight pieces."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def arc_lengths(points: ArrayLike) -> Array:
    """Return (n,) the way along `points` (n, 2) from the first to each [m]."""
    steps = np.diff(np.asarray(points, dtype=np.float64), axis=0)
    return np.concatenate(([0.0], np.cumsum(np.hypot(steps[:, 0], steps[:, 1]))))


def resample(points: ArrayLike, spacing: float) -> Array:
    """Return (m, 2) points on the curve `points` (n, 2), `spacing` metres apart along it; the rest is cut off."""
    points = np.asarray(points, dtype=np.float64)
    arcs = arc_lengths(points)
    wanted = np.arange(0.0, arcs[-1] + 1e-9, spacing)
    return np.stack([np.interp(wanted, arcs, points[:, axis]) for axis in (0, 1)], axis=-1)


def tangents(points: ArrayLike) -> Array:
    """Return (n, 2) unit vectors along `points` (n, 2), by central differences."""
    ahead = np.gradient(np.asarray(points, dtype=np.float64), axis=0)
    return ahead / np.hypot(ahead[:, 0], ahead[:, 1])[:, None]


def rounded(corners: ArrayLike, radius: float, spacing: float = 0.1) -> Array:
    """Return (m, 2) the polyline through `corners` (n, 2) with its inner corners turned into arcs of `radius` [m]."""
    corners = np.asarray(corners, dtype=np.float64)
    pieces = [corners[:1]]
    for before, corner, after in zip(corners[:-2], corners[1:-1], corners[2:], strict=True):
        pieces.append(_fillet(before, corner, after, radius, spacing))
    return np.concatenate([*pieces, corners[-1:]])


def _fillet(before: Array, corner: Array, after: Array, radius: float, spacing: float) -> Array:
    into = (corner - before) / np.hypot(*(corner - before))
    out = (after - corner) / np.hypot(*(after - corner))
    turn = np.arctan2(into[0] * out[1] - into[1] * out[0], into @ out)
    tangent_length = radius * np.tan(abs(turn) / 2.0)
    start = corner - into * tangent_length
    normal = np.sign(turn) * np.array([-into[1], into[0]])
    centre = start + normal * radius
    angles = np.linspace(0.0, turn, max(3, int(abs(turn) * radius / spacing)))
    spoke = start - centre
    cos, sin = np.cos(angles), np.sin(angles)
    return centre + np.stack((cos * spoke[0] - sin * spoke[1], sin * spoke[0] + cos * spoke[1]), axis=-1)
