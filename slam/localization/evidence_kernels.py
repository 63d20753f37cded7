"""How well a scan's beams fit a map at many poses, free space included, in numba; `reference.py` is the plain one."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNKNOWN, FREE, OCCUPIED = 0, 1, 2
FLOOR = 0.05
"""Likelihood of a beam that contradicts the map: people and moved things make some of them at any pose."""
BESIDE, OBLIQUE = 1.0, 6
"""[cells] So far to both sides goes on a wall that stops a ray, looked for so far ahead and behind."""
UNSEEN = 0.6
"""Likelihood of a beam that ends where the map knows nothing: at the map's edge that is no surprise, and no proof."""


@njit(cache=True, nogil=True)
def is_blocked(states: NDArray[np.uint8], x0: float, y0: float, x1: float, y1: float, slack: float) -> bool:
    """Return whether a ray comes through a wall more than `slack` before its end, looked at once a cell's side.

    A wall goes on to both sides of the ray. Where nothing is occupied beside it on one side, it may have passed next to
    the leg of a chair or the end of a wall, which fills a part of its cell only.

    All lengths in cells, from the outer corner of cell [0, 0].
    """
    dx, dy = x1 - x0, y1 - y0
    length = np.sqrt(dx * dx + dy * dy)
    last = int(length - slack)
    if last < 1:
        return False
    dx, dy = dx / length, dy / length
    for step in range(1, last + 1):
        x, y = x0 + step * dx, y0 + step * dy
        if not _occupied(states, x, y):
            continue
        left = right = False
        for ahead in range(-OBLIQUE, OBLIQUE + 1):
            u, v = x + ahead * dx, y + ahead * dy
            left = left or _occupied(states, u - BESIDE * dy, v + BESIDE * dx)
            right = right or _occupied(states, u + BESIDE * dy, v - BESIDE * dx)
            if left and right:
                return True
    return False


@njit(cache=True, nogil=True)
def count_blocked(states: NDArray[np.uint8], start: Array, ends: Array, slack: float) -> int:
    """Return how many rays from `start` (2,) to `ends` (N, 2) are blocked; lengths as of `is_blocked`."""
    count = 0
    for n in range(len(ends)):
        count += is_blocked(states, start[0], start[1], ends[n, 0], ends[n, 1], slack)
    return count


@njit(cache=True, nogil=True)
def _occupied(states: NDArray[np.uint8], x: float, y: float) -> bool:
    i, j = int(np.floor(y)), int(np.floor(x))
    return 0 <= i < states.shape[0] and 0 <= j < states.shape[1] and states[i, j] == OCCUPIED


@njit(cache=True, nogil=True)
def beam_likelihoods(
    states: NDArray[np.uint8],
    distances: NDArray[np.float32],
    corner: Array,
    resolution: float,
    sensor: Array,
    points: Array,
    poses: Array,
    sigma: float,
    slack: float,
    likelihoods: NDArray[np.float32],
) -> None:
    """Write into `likelihoods` (k, N) how likely each beam's end is at each pose, in [FLOOR, 1] relative to the best.

    A beam is explained by a wall near its end: exp(-d^2 / 2 sigma^2). One that comes through a wall more than `slack`
    before its end contradicts the map, and so does one that ends in free space away from walls.

    Args:
        states: (rows, cols) UNKNOWN, FREE or OCCUPIED.
        distances: (rows, cols) from each cell's centre to the nearest occupied cell's centre [m].
        corner: (2,) outer corner of cell [0, 0] [m].
        resolution: Side of a cell [m].
        sensor: (2,) place of the laser in the robot frame [m].
        points: (N, 2) ends of the beams in the robot frame [m].
        poses: (k, 3) T_map_robot.
        sigma: How far from a wall an end may lie [m].
        slack: [m].
        likelihoods: (k, N) the result.
    """
    rows, cols = states.shape
    for k in range(len(poses)):
        c, s = np.cos(poses[k, 2]), np.sin(poses[k, 2])
        x0 = (poses[k, 0] + c * sensor[0] - s * sensor[1] - corner[0]) / resolution
        y0 = (poses[k, 1] + s * sensor[0] + c * sensor[1] - corner[1]) / resolution
        for n in range(len(points)):
            x1 = (poses[k, 0] + c * points[n, 0] - s * points[n, 1] - corner[0]) / resolution
            y1 = (poses[k, 1] + s * points[n, 0] + c * points[n, 1] - corner[1]) / resolution
            if is_blocked(states, x0, y0, x1, y1, slack / resolution):
                likelihoods[k, n] = FLOOR
                continue
            i, j = int(np.floor(y1)), int(np.floor(x1))
            value = UNSEEN
            if 0 <= i < rows and 0 <= j < cols:
                distance = distances[i, j]
                value = FLOOR + (1.0 - FLOOR) * np.exp(-0.5 * distance * distance / (sigma * sigma))
                if states[i, j] == UNKNOWN:
                    value = max(value, UNSEEN)
            likelihoods[k, n] = value
