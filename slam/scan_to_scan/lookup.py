"""The lookup table around a reference scan's points (Lenac, Mumolo, Nolich 2011; Cuzzocrea et al. 2022, Fig. 2)."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from ..bounds import Within, check_numbers, check_size
from ..errors import InputError
from ..search.score_pyramid import ScoreGrid
from ..view_kernel import kernel

_MOST_CELLS = 20_000_000  # of a table: one that reaches 200 m at 10 cm, five pyramids of it are 100 MB


@dataclass(frozen=True, kw_only=True)
class LookupConfig:
    """What the paper leaves open about its tables; one set for all matchers.

    Attributes:
        pattern: "gaussian": 8 bits, radial (GLASM-g); "square": 0 or 1 (GLASM).
        cell: Side of a cell [m].
        sigma: Standard deviation of the Gaussian [m].
        radius: Radius of the Gaussian pattern [m].
        half_side: Half the side of the square pattern [m].
    """

    pattern: Literal["gaussian", "square"] = "gaussian"
    cell: Annotated[float, Within(0.01, 100.0)] = 0.1
    sigma: Annotated[float, Within(1e-3, 100.0)] = 0.2
    radius: Annotated[float, Within(1e-3, 10.0)] = 0.6
    half_side: Annotated[float, Within(1e-3, 10.0)] = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.pattern not in ("gaussian", "square"):
            raise InputError(f'`pattern` must be "gaussian" or "square", got {self.pattern!r}')
        if not min(self.cell, self.sigma, self.radius, self.half_side) > 0.0:
            raise InputError(f"all lengths of LookupConfig must be positive [m], got {self}")


def build_lookup(points: NDArray[np.float64], config: LookupConfig) -> ScoreGrid:
    """Return the table around `points` (M, 2), in their frame: each cell the highest of the patterns that cover it.

    A pattern is centred on its point, and a cell takes its value at the cell's centre. No points: one empty cell.
    """
    square = config.pattern == "square"
    reach = config.half_side if square else config.radius
    if len(points) == 0:
        return ScoreGrid(np.zeros((1, 1), dtype=np.uint8), (0.0, 0.0), config.cell)
    low = np.floor((points.min(axis=0) - reach) / config.cell) - 1.0
    high = np.ceil((points.max(axis=0) + reach) / config.cell) + 1.0
    cols, rows = (high - low).tolist()
    check_size(cols, rows, config.cell, _MOST_CELLS, "the table of a scan")
    cols, rows = int(cols), int(rows)
    values = np.zeros((rows, cols), dtype=np.uint8)
    origin = (float(low[0] * config.cell), float(low[1] * config.cell))
    if square:
        stamp_squares(points, origin[0], origin[1], config.cell, reach, values)
    else:
        stamp_gaussians(points, origin[0], origin[1], config.cell, config.sigma, reach, values)
    return ScoreGrid(values, origin, config.cell)


@kernel
def stamp_squares(points, x0, y0, cell, reach, values):  # pragma: no cover
    """Set to 255 the cells whose centre is within `reach` of a point in x and in y."""
    for n in range(len(points)):
        px, py = points[n, 0] - x0, points[n, 1] - y0
        for row in range(int(np.ceil((py - reach) / cell - 0.5)), int(np.floor((py + reach) / cell - 0.5)) + 1):
            for col in range(int(np.ceil((px - reach) / cell - 0.5)), int(np.floor((px + reach) / cell - 0.5)) + 1):
                values[row, col] = 255


@kernel
def stamp_gaussians(points, x0, y0, cell, sigma, reach, values):  # pragma: no cover
    """Raise the cells around each point to 255 exp(-d^2 / 2 sigma^2), rounded; d from its centre, to `reach`."""
    # The Gaussian is the product of its rows and columns: two short lists of exponentials a point.
    size = int(2.0 * reach / cell) + 3
    along = np.empty(size)
    for n in range(len(points)):
        px, py = points[n, 0] - x0, points[n, 1] - y0
        first = int(np.ceil((px - reach) / cell - 0.5))
        last = int(np.floor((px + reach) / cell - 0.5))
        for col in range(first, last + 1):
            dx = (col + 0.5) * cell - px
            along[col - first] = 255.0 * np.exp(-0.5 * dx * dx / (sigma * sigma))
        for row in range(int(np.ceil((py - reach) / cell - 0.5)), int(np.floor((py + reach) / cell - 0.5)) + 1):
            dy = (row + 0.5) * cell - py
            across, left = np.exp(-0.5 * dy * dy / (sigma * sigma)), reach * reach - dy * dy
            for col in range(first, last + 1):
                dx = (col + 0.5) * cell - px
                if dx * dx <= left:
                    values[row, col] = max(values[row, col], np.uint8(along[col - first] * across + 0.5))
