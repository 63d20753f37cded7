"""Kernels that compare maps cell by cell and describe the pieces of their walls."""

import numpy as np

from ..view_kernel import kernel


@kernel
def look_up(points, x0, y0, resolution, mask, found):
    """Write into `found` (n,) whether `mask` (rows, cols) is true where `points` (n, 2) lie [m]; outside it is not.

    The corner of the mask lies at (x0, y0) [m], its cells are `resolution` [m] wide; a point on the border of two cells
    lies in the upper one, by rounding or not.
    """
    for k in range(len(points)):
        col = int(np.floor((points[k, 0] - x0) / resolution + 1e-6))
        row = int(np.floor((points[k, 1] - y0) / resolution + 1e-6))
        found[k] = 0 <= row < mask.shape[0] and 0 <= col < mask.shape[1] and mask[row, col]


@kernel
def mark_near(points, radius, x0, y0, resolution, mask):
    """Set `mask` (rows, cols), of cells as in `look_up`, where the centre is nearer than `radius` [m] to one of
    `points` (n, 2)."""
    reach = int(np.ceil(radius / resolution)) + 1
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        col, row = int(np.floor((x - x0) / resolution)), int(np.floor((y - y0) / resolution))
        for r in range(max(row - reach, 0), min(row + reach + 1, mask.shape[0])):
            dy = r * resolution + resolution / 2.0 + y0 - y
            for c in range(max(col - reach, 0), min(col + reach + 1, mask.shape[1])):
                dx = c * resolution + resolution / 2.0 + x0 - x
                if dx * dx + dy * dy < radius * radius:
                    mask[r, c] = True


@kernel
def describe_pieces(points, neighbours, middles, spreads):
    """Write the mean (n, 2) and the covariance (n, 2, 2) of the piece of wall around each point.

    Args:
        points: (n, 2) [m].
        neighbours: (n, k) indices of the points of each piece; n where there is none.
        middles: (n, 2) the means.
        spreads: (n, 2, 2) the covariances.
    """
    for k in range(len(points)):
        members = 0
        for m in range(neighbours.shape[1]):
            members += neighbours[k, m] < len(points)
        weight = 1.0 / members
        x, y = 0.0, 0.0
        for m in range(neighbours.shape[1]):
            i = neighbours[k, m]
            if i < len(points):
                x += weight * points[i, 0]
                y += weight * points[i, 1]
        xx, xy, yx, yy = 0.0, 0.0, 0.0, 0.0
        for m in range(neighbours.shape[1]):
            i = neighbours[k, m]
            if i < len(points):
                dx, dy = points[i, 0] - x, points[i, 1] - y
                xx += weight * dx * dx
                xy += weight * dx * dy
                yx += weight * dy * dx
                yy += weight * dy * dy
        middles[k, 0], middles[k, 1] = x, y
        spreads[k, 0, 0], spreads[k, 0, 1], spreads[k, 1, 0], spreads[k, 1, 1] = xx, xy, yx, yy
