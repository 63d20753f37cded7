"""Numba kernels of the features of a cluster's own shape; `reference.py` says the same in numpy."""

import numpy as np

from ...slam.view_kernel import ieee_kernel

SHAPE_COUNT = 25
STEP = 0.03  # the outline is walked in steps of about this length [m]
LEG_WIDTH = 0.12
RADIUS_LIMIT = 0.5


@ieee_kernel
def describe_shapes(points, ranges, bearings, start, end, spacing, widest, out):
    """Fill the first `SHAPE_COUNT` columns of `out` (m, F); clusters wider than `widest` [m] are left alone."""
    for c in range(len(start)):
        a, b = start[c], end[c]
        if np.hypot(points[b - 1, 0] - points[a, 0], points[b - 1, 1] - points[a, 1]) > widest:
            continue
        _extent(points, bearings, a, b, spacing, out[c])
        _moments(points, a, b, out[c])
        _outline(points, a, b, spacing, out[c])
        _texture(points, ranges, a, b, out[c])
        out[c, 24] = _valley(ranges, a, b)


@ieee_kernel
def _mean(points, a, b):
    x = 0.0
    y = 0.0
    for i in range(a, b):
        x += points[i, 0]
        y += points[i, 1]
    return x / (b - a), y / (b - a)


@ieee_kernel
def _extent(points, bearings, a, b, spacing, row):
    """Columns 0 to 6: points, range, expected points, span, width, depth, fill."""
    cx, cy = _mean(points, a, b)
    distance = np.hypot(cx, cy)
    nearest = np.inf
    farthest = -np.inf
    for i in range(a, b):
        along = (points[i, 0] * cx + points[i, 1] * cy) / distance
        nearest = min(nearest, along)
        farthest = max(farthest, along)
    angle = bearings[b - 1] - bearings[a]
    row[0] = b - a
    row[1] = distance
    row[2] = LEG_WIDTH / (distance * spacing)
    row[3] = (angle + spacing) * distance
    row[4] = np.hypot(points[b - 1, 0] - points[a, 0], points[b - 1, 1] - points[a, 1])
    row[5] = farthest - nearest
    row[6] = (b - a) / (np.floor(angle / spacing + 0.5) + 1.0)


