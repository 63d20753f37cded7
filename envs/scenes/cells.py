"""Buildings painted on a grid: walls as few boxes, and how far every place is from the next thing."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from .solids import Solid, box

Array = NDArray[np.float64]
Cells = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class FreeSpace:
    """Which cells of a floor are free, row 0 at the lowest y.

    Attributes:
        free: (rows, cols) whether a cell is free.
        resolution: Side of a cell [m].
        origin: (x, y) of the outer corner of cell [0, 0] [m].
    """

    free: Cells
    resolution: float
    origin: tuple[float, float]

    @cached_property
    def clearance(self) -> Array:
        """(rows, cols) distance [m] from each cell's centre to the nearest edge of a cell that is not free."""
        padded = np.pad(self.free, 1)
        cells: Array = np.empty(padded.shape)
        ndimage.distance_transform_edt(padded, distances=cells)
        return ((cells[1:-1, 1:-1] - 0.5) * self.resolution).astype(np.float64)

    def index(self, points: ArrayLike) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return row and column (n,) of the cells at `points` (n, 2) [m]; those outside get the nearest cell."""
        cells = np.floor((np.asarray(points, dtype=np.float64) - self.origin) / self.resolution).astype(np.int64)
        rows, cols = self.free.shape
        return np.clip(cells[..., 1], 0, rows - 1), np.clip(cells[..., 0], 0, cols - 1)

    def clearance_at(self, points: ArrayLike) -> Array:
        """Return (n,) the clearance [m] of the cells at `points` (n, 2) [m]."""
        return self.clearance[self.index(points)]

    def without(self, solids: tuple[Solid, ...]) -> "FreeSpace":
        """Return this space less the cells that people or the robot would meet `solids` in."""
        free = self.free.copy()
        for solid in solids:
            if solid.blocks_people or solid.bottom < 0.4:
                self._take(free, solid)
        return FreeSpace(free, self.resolution, self.origin)

    def _take(self, free: Cells, solid: Solid) -> None:
        reach = float(np.hypot(solid.half_length, solid.half_width)) + solid.radius + self.resolution
        (row0, row1), (col0, col1) = self.index(
            np.array([(solid.x - reach, solid.y - reach), (solid.x + reach, solid.y + reach)])
        )
        rows, cols = np.mgrid[row0 : row1 + 1, col0 : col1 + 1]
        centres = (np.stack((cols, rows), axis=-1) + 0.5) * self.resolution + np.asarray(self.origin)
        free[row0 : row1 + 1, col0 : col1 + 1] &= solid.distance(centres) > 0.5 * self.resolution


def merged_boxes(cells: Cells, resolution: float, origin: tuple[float, float], kind: str = "wall") -> list[Solid]:
    """Return boxes that cover exactly the true `cells` (rows, cols) without overlapping.

    Greedy: from each cell that is left, in reading order, the widest run to the right, then as many equal rows above.
    """
    left = cells.copy()
    solids = []
    for row, col in zip(*np.nonzero(cells), strict=True):
        if not left[row, col]:
            continue
        run = left[row, col:]
        width = int(np.argmin(run)) if not run.all() else len(run)
        height = 1
        while row + height < len(left) and left[row + height, col : col + width].all():
            height += 1
        left[row : row + height, col : col + width] = False
        low = (origin[0] + col * resolution, origin[1] + row * resolution)
        solids.append(box(kind, low, (low[0] + width * resolution, low[1] + height * resolution)))
    return solids


def regions(free: Cells) -> NDArray[np.int64]:
    """Return (rows, cols) the number, from 1 on, of the connected region that each free cell is in; 0: not free."""
    found = np.zeros(free.shape, dtype=np.int64)
    ndimage.label(free, np.ones((3, 3)), output=found)
    return found


def walls_around(free: Cells, thickness: int) -> Cells:
    """Return (rows, cols) the cells that are not `free` and at most `thickness` cells from one that is."""
    square = np.ones((3, 3), dtype=bool)
    return np.asarray(ndimage.binary_dilation(free, square, iterations=thickness), dtype=bool) & ~free
