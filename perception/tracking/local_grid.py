"""Where non-human things stand around the robot, in the odometry frame (Ye 2021, section II.A).

A cell is *free* unless non-human points have stayed on it: evidence rises while they do and fades when they go. Only
the cells hit are touched; they live in a ring buffer of `SIDE` x `SIDE` cells around the robot, each with the cell
number it stands for, so the robot may drive on for ever. The ring is cut into pages, and only those that a scan has
touched are there: walls are lines, so that an office fills a seventh of them.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel, kernel

Array = NDArray[np.float64]

SIDE = 512
"""Cells along a side of the ring buffer, a power of two."""
OCCUPIED = 0.5
CELL = np.dtype([("x", np.uint16), ("y", np.uint16), ("evidence", np.float32), ("time_s", np.float64)])
"""A cell in sixteen bytes, so that a visit waits for memory once: which of the blocks of `SIDE` cells it lies in (they
come again after 65,536 blocks, when the evidence is long gone), its evidence, 0 for none, and when it was last hit."""
_BITS, _INSIDE, _BLOCKS = 9, SIDE - 1, 65535
_PAGE_BITS, _IN_PAGE, _PAGE = 3, 7, 64
_ACROSS = SIDE >> _PAGE_BITS
PAGES = 768
"""Room for pages at first, of 4096 in all: an office takes 400 to 770."""


class Cells(NamedTuple):
    """The cells of w grids; `cells_of` has one of them, without the first axis, as kernels take it.

    Attributes:
        pages: (w, 64 * 64 + 1) where in `cells` each page of 8 x 8 cells lies, in pages; 0, where nothing ever is, for
            those that are not there. The last says how many are.
        cells: (w, 64 * room) of `CELL`.
    """

    pages: NDArray[np.uint16]
    cells: NDArray[Any]


def no_cells(grids: int, room: int = PAGES) -> Cells:
    """Return grids that are free everywhere, with room for so many pages each."""
    return Cells(np.zeros((grids, _ACROSS * _ACROSS + 1), np.uint16), np.zeros((grids, room * _PAGE), CELL))


def with_more_pages(cells: Cells) -> Cells:
    """Return the same with an eighth more room: thousands of grids grow at once, where one of them is full."""
    before = cells.cells.shape[1]
    grown = np.zeros((len(cells.cells), before + _PAGE * (1 + before // (8 * _PAGE))), CELL)
    grown[:, :before] = cells.cells
    return cells._replace(cells=grown)


class LocalGrid:
    """Evidence of non-human things a cell.

    Args:
        resolution: Side of a cell [m]; the grid covers `SIDE / 2` cells around the robot.
        rise_s: Time under points until a cell's evidence is full [s].
        fade_s: Time constant with which evidence fades [s].
    """

    def __init__(self, resolution: float, rise_s: float, fade_s: float) -> None:
        self._resolution, self._rise_s, self._fade_s = resolution, rise_s, fade_s
        self._all = no_cells(1)

    def mark(self, points: Array, centre: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of non-human `points` (k, 2) seen at `time_s` from `centre` (2,), in the odometry frame."""
        while not make_pages(cells_of(self._all, 0), points, centre, self._resolution):
            self._all = with_more_pages(self._all)
        cells = cells_of(self._all, 0)
        mark(cells, points, centre, self._resolution, time_s, dt / self._rise_s, self._fade_s)

    def is_free(self, points: Array, time_s: float) -> NDArray[np.bool_]:
        """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free at `time_s`."""
        return are_free(cells_of(self._all, 0), points, self._resolution, time_s, self._fade_s)


@kernel
def cells_of(cells: Any, w: int) -> Any:
    """Return the cells of grid w."""
    return Cells(cells.pages[w], cells.cells[w])


@kernel
def free_all(cells: Any) -> None:
    """Let all cells be free."""
    for i in range(_PAGE * (cells.pages[-1] + 1)):
        cells.cells[i].evidence = 0.0
    cells.pages[:] = 0


@inner_kernel
def _page_of(x: int, y: int) -> int:
    """Return the number of the page of cell (x, y)."""
    return ((x & _INSIDE) >> _PAGE_BITS) * _ACROSS + ((y & _INSIDE) >> _PAGE_BITS)


@inner_kernel
def _place_of(cells: Any, x: int, y: int) -> int:
    """Return where in memory cell (x, y) is."""
    return int(cells.pages[_page_of(x, y)]) * _PAGE + ((x & _IN_PAGE) << _PAGE_BITS) + (y & _IN_PAGE)


@inner_kernel
def _within(points: Any, k: int, centre: Any, resolution: float) -> bool:
    """Return whether the ring buffer around `centre` (2,) has the cell of `points` (n, 2), row k."""
    reach = (SIDE // 2 - 2) * resolution
    return max(abs(points[k, 0] - centre[0]), abs(points[k, 1] - centre[1])) < reach


@kernel
def make_pages(cells: Any, points: Any, centre: Any, resolution: float) -> bool:
    """Make the pages that `mark` needs for any of `points` (k, 2); return whether there was room for them."""
    pages, room = cells.pages, len(cells.cells) // _PAGE
    for k in range(len(points)):
        if _within(points, k, centre, resolution):
            page = _page_of(int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution)))
            if pages[page] == 0:
                if pages[-1] + 1 >= room:
                    return False
                pages[-1] += 1
                pages[page] = pages[-1]
    return True


@kernel
def mark(cells: Any, points: Any, centre: Any, resolution: float, now: float, rise: float, fade_s: float) -> None:
    """Let the evidence of the `cells` under `points` (k, 2) `rise`, see `LocalGrid.mark`; they have their pages."""
    last, fading = now, 1.0  # most cells were hit in the same scan before
    for k in range(len(points)):
        if not _within(points, k, centre, resolution):
            continue
        x, y = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        cell = cells.cells[_place_of(cells, x, y)]
        block_x, block_y = np.uint16((x >> _BITS) & _BLOCKS), np.uint16((y >> _BITS) & _BLOCKS)
        if cell.x != block_x or cell.y != block_y:
            cell.x, cell.y = block_x, block_y
            cell.evidence = 0.0
        elif cell.evidence > 0.0:
            if cell.time_s == now:
                continue
            if cell.time_s != last:
                last = cell.time_s
                fading = np.exp((last - now) / fade_s)
        cell.evidence = min(1.0, cell.evidence * fading + rise) if cell.evidence > 0.0 else min(1.0, rise)
        cell.time_s = now


@kernel
def are_free(cells: Any, points: Any, resolution: float, now: float, fade_s: float) -> Any:
    """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free, see `LocalGrid.is_free`."""
    free = np.ones(len(points), np.bool_)
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                cell = cells.cells[_place_of(cells, x, y)]
                if cell.evidence < OCCUPIED:
                    continue
                here = cell.x == (x >> _BITS) & _BLOCKS and cell.y == (y >> _BITS) & _BLOCKS
                if here and cell.evidence * np.exp((cell.time_s - now) / fade_s) >= OCCUPIED:
                    free[k] = False
    return free
