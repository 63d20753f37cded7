"""The beams of a planar laser against boxes, cylinders and ellipsoids: MuJoCo's rays, to the bit, in less time.

The arithmetic of a pair of beam and geom is that of MuJoCo's `mj_multiRay`, operation by operation (which stays the
reference that the tests compare with). What is saved, where MuJoCo asks each beam about each geom: a geom that does not
reach the laser's plane is met by none; the others by the beams of their own sector only, found by two divisions; and
not by those that have met something nearer than any point of it. People and furniture come last in a building and
stand before its walls, so that the geoms are gone through backwards.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel

Array = NDArray[np.float64]

CYLINDER, ELLIPSOID, BOX = 5, 4, 6
"""MuJoCo's numbers of the shapes that are known here."""
_TINY = 1e-15
_MARGIN = 1e-6
_UPRIGHT = 1.0 - 1e-12  # cosine of a tilt that is none


@kernel
def cast_beams(
    origin: Array,
    heading: float,
    first: float,
    spacing: float,
    directions: Array,
    geoms: NDArray[np.int32],
    shapes: NDArray[np.int32],
    sizes: Array,
    positions: Array,
    rotations: Array,
    distance: Array,
    met: NDArray[np.int32],
) -> None:
    """Find the nearest geom on each beam, in place.

    Args:
        origin: (3,) of all beams [m].
        heading: Of the laser in the world [rad].
        first: Bearing of the first beam in the laser frame [rad].
        spacing: Between two beams [rad].
        directions: (n, 3) unit vectors of the beams in the world; the third component is 0.
        geoms: (m,) those that the laser can see, ascending.
        shapes: (g,) types of all geoms.
        sizes: (g, 3) [m].
        positions: (g, 3) [m].
        rotations: (g, 9) rows of the rotation matrices.
        distance: (n,) written: distance along each beam [m], -1 where nothing is met.
        met: (n,) written: the geom, -1 for none.
    """
    count = len(directions)
    distance[:] = -1.0
    met[:] = -1
    for k in range(len(geoms) - 1, -1, -1):
        geom = geoms[k]
        shape, size, position, rotation = int(shapes[geom]), sizes[geom], positions[geom], rotations[geom]
        start, width, near = _sector(origin, heading + first, shape, size, position, rotation)
        if width < 0.0:
            continue
        for behind in (0.0, 2.0 * np.pi):
            low = max(math.floor((start - behind) / spacing), 0)
            high = min(math.ceil((start - behind + width) / spacing) + 1, count)
            if low < high:
                _cast_some(low, high, near, origin, directions, geom, shape, size, position, rotation, distance, met)


@kernel
def _cast_some(
    low: int,
    high: int,
    near: float,
    origin: Array,
    directions: Array,
    geom: int,
    shape: int,
    size: Array,
    position: Array,
    rotation: Array,
    distance: Array,
    met: NDArray[np.int32],
) -> None:
    """Let the beams from `low` to before `high` meet a geom that is no nearer than `near` [m]."""
    flat = shape == BOX and _is_level(rotation)
    x, y = origin[0] - position[0], origin[1] - position[1]
    px, py = rotation[0] * x + rotation[3] * y, rotation[1] * x + rotation[4] * y
    for beam in range(low, high):
        if 0.0 <= distance[beam] < near:
            continue
        if flat:
            bx, by = directions[beam, 0], directions[beam, 1]
            vx, vy = rotation[0] * bx + rotation[3] * by, rotation[1] * bx + rotation[4] * by
            met_at = _meet_rectangle(size[0], size[1], px, py, vx, vy)
        else:
            met_at = _meet(shape, size, position, rotation, origin, directions[beam])
        if met_at >= 0.0 and (distance[beam] < 0.0 or met_at <= distance[beam]):
            distance[beam] = met_at
            met[beam] = geom


@kernel
def _is_level(rotation: Array) -> bool:
    """Return whether a geom is turned about the vertical only."""
    return rotation[2] == 0.0 and rotation[5] == 0.0 and rotation[6] == 0.0 and rotation[7] == 0.0


