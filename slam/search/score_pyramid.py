"""A grid of scores and the coarser grids of maxima that bound it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..reused_memory import reused_array
from .lanes import LANES


@dataclass(frozen=True, eq=False)
class ScoreGrid:
    """What a scan point that falls into a cell is worth.

    Attributes:
        values: (rows, cols) uint8; 255 is worth 1. Row 0: lowest y. Outside of the grid a point is worth 0.
        origin: (x, y) of the outer corner of cell [0, 0] [m].
        resolution: Side of a cell [m].

    Raises:
        InputError: If the values are not a plane of uint8 or the resolution is not positive.
    """

    values: NDArray[np.uint8]
    origin: tuple[float, float]
    resolution: float

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or self.values.dtype != np.uint8 or self.values.size == 0:
            got = f"{self.values.dtype} {self.values.shape}"
            raise InputError(f"`values` must be a (rows, cols) array of uint8 (see from_likelihood), got {got}")
        if not self.resolution > 0.0:
            raise InputError(f"`resolution` must be positive [m], got {self.resolution}")

    @classmethod
    def from_likelihood(
        cls, likelihood: NDArray[np.floating], origin: tuple[float, float], resolution: float
    ) -> "ScoreGrid":
        """Return the grid of `likelihood` (rows, cols) in [0, 1], rounded to steps of 1/255; NaN (unknown) is 0."""
        values = np.rint(np.clip(np.nan_to_num(likelihood, nan=0.0), 0.0, 1.0) * 255.0)
        return cls(values.astype(np.uint8), origin, resolution)


@dataclass(frozen=True, eq=False)
class ScorePyramid:
    """A score grid, and for l = 1 .. L the maximum over the 2^l x 2^l cells that begin at each cell (Olson 2009).

    Made by `build_pyramid`; it can be searched any number of times.

    Attributes:
        levels: (L + 1, rows', cols') uint8, level 0 the scores themselves, with a border of zeros.
        phases: (S, S, ., .) uint8, S = 2^L: level L sorted by (row mod S, column mod S), so that blocks that are
            neighbours in the search lie side by side in memory.
        skirt: How many more rows and columns of zeros the phases have on each side (columns: 16 more at the end).
        border: Width of the border [cells].
        origin: (x, y) of the outer corner of the score grid's cell [0, 0] (not of the border) [m].
        resolution: Side of a cell [m].
    """

    levels: NDArray[np.uint8]
    phases: NDArray[np.uint8]
    skirt: int
    border: int
    origin: tuple[float, float]
    resolution: float

    @property
    def nbytes(self) -> int:
        """Bytes of memory."""
        return self.levels.nbytes + self.phases.nbytes


def build_pyramid(grid: ScoreGrid, *, top_level: int = 3, margin: int = 0) -> ScorePyramid:
    """Return the pyramid of a score grid.

    Args:
        grid: The scores.
        top_level: L; the search starts from blocks of 2^L cells, 0.4 to 0.8 m are usually fastest.
        margin: Half the side of the windows to come [cells]; changes no result, but where it is less the search takes
            ten times as long. The phases get so large that such a window around any cell can be read whole.

    Raises:
        InputError: If the top level is not in 0 .. 8 or the margin is negative.
    """
    if not 0 <= top_level <= 8 or margin < 0:
        raise InputError(f"need `top_level` in 0 .. 8 and `margin` >= 0, got {top_level} and {margin}")
    stride = 1 << top_level
    border = stride - 1
    rows, cols = (-(-(size + 2 * border) // stride) * stride for size in grid.values.shape)
    levels = reused_array((top_level + 1, rows, cols), np.uint8)
    levels[0] = 0
    levels[0, border : border + grid.values.shape[0], border : border + grid.values.shape[1]] = grid.values
    rowwise, room = levels.reshape(top_level + 1, -1), np.empty(rows * cols, np.uint8)
    for level in range(1, top_level + 1):
        # A row's last cells meet the next row's border, which is 0: so all rows are one.
        finer, coarser, half = rowwise[level - 1], rowwise[level], 1 << (level - 1)
        np.maximum(finer[: -half * cols], finer[half * cols :], out=room[: -half * cols])
        room[-half * cols :] = finer[-half * cols :]
        np.maximum(room[:-half], room[half:], out=coarser[:-half])
        coarser[-half:] = room[-half:]
    blocks = levels[top_level].reshape(rows // stride, stride, cols // stride, stride)
    # So much that a window that meets anything can be read whole, sixteen blocks of a row at once.
    skirt = -(-2 * margin // stride)
    around = rows // stride + 2 * skirt, cols // stride + 2 * skirt + LANES
    phases = reused_array((stride, stride, *around), np.uint8)
    phases.fill(0)
    phases[:, :, skirt : skirt + rows // stride, skirt : skirt + cols // stride] = blocks.transpose(1, 3, 0, 2)
    return ScorePyramid(levels, phases, skirt, border, grid.origin, grid.resolution)
