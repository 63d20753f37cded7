"""Cell by cell: how well an estimated map agrees with a reference map once both lie in one frame."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_points, check_size, checked_pose
from ..errors import InputError
from ..geometry import inverse, transform_points
from ..occupancy_map import OccupancyMap
from .map_kernels import look_up, mark_near

Mask = NDArray[np.bool_]
_WIDEST_M = 10.0  # [m] nobody crosses more around a foot
_MOST_CELLS = 50_000_000  # every cell takes eighty bytes while they are compared: 4 GB


@dataclass(frozen=True, eq=False)
class CommonCells:
    """Two maps on one lattice in the frame of the reference.

    Attributes:
        estimate_occupied: (rows, cols) whether an occupied cell of the estimate lies here.
        estimate_free: (rows, cols) whether the estimate knows this place to be free.
        reference_occupied: (rows, cols), likewise.
        reference_free: (rows, cols), likewise.
        resolution: Side of a cell [m]: of the coarser map.
        origin: (x, y) of the outer corner of cell [0, 0] in the frame of the reference [m].
    """

    estimate_occupied: Mask
    estimate_free: Mask
    reference_occupied: Mask
    reference_free: Mask
    resolution: float
    origin: tuple[float, float]


@dataclass(frozen=True)
class CellScore:
    """Agreement of occupied and free cells; shares in [0, 1], NaN where there is nothing to divide by.

    Attributes:
        precision: Share of the estimate's occupied cells with an occupied cell of the reference within one cell.
        recall: Share of the reference's occupied cells with an occupied cell of the estimate within one cell.
        f1: Harmonic mean of precision and recall.
        iou: Intersection over union of the occupied cells, with no tolerance.
        free_coverage: Share of the reference's free cells that the estimate knows to be free.
    """

    precision: float
    recall: float
    f1: float
    iou: float
    free_coverage: float


@dataclass(frozen=True)
class DynamicResidue:
    """What people left behind in a map.

    Attributes:
        cells: Cells occupied in the map, free in truth (with no wall within one cell), that a person crossed.
        area_m2: Their area [m^2].
        share: Their share of all cells that were free in truth and crossed; NaN if nobody crossed any.
    """

    cells: int
    area_m2: float
    share: float


def common_cells(
    estimate: OccupancyMap, reference: OccupancyMap, T_ref_est: ArrayLike = (0.0, 0.0, 0.0)
) -> CommonCells:
    """Lay both maps on one lattice: that of the reference, or of the estimate's resolution where it is coarser."""
    resolution = max(estimate.resolution, reference.resolution)
    T_ref_est = checked_pose(T_ref_est, "T_ref_est")
    corners = np.vstack((_corners(reference), transform_points(T_ref_est, _corners(estimate))))
    origin = np.asarray(reference.origin)
    low = np.floor((corners.min(axis=0) - origin) / resolution - 1e-6)
    origin = origin + low * resolution
    cols, rows = np.ceil((corners.max(axis=0) - origin) / resolution - 1e-6).tolist()
    check_size(cols, rows, resolution, _MOST_CELLS, "the lattice of both maps")
    cols, rows = int(cols), int(rows)
    x = np.arange(cols) * resolution + resolution / 2.0 + origin[0]
    y = np.arange(rows) * resolution + resolution / 2.0 + origin[1]
    centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    in_est = transform_points(inverse(T_ref_est), centres)
    return CommonCells(
        _stamped(transform_points(T_ref_est, estimate.occupied_points), origin, resolution, (rows, cols)),
        _looked_up(estimate, estimate.free, in_est).reshape(rows, cols),
        _stamped(reference.occupied_points, origin, resolution, (rows, cols)),
        _looked_up(reference, reference.free, centres).reshape(rows, cols),
        resolution,
        (float(origin[0]), float(origin[1])),
    )


def score_cells(cells: CommonCells) -> CellScore:
    """Return the agreement of two maps on one lattice."""
    est, ref = cells.estimate_occupied, cells.reference_occupied
    precision = _share(est & _grown(ref), est)
    recall = _share(ref & _grown(est), ref)
    f1 = 2.0 * precision * recall / (precision + recall) if precision + recall > 0.0 else 0.0 * (precision + recall)
    coverage = _share(cells.estimate_free & cells.reference_free, cells.reference_free)
    return CellScore(precision, recall, f1, _share(est & ref, est | ref), coverage)


def dynamic_residue(cells: CommonCells, people: ArrayLike, radius: float = 0.12) -> DynamicResidue:
    """Return what people left behind in the estimated map.

    Args:
        cells: Both maps on one lattice; the reference is the truth, mapped without people.
        people: (..., 2) places where people's feet were, in the frame of the reference [m]; NaN for a foot that was
            not there.
        radius: A cell within this distance of such a place was crossed [m].

    Raises:
        InputError: If `people` has not shape (..., 2) or `radius` is not positive.
    """
    places = np.asarray(people, dtype=np.float64)
    if places.ndim < 1 or places.shape[-1] != 2 or not 0.0 < radius <= _WIDEST_M:
        raise InputError(
            f"needs people (..., 2) and a radius in (0, {_WIDEST_M:g}] m, got shape {places.shape} and {radius}"
        )
    check_points(places, "people", gaps=True)
    crossed = np.zeros_like(cells.reference_free)
    mark_near(places[np.isfinite(places).all(axis=-1)], radius, *cells.origin, cells.resolution, crossed)
    crossed &= cells.reference_free & ~_grown(cells.reference_occupied)
    left = int((crossed & cells.estimate_occupied).sum())
    return DynamicResidue(left, left * cells.resolution**2, _share(crossed & cells.estimate_occupied, crossed))


def _grown(mask: Mask) -> Mask:
    """Return `mask` with the eight neighbours of every true cell."""
    rows = mask.copy()
    rows[1:] |= mask[:-1]
    rows[:-1] |= mask[1:]
    grown = rows.copy()
    grown[:, 1:] |= rows[:, :-1]
    grown[:, :-1] |= rows[:, 1:]
    return grown


def _corners(grid: OccupancyMap) -> NDArray[np.float64]:
    rows, cols = grid.probability.shape
    size = np.array((cols, rows)) * grid.resolution
    return np.asarray(grid.origin) + np.array(((0, 0), (1, 0), (0, 1), (1, 1))) * size


def _stamped(points: NDArray[np.float64], origin: NDArray, resolution: float, shape: tuple[int, int]) -> Mask:
    mask = np.zeros(shape, dtype=bool)
    # a hair's breadth to the inside: a point on the border of two cells must not fall by rounding
    cols, rows = np.floor((points - origin) / resolution + 1e-6).astype(int).T
    mask[np.clip(rows, 0, shape[0] - 1), np.clip(cols, 0, shape[1] - 1)] = True
    return mask


def _looked_up(grid: OccupancyMap, mask: Mask, points: NDArray[np.float64]) -> Mask:
    found = np.zeros(len(points), dtype=np.bool_)
    look_up(points, *grid.origin, grid.resolution, mask, found)
    return found


def _share(part: Mask, whole: Mask) -> float:
    total = int(whole.sum())
    return int(part.sum()) / total if total else float("nan")
