"""Numba kernels of the features of what stands around a cluster; `reference.py` says the same in numpy."""

import numpy as np

from ...slam.view_kernel import ieee_kernel
from .shape_kernels import SHAPE_COUNT

SURROUNDINGS_COUNT = 28
JUMP_LIMIT = 2.0  # range differences are clipped to it; also what no neighbour at all counts as [m]
NEARER_LIMIT = -1.0
OPEN = 1.5  # the value of a beam without a return in the windows beside a cluster [m]
BESIDE, FAR_BESIDE = 0.3, 0.8  # widths of the windows beside the ends [m]
RADII = (0.3, 0.6, 1.2)  # of the rings around the mean point [m]
FAR = 1.21  # beyond all rings, whatever the last bit of a distance [m]
IN_LINE = 0.05
WIDEST_MATE = 0.5
LONGEST_STANCE = 0.8
USUAL_STANCE = 0.25
MISSING_BEAMS = 3.5  # the next return must be within this many beams to count as a neighbour
AT_MOST = 48  # returns looked at on each side of a cluster; more are thinned out


@ieee_kernel
def describe_surroundings(points, ranges, bearings, start, end, spacing, widest, out):
    """Fill the columns after `SHAPE_COUNT` of `out` (m, F), whose first ones must be there already."""
    described = np.zeros(len(start), np.bool_)
    centres = np.zeros((len(start), 2))
    for c in range(len(start)):
        a, b = start[c], end[c]
        for i in range(a, b):
            centres[c, 0] += points[i, 0] / (b - a)
            centres[c, 1] += points[i, 1] / (b - a)
        if np.hypot(points[b - 1, 0] - points[a, 0], points[b - 1, 1] - points[a, 1]) > widest:
            continue
        described[c] = True
        _ends(points, ranges, bearings, a, b, spacing, out[c])
        _beside(ranges, bearings, a, b, spacing, out[c])
        _rings(points, ranges, bearings, a, b, spacing, centres[c], out[c])
    for c in range(len(start)):
        if described[c]:
            _mate(points, start, end, described, centres, c, out)


@ieee_kernel
def _ends(points, ranges, bearings, a, b, spacing, row):
    """Columns 0 to 4: range jumps and gaps just beyond the two ends."""
    jump_low, jump_high, gap_low, gap_high = np.inf, -np.inf, np.inf, -np.inf
    occluded = 0
    for side in range(2):
        inner = a if side == 0 else b - 1
        outer = a - 1 if side == 0 else b
        jump, gap = JUMP_LIMIT, JUMP_LIMIT
        if 0 <= outer < len(ranges) and abs(bearings[outer] - bearings[inner]) <= MISSING_BEAMS * spacing:
            jump = ranges[outer] - ranges[inner]
            gap = np.hypot(points[outer, 0] - points[inner, 0], points[outer, 1] - points[inner, 1])
            occluded += jump < -0.05
            jump, gap = min(max(jump, -JUMP_LIMIT), JUMP_LIMIT), min(gap, JUMP_LIMIT)
        jump_low, jump_high = min(jump_low, jump), max(jump_high, jump)
        gap_low, gap_high = min(gap_low, gap), max(gap_high, gap)
    row[SHAPE_COUNT] = jump_low
    row[SHAPE_COUNT + 1] = jump_high
    row[SHAPE_COUNT + 2] = gap_low
    row[SHAPE_COUNT + 3] = gap_high
    row[SHAPE_COUNT + 4] = occluded


@ieee_kernel
def _beside(ranges, bearings, a, b, spacing, row):
    """Columns 5 to 10: range differences in two windows beside each end; beams without a return count as open."""
    for side in range(2):
        inner = a if side == 0 else b - 1
        step = -1 if side == 0 else 1
        near = min(BESIDE / ranges[inner], 1.5)
        far = min(FAR_BESIDE / ranges[inner], 2.0)
        least, near_sum, far_sum, near_count, far_count = OPEN, 0.0, 0.0, 0.0, 0.0
        i = inner + step
        while 0 <= i < len(ranges) and abs(bearings[i] - bearings[inner]) <= far:
            difference = min(max(ranges[i] - ranges[inner], NEARER_LIMIT), OPEN)
            if abs(bearings[i] - bearings[inner]) <= near:
                near_sum += difference - OPEN
                near_count += 1.0
                least = min(least, difference)
            else:
                far_sum += difference - OPEN
                far_count += 1.0
            i += step
        near_mean = OPEN + near_sum / max(np.floor(near / spacing), near_count, 1.0)
        far_mean = OPEN + far_sum / max(np.floor((far - near) / spacing), far_count, 1.0)
        for k, value in ((5, near_mean), (7, least), (9, far_mean)):
            row[SHAPE_COUNT + k] = value if side == 0 else min(row[SHAPE_COUNT + k], np.float32(value))
            row[SHAPE_COUNT + k + 1] = value if side == 0 else max(row[SHAPE_COUNT + k + 1], np.float32(value))


