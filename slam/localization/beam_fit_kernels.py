"""How well a scan's beams fit a map at many poses, for places that are weighed for long, in numba."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..scan_to_grid.refine_kernels import refine_pose
from ..view_kernel import kernel, spliced_kernel

Array = NDArray[np.float64]

UNKNOWN, FREE, OCCUPIED = 0, 1, 2


class BeamModel(NamedTuple):
    """What beams are expected to do.

    Attributes:
        sigma: How far from a wall an end may lie [m].
        slack: A wall counts as come through more than this before the end [m].
        stray: Likelihood of a beam that ends away from walls.
        through: What is left of that of a beam that came through a wall.
        unseen: Likelihood of one that ends in the unknown.
    """

    sigma: float
    slack: float
    stray: float
    through: float
    unseen: float


@kernel
def _stopped(  # type: ignore[no-untyped-def]
    states, distances, resolution: float, x: float, y: float, dx: float, dy: float, length: float
) -> bool:
    """Return whether a ray from (x, y) along (dx, dy) meets a wall within `length`; all in cells.

    Free space is leapt over, as far as the nearest wall is away; a cell and a half less, as distances are those between
    cells' centres.
    """
    along = 1.0
    while along < length:
        i, j = int(np.floor(y + along * dy)), int(np.floor(x + along * dx))
        if not (0 <= i < states.shape[0] and 0 <= j < states.shape[1]):
            return False
        if states[i, j] == OCCUPIED:
            return True
        along += max(1.0, distances[i, j] / resolution - 1.5)
    return False


@kernel
def _comes_through(  # type: ignore[no-untyped-def]
    states, distances, resolution: float, x: float, y: float, dx: float, dy: float, length: float, aside: float
) -> bool:
    """Return whether a ray comes through a wall that goes on to both its sides, so far `aside` as walls are known.

    Where one of its neighbours is free it may have grazed a wall, or passed next to its end or a leg of a chair.
    """
    if not _stopped(states, distances, resolution, x, y, dx, dy, length):
        return False
    u, v = aside * dy, aside * dx
    return _stopped(states, distances, resolution, x - u, y + v, dx, dy, length) and _stopped(
        states, distances, resolution, x + u, y - v, dx, dy, length
    )


@spliced_kernel
def _beam_likelihood(model: BeamModel, worth: float, known: bool) -> tuple[float, float]:
    """Return the likelihood of a beam that ends so near a wall, and how much of it the map explains."""
    value = model.stray + (1.0 - model.stray) * worth
    if not known and value < model.unseen:
        return model.unseen, 0.5
    return value, 1.0 if worth > 0.5 else 0.0


@kernel
def beam_misfits(
    states: NDArray[np.uint8],
    distances: NDArray[np.float32],
    corner: Array,
    resolution: float,
    sensor: Array,
    points: Array,
    poses: Array,
    model: BeamModel,
    misfits: Array,
    explained: Array,
) -> None:
    """Write the mean negative log-likelihood of a scan's beams at each pose, and the share of beams explained.

    Args:
        states: (rows, cols) UNKNOWN, FREE or OCCUPIED.
        distances: (rows, cols) from each cell's centre to the nearest occupied cell's centre [m].
        corner: (2,) outer corner of cell [0, 0] [m].
        resolution: Side of a cell [m].
        sensor: (2,) place of the laser in the robot frame [m].
        points: (N, 2) ends of the beams in the robot frame [m].
        poses: (k, 3) T_map_robot.
        model: What beams do.
        misfits: (k,) the result, 0 and above.
        explained: (k,) the result; a beam that ends where the map knows nothing counts as half explained.
    """
    rows, cols = states.shape
    for k in range(len(poses)):
        c, s = np.cos(poses[k, 2]), np.sin(poses[k, 2])
        x0 = (poses[k, 0] + c * sensor[0] - s * sensor[1] - corner[0]) / resolution
        y0 = (poses[k, 1] + s * sensor[0] + c * sensor[1] - corner[1]) / resolution
        total = share = 0.0
        for n in range(len(points)):
            x1 = (poses[k, 0] + c * points[n, 0] - s * points[n, 1] - corner[0]) / resolution
            y1 = (poses[k, 1] + s * points[n, 0] + c * points[n, 1] - corner[1]) / resolution
            dx, dy = x1 - x0, y1 - y0
            length = max(np.sqrt(dx * dx + dy * dy), 1e-9)
            i, j = int(np.floor(y1)), int(np.floor(x1))
            inside = 0 <= i < rows and 0 <= j < cols
            worth = np.exp(-0.5 * ((distances[i, j] if inside else 1e3) / model.sigma) ** 2)
            through = _comes_through(
                states, distances, resolution, x0, y0, dx / length, dy / length,
                length - model.slack / resolution, model.sigma / resolution,
            )  # fmt: skip
            known = through or (inside and states[i, j] != UNKNOWN)
            value, explained_by = _beam_likelihood(model, worth * (model.through if through else 1.0), known)
            total -= np.log(value)
            share += explained_by
        misfits[k] = total / max(len(points), 1)
        explained[k] = share / max(len(points), 1)


@kernel
def refine_poses(
    field: NDArray[np.float32],
    corner: Array,
    resolution: float,
    points: Array,
    poses: Array,
    expected: Array,
    hold: Array,
    weight: float,
    iterations: int,
) -> None:
    """Move `poses` (k, 3) to where `points` fit `field` best, held to `expected` (k, 3) by `hold` (3, 3)."""
    for k in range(len(poses)):
        refined = refine_pose(field, corner, resolution, points, poses[k], expected[k], hold, weight, iterations, 1e-3)
        poses[k] = refined[0]
