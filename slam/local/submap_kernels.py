"""Numba kernels that write a scan into the cells of a submap."""

import numpy as np
from numpy.typing import NDArray

from ..view_kernel import kernel, spliced_kernel

Grid = NDArray[np.float32]
Points = NDArray[np.float64]

_WALL = 0.5  # occupancy from which a cell stops a beam


@kernel
def insert_scans(
    hits: Grid,
    visits: Grid,
    field: Grid,
    stamps: NDArray[np.int16],
    inserted: int,
    cells: Points,
    sizes: NDArray[np.int64],
    prior_visits: float,
    margin: float,
) -> None:
    """Count scans in the grids (rows, cols), in place, one after the other.

    A return is shared by the four cells around it in proportion to its nearness (so the place of a wall within a cell
    is kept); the cells that the ray crosses before are passed. A cell counts one visit a scan, and none as passed
    where the scan had a return. `field` becomes hits / (visits + prior_visits), at most 1.

    Args:
        hits: Sum of the shares of returns.
        visits: Number of scans that saw the cell.
        field: Occupancy in [0, 1].
        stamps: Last scan that counted in a cell; scans are numbered from 1 on.
        inserted: Number of scans before these.
        cells: (N, 2) points in cell units: (0, 0) is the centre of cell [0, 0], x along the columns. Of each scan: the
            laser, then returns, then points on surfaces between them, then ends of free rays.
        sizes: (n, 3) of each scan the number of its points, of returns among them and of points on surfaces between.
        prior_visits: Visits without a return that every cell starts with.
        margin: The last share of a ray up to a return, which is not counted as passed.
    """
    first = 0
    for n in range(len(sizes)):
        stop, returns, between = first + sizes[n, 0], sizes[n, 1], sizes[n, 2]
        stamp, x0, y0 = inserted + n + 1, cells[first, 0], cells[first, 1]
        ends = cells[first + 1 : stop]
        _share_returns(hits, visits, field, stamps, stamp, ends, returns + between, prior_visits)
        for k in range(len(ends)):
            if returns <= k < returns + between:
                continue
            dx, dy = ends[k, 0] - x0, ends[k, 1] - y0
            share = 1.0 - margin if k < returns else 1.0
            _pass_ray(hits, visits, field, stamps, stamp, x0, y0, x0 + share * dx, y0 + share * dy, prior_visits)
        first = stop


@kernel
def _share_returns(hits, visits, field, stamps, stamp, cells, count, prior_visits):  # type: ignore[no-untyped-def]
    """Share the first `count` of `cells` among the four cells around each."""
    for k in range(count):
        i, j = int(np.floor(cells[k, 0])), int(np.floor(cells[k, 1]))
        fx, fy = cells[k, 0] - i, cells[k, 1] - j
        for row, wy in ((j, 1.0 - fy), (j + 1, fy)):
            for col, wx in ((i, 1.0 - fx), (i + 1, fx)):
                if stamps[row, col] != stamp:
                    stamps[row, col] = stamp
                    visits[row, col] += 1.0
                hits[row, col] += wx * wy
    for k in range(count):
        i, j = int(np.floor(cells[k, 0])), int(np.floor(cells[k, 1]))
        for row in range(j, j + 2):
            for col in range(i, i + 2):
                field[row, col] = min(1.0, hits[row, col] / (visits[row, col] + prior_visits))


@spliced_kernel
def _pass_ray(hits, visits, field, stamps, stamp, x0, y0, x1, y1, prior_visits):  # type: ignore[no-untyped-def]
    """Count a visit in every cell that the segment crosses and this scan has not counted yet (Amanatides, Woo 1987)."""
    col, row = int(np.floor(x0 + 0.5)), int(np.floor(y0 + 0.5))
    end_col, end_row = int(np.floor(x1 + 0.5)), int(np.floor(y1 + 0.5))
    dx, dy = x1 - x0, y1 - y0
    step_x, step_y = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    delta_x = 1.0 / abs(dx) if dx != 0.0 else np.inf
    delta_y = 1.0 / abs(dy) if dy != 0.0 else np.inf
    next_x = (0.5 + step_x * (col - x0)) * delta_x if dx != 0.0 else np.inf
    next_y = (0.5 + step_y * (row - y0)) * delta_y if dy != 0.0 else np.inf
    for _ in range(abs(end_col - col) + abs(end_row - row)):
        r, c = np.uintp(row), np.uintp(col)  # unsigned: numba need not look for indices from the end
        if stamps[r, c] != stamp:
            stamps[r, c] = stamp
            visits[r, c] += 1.0
            if hits[r, c] > 0.0:
                field[r, c] = min(1.0, hits[r, c] / (visits[r, c] + prior_visits))
        if next_x < next_y:
            next_x += delta_x
            col += step_x
        else:
            next_y += delta_y
            row += step_y


@kernel
def bounds(points: Points) -> tuple[float, float, float, float]:
    """Return the lowest x and y, then the highest, of `points` (N, 2)."""
    low_x, low_y, high_x, high_y = points[0, 0], points[0, 1], points[0, 0], points[0, 1]
    for k in range(1, len(points)):
        low_x, high_x = min(low_x, points[k, 0]), max(high_x, points[k, 0])
        low_y, high_y = min(low_y, points[k, 1]), max(high_y, points[k, 1])
    return low_x, low_y, high_x, high_y


@kernel
def passes_wall(field: NDArray[np.float32], x0: float, y0: float, x1: float, y1: float, slack: float) -> bool:
    """Return whether a beam between two places, in cells, goes through a wall more than `slack` cells before its end.

    Args:
        field: (rows, cols) occupancy in [0, 1].
        x0: Column of the laser; a cell begins at a whole number.
        y0: Row of the laser.
        x1: Column of the end.
        y1: Row of the end.
        slack: In cells.
    """
    rows, cols = field.shape
    length = np.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
    for step in range(1, int(length - slack) + 1):
        i = int(np.floor(y0 + step / length * (y1 - y0)))
        j = int(np.floor(x0 + step / length * (x1 - x0)))
        if 0 <= i < rows and 0 <= j < cols and field[i, j] > _WALL:
            return True
    return False


@kernel
def beams(
    points: Points, sensor: Points, pose: Points, corner: Points, resolution: float
) -> tuple[float, float, Points, Points]:
    """Return column and row where the beams of a scan begin, and (N,) columns and rows where they end, in cells.

    Args:
        points: (N, 2) their ends, robot frame [m].
        sensor: (2,) place of the laser, robot frame [m].
        pose: (3,) T_local_robot.
        corner: (2,) centre of cell [0, 0] [m]; a cell begins at a whole number.
        resolution: Side of a cell [m].
    """
    c, s = np.cos(pose[2]), np.sin(pose[2])
    x = (pose[0] + c * points[:, 0] - s * points[:, 1] - corner[0]) / resolution + 0.5
    y = (pose[1] + s * points[:, 0] + c * points[:, 1] - corner[1]) / resolution + 0.5
    x0 = (pose[0] + c * sensor[0] - s * sensor[1] - corner[0]) / resolution + 0.5
    y0 = (pose[1] + s * sensor[0] + c * sensor[1] - corner[1]) / resolution + 0.5
    return x0, y0, x, y