@kernel
def _sector(
    origin: Array, first: float, shape: int, size: Array, position: Array, rotation: Array
) -> tuple[float, float, float]:
    """Return where the sector begins in which beams can meet a geom, from the first beam in [0, 2 pi), its width, and a
    distance that no point of the geom is nearer than [m].

    A sector that begins behind the laser may reach the beams round the circle. The width is negative where the geom
    does not reach the laser's plane.
    """
    x, y, above = position[0] - origin[0], position[1] - origin[1], abs(position[2] - origin[2])
    if shape == BOX and rotation[8] > _UPRIGHT:
        low, width, near = _sector_of_box(x, y, above, size, rotation)
    else:
        low, width, near = _sector_of_round(x, y, above, shape, size, rotation)
    if width < 0.0 or width >= 2.0 * np.pi:
        return 0.0, width, 0.0
    start = (low - _MARGIN - first) % (2.0 * np.pi)
    return start, width + 2.0 * _MARGIN, near - _MARGIN


@kernel
def _sector_of_box(x: float, y: float, above: float, size: Array, rotation: Array) -> tuple[float, float, float]:
    """Return the direction of the first edge, the width between the edges and the distance of an upright box at (x, y).

    The width is negative where the box does not reach the laser's plane, `above` from its middle [m], and 2 pi where
    the laser is in it.
    """
    if rotation[8] * above > size[2] + (0.0 if _is_level(rotation) else _MARGIN):
        return 0.0, -1.0, 0.0
    cx, cy = rotation[0] * x + rotation[3] * y, rotation[1] * x + rotation[4] * y
    along, aside = abs(cx) - size[0], abs(cy) - size[1]
    if max(along, aside) < _MARGIN:
        return 0.0, 2.0 * np.pi, 0.0
    # the two corners at the rim of what is seen: of the face towards the laser, or, seen over an edge, those beside
    ax, ay = cx - math.copysign(size[0], cx), cy + math.copysign(size[1], cy)
    bx, by = cx + math.copysign(size[0], cx), cy - math.copysign(size[1], cy)
    if aside <= 0.0:
        bx = ax
    elif along <= 0.0:
        ay = by
    one = np.arctan2(rotation[3] * ax + rotation[4] * ay, rotation[0] * ax + rotation[1] * ay)
    other = np.arctan2(rotation[3] * bx + rotation[4] * by, rotation[0] * bx + rotation[1] * by)
    low = one if ax * by - ay * bx > 0.0 else other
    width = abs(other - one)
    width = min(width, 2.0 * np.pi - width)
    near = math.sqrt(max(along, 0.0) ** 2 + max(aside, 0.0) ** 2)
    return low, width, near


@kernel
def _sector_of_round(
    x: float, y: float, above: float, shape: int, size: Array, rotation: Array
) -> tuple[float, float, float]:
    """Return the same of a geom at (x, y) that is seen as a circle around it, be it a box that is tilted."""
    upright = shape == CYLINDER and rotation[8] > _UPRIGHT
    if shape == CYLINDER:
        bound = math.sqrt(size[0] ** 2 + size[1] ** 2)
    elif shape == ELLIPSOID:
        bound = max(size[0], size[1], size[2])
    else:
        bound = math.sqrt(size[0] ** 2 + size[1] ** 2 + size[2] ** 2)
    if above > (size[1] if upright else bound) + _MARGIN:
        return 0.0, -1.0, 0.0
    bound = size[0] if upright else bound
    away = math.sqrt(x * x + y * y)
    if away < bound + _MARGIN:
        return 0.0, 2.0 * np.pi, 0.0
    half = np.arcsin(bound / away)
    return np.arctan2(y, x) - half, 2.0 * half, away - bound


