"""A finished occupancy map, as every engine returns it and every file format stores it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .bounds import COARSEST_CELL_M, FARTHEST_M, FINEST_CELL_M, MOST_CELLS
from .errors import InputError, shown


@dataclass(frozen=True, eq=False)
class OccupancyMap:
    """Cells of a plane with the probability that they are occupied.

    Attributes:
        probability: (rows, cols) float32, in [0, 1]; NaN where nothing is known. Row 0: lowest y.
        resolution: Side of a cell [m].
        origin: (x, y) of the outer corner of cell [0, 0] in the map frame [m].
        occupied_threshold: A cell is occupied above this probability.
        free_threshold: A cell is free below this probability.

    Raises:
        InputError: If a shape, the resolution, the origin or a threshold is beyond what it can be.
    """

    probability: NDArray[np.float32]
    resolution: float
    origin: tuple[float, float]
    occupied_threshold: float = 0.5
    free_threshold: float = 0.5

    def __post_init__(self) -> None:
        if self.probability.ndim != 2:
            raise InputError(f"`probability` must have shape (rows, cols), got {self.probability.shape}")
        if self.probability.size > MOST_CELLS:
            rows, cols = self.probability.shape
            raise InputError(f"a map must have {MOST_CELLS} cells at most, got {rows} x {cols}")
        if not FINEST_CELL_M <= self.resolution <= COARSEST_CELL_M:
            raise InputError(
                f"`resolution` must be within {FINEST_CELL_M:g} .. {COARSEST_CELL_M:g} m, got {self.resolution}"
            )
        if not (np.shape(self.origin) == (2,) and max(abs(self.origin[0]), abs(self.origin[1])) <= FARTHEST_M):
            raise InputError(f"`origin` must be finite and within {FARTHEST_M:g} m, got {shown(self.origin)}")
        for name in ("occupied_threshold", "free_threshold"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"`{name}` must be in [0, 1], got {getattr(self, name)}")

    @property
    def occupied(self) -> NDArray[np.bool_]:
        """(rows, cols) whether a cell is occupied; unknown cells are not."""
        return self.probability > self.occupied_threshold

    @property
    def free(self) -> NDArray[np.bool_]:
        """(rows, cols) whether a cell is free; unknown cells are not."""
        return self.probability < self.free_threshold

    @property
    def known(self) -> NDArray[np.bool_]:
        """(rows, cols) whether anything is known about a cell."""
        return ~np.isnan(self.probability)

    def cell_centres(self, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return (M, 2) centres in the map frame [m] of the cells where `mask` (rows, cols) is true, row by row."""
        rows, cols = np.nonzero(mask)
        cells = np.stack((cols, rows), axis=-1).astype(np.float64)
        return (cells + 0.5) * self.resolution + np.asarray(self.origin, dtype=np.float64)

    @property
    def occupied_points(self) -> NDArray[np.float64]:
        """(M, 2) centres of the occupied cells in the map frame [m]."""
        return self.cell_centres(self.occupied)