@ieee_kernel
def _moments(points, a, b, row):
    """Columns 7 to 12 and 21: deviations, principal axes, best circle, tilt."""
    cx, cy = _mean(points, a, b)
    n = b - a
    mx, my = points[a + n // 2]
    from_middle = 0.0
    xx = 0.0
    xy = 0.0
    yy = 0.0
    xz = 0.0
    yz = 0.0
    for i in range(a, b):
        x = points[i, 0] - cx
        y = points[i, 1] - cy
        from_middle += np.hypot(points[i, 0] - mx, points[i, 1] - my)
        z = x * x + y * y
        xx += x * x
        xy += x * y
        yy += y * y
        xz += x * z
        yz += y * z
    half = 0.5 * (xx + yy)
    spread = np.hypot(0.5 * (xx - yy), xy)
    large = half + spread
    small = max(half - spread, 0.0)
    row[7] = np.sqrt(2.0 * half / n)
    row[8] = from_middle / n
    row[9] = np.sqrt(small / n)
    row[10] = np.sqrt(small / large) if large > 0.0 else 0.0
    row[11], row[12] = _circle(points, a, b, cx, cy, xx, xy, yy, xz, yz)
    axis = 0.5 * np.arctan2(2.0 * xy, xx - yy)
    row[21] = abs(np.cos(axis) * cx + np.sin(axis) * cy) / np.hypot(cx, cy)


@ieee_kernel
def _circle(points, a, b, cx, cy, xx, xy, yy, xz, yz):
    """Kasa's circle through the points: radius (clipped) and root mean square residual, of the line if it is one."""
    n = b - a
    determinant = xx * yy - xy * xy
    if determinant <= 1e-12 * (xx + yy) ** 2:
        return RADIUS_LIMIT, 0.0
    px = 0.5 * (xz * yy - yz * xy) / determinant
    py = 0.5 * (yz * xx - xz * xy) / determinant
    radius = np.sqrt(px * px + py * py + (xx + yy) / n)
    total = 0.0
    for i in range(a, b):
        residual = np.hypot(points[i, 0] - cx - px, points[i, 1] - cy - py) - radius
        total += residual * residual
    return min(radius, RADIUS_LIMIT), np.sqrt(total / n)


@ieee_kernel
def _outline(points, a, b, spacing, row):
    """Columns 15 to 18: the outline walked in steps of about `STEP`, so that fine beams do not measure noise."""
    distance = row[1]
    stride = max(1, int(STEP / (distance * spacing)))
    stride = min(stride, (b - a - 1) // 2) if b - a >= 3 else 1
    steps = 0
    total = 0.0
    squares = 0.0
    turned = 0.0
    signed = 0.0
    last_x = 0.0
    last_y = 0.0
    for i in range(a + stride, b, stride):
        x = points[i, 0] - points[i - stride, 0]
        y = points[i, 1] - points[i - stride, 1]
        length = np.hypot(x, y)
        total += length
        squares += length * length
        if steps > 0:
            angle = np.arctan2(last_x * y - last_y * x, last_x * x + last_y * y)
            turned += abs(angle)
            signed -= angle
        steps += 1
        last_x, last_y = x, y
    mean = total / max(steps, 1)
    row[15] = total
    row[16] = np.sqrt(max(squares / max(steps, 1) - mean * mean, 0.0))
    row[17] = turned / max(steps - 1, 1)
    row[18] = signed / max(steps - 1, 1) / max(mean, 1e-3)


@ieee_kernel
def _texture(points, ranges, a, b, row):
    """Columns 13, 14, 19, 20, 22, 23: bulge against the chord, inscribed angles, steps and roughness of the ranges."""
    fx, fy = points[a]
    lx, ly = points[b - 1]
    width = max(np.hypot(lx - fx, ly - fy), 1e-3)
    bulge = 0.0
    angles = 0.0
    squares = 0.0
    rough = 0.0
    step = abs(ranges[a + 1] - ranges[a]) if b - a > 1 else 0.0
    for i in range(a + 1, b - 1):
        x = points[i, 0]
        y = points[i, 1]
        # beams run counter-clockwise: the laser is on the left of the way from the first to the last point
        bulge += ((lx - fx) * (y - fy) - (ly - fy) * (x - fx)) / width
        u, v, p, q = fx - x, fy - y, lx - x, ly - y
        angle = abs(np.arctan2(u * q - v * p, u * p + v * q))
        angles += angle
        squares += angle * angle
        step = max(step, abs(ranges[i + 1] - ranges[i]))
        second = ranges[i + 1] - 2.0 * ranges[i] + ranges[i - 1]
        rough += second * second
    inner = max(b - a - 2, 1)
    mean = angles / inner
    row[13] = bulge / inner
    row[14] = row[13] / max(width, 0.02)
    row[19] = mean
    row[20] = np.sqrt(max(squares / inner - mean * mean, 0.0))
    row[22] = step
    row[23] = np.sqrt(rough / inner)


@ieee_kernel
def _valley(ranges, a, b):
    """How much farther some point is than the nearest one before it and the nearest one after it [m]; at least 0."""
    after = np.empty(b - a)
    nearest = np.inf
    for i in range(b - 1, a - 1, -1):
        nearest = min(nearest, ranges[i])
        after[i - a] = nearest
    deepest = 0.0
    nearest = np.inf
    for i in range(a, b):
        nearest = min(nearest, ranges[i])
        deepest = max(deepest, ranges[i] - max(nearest, after[i - a]))
    return deepest