@ieee_kernel
def _rings(points, ranges, bearings, a, b, spacing, centre, row):
    """Columns 11 to 15: surface around the cluster, on the cluster's line, and the line between both sides."""
    distance = np.hypot(centre[0], centre[1])
    reach = np.arcsin(min(RADII[2] / distance, 1.0)) if distance > RADII[2] else np.pi
    chord_x, chord_y = points[b - 1, 0] - points[a, 0], points[b - 1, 1] - points[a, 1]
    chord = max(np.hypot(chord_x, chord_y), 1e-6)
    surface = np.zeros(4)
    sides = np.zeros((2, 3))
    for side in range(2):
        inner = a if side == 0 else b - 1
        step = -1 if side == 0 else 1
        stride = step * max(1, int(reach / spacing) // AT_MOST)
        i = inner + step
        while 0 <= i < len(ranges) and abs(bearings[i] - bearings[inner]) <= reach:
            x, y = points[i, 0] - centre[0], points[i, 1] - centre[1]
            if x * x + y * y > FAR * FAR:  # spares most points the exact distance
                i += stride
                continue
            away = np.hypot(x, y)
            if away < RADII[2]:
                length = ranges[i] * spacing * abs(stride)
                surface[0 if away < RADII[0] else (1 if away < RADII[1] else 2)] += length
                if abs(chord_x * y - chord_y * x) / chord < IN_LINE:
                    surface[3] += length
                if away < 2.0 * RADII[0]:
                    sides[side, 0] += x
                    sides[side, 1] += y
                    sides[side, 2] += 1.0
            i += stride
    for k in range(4):
        row[SHAPE_COUNT + 11 + k] = min(surface[k], 3.0)
    row[SHAPE_COUNT + 15] = _before_line(sides, centre)


@ieee_kernel
def _before_line(sides, centre):
    """How far the origin of `sides` (sums x, y, count relative to `centre`) lies before the line through both means."""
    if sides[0, 2] == 0.0 or sides[1, 2] == 0.0:
        return 1.0
    x, y = sides[0, 0] / sides[0, 2], sides[0, 1] / sides[0, 2]
    u, v = sides[1, 0] / sides[1, 2] - x, sides[1, 1] / sides[1, 2] - y
    length = max(np.hypot(u, v), 1e-6)
    offset = (v * x - u * y) / length  # signed distance of the origin from the line, positive on its left
    towards = offset + (v * centre[0] - u * centre[1]) / length  # that of the laser, which stands at -centre
    return min(max(offset if towards >= 0.0 else -offset, -0.6), 0.6)


@ieee_kernel
def _mate(points, start, end, described, centres, c, out):
    """Columns 16 to 27: the cluster that fits best as the other leg, and how many clusters stand near."""
    best, best_cost = -1, np.inf
    near, nearer, first, second = 0, 0, JUMP_LIMIT, JUMP_LIMIT
    for o in range(len(start)):
        dx, dy = centres[o, 0] - centres[c, 0], centres[o, 1] - centres[c, 1]
        if o == c or dx * dx + dy * dy > JUMP_LIMIT * JUMP_LIMIT:
            continue
        away = np.hypot(dx, dy)
        near += away < 1.0
        nearer += away < 0.5
        if away < first:
            first, second = away, first
        elif away < second:
            second = away
        if described[o] and away < LONGEST_STANCE and out[o, 4] < WIDEST_MATE:
            cost = abs(away - USUAL_STANCE) + 2.0 * abs(out[o, 4] - out[c, 4])
            if cost < best_cost:
                best, best_cost = o, cost
    row = out[c]
    for column in range(16, 25):
        row[SHAPE_COUNT + column] = 1.0 if column in (16, 17, 19) else 0.0  # a slice takes long to compile
    row[SHAPE_COUNT + 25] = nearer
    row[SHAPE_COUNT + 26] = near
    row[SHAPE_COUNT + 27] = second
    if best < 0:
        return
    mate = out[best]
    low, high = (best, c) if best < c else (c, best)
    tail, head = points[end[low] - 1], points[start[high]]
    row[SHAPE_COUNT + 16] = np.hypot(centres[best, 0] - centres[c, 0], centres[best, 1] - centres[c, 1])
    row[SHAPE_COUNT + 17] = np.hypot(head[0] - tail[0], head[1] - tail[1])
    row[SHAPE_COUNT + 18] = min(row[4], mate[4]) / max(row[4], mate[4], 1e-3)
    row[SHAPE_COUNT + 19] = abs(row[1] - mate[1])
    row[SHAPE_COUNT + 20] = mate[4]
    row[SHAPE_COUNT + 21] = mate[13]
    row[SHAPE_COUNT + 22] = mate[9]
    row[SHAPE_COUNT + 23] = mate[SHAPE_COUNT]
    row[SHAPE_COUNT + 24] = mate[SHAPE_COUNT + 6]
