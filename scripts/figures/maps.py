"""Pictures of occupancy maps: one map, and two maps on each other (Ye et al. 2021, Fig. 4)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from ...slam.geometry import transform_points
from ...slam.occupancy_map import OccupancyMap
from ...slam.quality.registration import register
from .canvas import BLUE, INK, RED, PlanCanvas

UNKNOWN = (214, 218, 224)
FREE = (255, 255, 255)
BOTH = (min(RED[0], BLUE[0]), min(RED[1], BLUE[1]), min(RED[2], BLUE[2]))
_BORDER_M = 0.3
_STRAY = 0.002  # share of the known cells that a picture may cut off at each side
_THINNEST_PX = 1.5


def map_canvas(grid: OccupancyMap, title: str = "", include: NDArray[np.float64] | None = None) -> PlanCanvas:
    """Return a canvas with the known part of `grid` on it, to draw more upon.

    Args:
        grid: The map.
        title: Line above it.
        include: (N, 2) points that must be in the picture, too [m].
    """
    known = grid.cell_centres(grid.known)
    if len(known):
        # a few rays through windows and doors must not make the building small
        known = np.quantile(known, (_STRAY, 1.0 - _STRAY), axis=0)
    low, high = _bounds(known if include is None else np.vstack((known, include)), grid.resolution)
    canvas = PlanCanvas(low, high, title)
    canvas.polygon([low, (high[0], low[1]), high, (low[0], high[1])], UNKNOWN)
    canvas.cells(grid.cell_centres(grid.free), grid.resolution, FREE)
    canvas.cells(grid.occupied_points, grid.resolution, INK, _THINNEST_PX)
    return canvas


def map_picture(grid: OccupancyMap, title: str = "") -> Image.Image:
    """Return a picture of one map: walls black, free space white, unknown grey, with a scale bar."""
    canvas = map_canvas(grid, title)
    canvas.legend([("occupied", INK), ("free", FREE), ("unknown", UNKNOWN)])
    return canvas.finished()


def overlay_picture(
    estimate: OccupancyMap, reference: OccupancyMap, title: str = "", T_ref_est: ArrayLike | None = None
) -> Image.Image:
    """Return the occupied cells of both maps on each other: reference red, estimate blue, where both are almost black.

    Args:
        estimate: The estimated map.
        reference: The map that counts as the truth.
        title: Line above the plan.
        T_ref_est: (3,) how the estimate lies on the reference; None registers it, as for its score.
    """
    points = reference.occupied_points
    if T_ref_est is None:
        T_ref_est = register(estimate.occupied_points, points).T_ref_est
    moved = transform_points(T_ref_est, estimate.occupied_points)
    canvas = PlanCanvas(*_bounds(np.vstack((points, moved)), max(estimate.resolution, reference.resolution)), title)
    canvas.cells(points, reference.resolution, RED, _THINNEST_PX)
    canvas.cells(moved, estimate.resolution, BLUE, _THINNEST_PX, mix=True)
    canvas.legend([("reference", RED), ("estimate", BLUE), ("both", BOTH)])
    return canvas.finished()


def _bounds(points: NDArray[np.float64], cell: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the corners (2,) and (2,) of a rectangle around `points` (n, 2), centres of cells of side `cell` [m]."""
    if len(points) == 0:
        return np.zeros(2), np.ones(2)
    low, high = points.min(axis=0), points.max(axis=0)
    border = max(_BORDER_M, cell, 0.02 * float((high - low).max()))
    return low - border, high + border