@kernel
def _meet(shape: int, size: Array, position: Array, rotation: Array, origin: Array, beam: Array) -> float:
    """Return the distance along a beam to a geom [m], -1 where it is not met."""
    x, y, z = origin[0] - position[0], origin[1] - position[1], origin[2] - position[2]
    px = rotation[0] * x + rotation[3] * y + rotation[6] * z
    py = rotation[1] * x + rotation[4] * y + rotation[7] * z
    pz = rotation[2] * x + rotation[5] * y + rotation[8] * z
    vx = rotation[0] * beam[0] + rotation[3] * beam[1] + rotation[6] * beam[2]
    vy = rotation[1] * beam[0] + rotation[4] * beam[1] + rotation[7] * beam[2]
    vz = rotation[2] * beam[0] + rotation[5] * beam[1] + rotation[8] * beam[2]
    if shape == BOX:
        best = _face(size[0], size[1], size[2], px, py, pz, vx, vy, vz, -1.0)
        best = _face(size[1], size[0], size[2], py, px, pz, vy, vx, vz, best)
        return _face(size[2], size[0], size[1], pz, px, py, vz, vx, vy, best)
    if shape == ELLIPSOID:
        sx, sy, sz = 1.0 / (size[0] * size[0]), 1.0 / (size[1] * size[1]), 1.0 / (size[2] * size[2])
        a = sx * vx * vx + sy * vy * vy + sz * vz * vz
        b = sx * vx * px + sy * vy * py + sz * vz * pz
        return _root(a, b, sx * px * px + sy * py * py + sz * pz * pz - 1.0)
    best = -1.0
    if abs(vz) > _TINY:
        for side in (-1.0, 1.0):
            at = (side * size[1] - pz) / vz
            if at >= 0.0:
                ex, ey = px + at * vx, py + at * vy
                if ex * ex + ey * ey <= size[0] * size[0] and (best < 0.0 or at < best):
                    best = at
    at = _root(vx * vx + vy * vy, vx * px + vy * py, px * px + py * py - size[0] * size[0])
    if at >= 0.0 and abs(pz + at * vz) <= size[1] and (best < 0.0 or at < best):
        best = at
    return best


@kernel
def _meet_rectangle(half_x: float, half_y: float, px: float, py: float, vx: float, vy: float) -> float:
    """Return what `_meet` does for a box turned about the vertical only: its top and bottom are met by no beam."""
    best = -1.0
    if abs(vx) > _TINY:
        for side in (-half_x, half_x):
            at = (side - px) / vx
            if at >= 0.0 and abs(py + at * vy) <= half_y and (best < 0.0 or at < best):
                best = at
    if abs(vy) > _TINY:
        for side in (-half_y, half_y):
            at = (side - py) / vy
            if at >= 0.0 and abs(px + at * vx) <= half_x and (best < 0.0 or at < best):
                best = at
    return best


@kernel
def _face(
    half: float,
    half_1: float,
    half_2: float,
    p: float,
    p_1: float,
    p_2: float,
    v: float,
    v_1: float,
    v_2: float,
    best: float,
) -> float:
    """Return `best`, or the distance to the nearer of a box's two faces across one axis where that is less."""
    if abs(v) > _TINY:
        for side in (-1.0, 1.0):
            at = (side * half - p) / v
            if at >= 0.0 and abs(p_1 + at * v_1) <= half_1 and abs(p_2 + at * v_2) <= half_2:  # noqa: SIM102
                if best < 0.0 or at < best:
                    best = at
    return best


@kernel
def _root(a: float, b: float, c: float) -> float:
    """Return the least root of a x^2 + 2 b x + c that is not negative, -1 for none."""
    within = b * b - a * c
    if within < _TINY:
        return -1.0
    within = math.sqrt(within)
    low, high = (-b - within) / a, (-b + within) / a
    if low >= 0.0:
        return low
    return high if high >= 0.0 else -1.0


@kernel
def add_noise(
    exact: Array,
    noise: Array,
    chance: Array,
    near: float,
    sigma_near: float,
    sigma_far: float,
    farthest: float,
    dropout: float,
    ranges: Array,
) -> None:
    """Write into `ranges` (n,) what a scanner measures of the `exact` ones (n,), `inf` where nothing is met [m].

    Args:
        exact: (n,) [m].
        noise: (n,) standard normal draws.
        chance: (n,) uniform draws in [0, 1): a beam fails below `dropout` and gives NaN.
        near: Up to this range the deviation is `sigma_near`, beyond it `sigma_far` [m].
        sigma_near: [m].
        sigma_far: [m].
        farthest: Largest range that is given [m].
        dropout: Share of the beams that fail.
        ranges: (n,) written [m].
    """
    for i in range(len(exact)):
        sigma = sigma_near if exact[i] <= near else sigma_far
        ranges[i] = np.nan if chance[i] < dropout else measured(exact[i], sigma * noise[i], farthest)


@kernel
def measured(exact: float, error: float, farthest: float) -> float:
    """Return what is measured of a range, `inf` where nothing is met; at most `farthest` [m]."""
    return min(max(exact + error, 0.0), farthest) if math.isfinite(exact) else np.inf
