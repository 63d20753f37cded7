"""Where non-human things stand around the robot, in the odometry frame (Ye 2021, section II.A).

A cell remembers for how long it has been hit, and forgets it when nothing has hit it for a while. Only the cells hit
are touched; they live in a ring buffer of `SIDE` x `SIDE` cells around the robot, each with the cell number it stands
for, so the robot may drive on for ever. The ring is cut into pages, and only those that a scan has touched lately are
there: walls are lines, so that an office fills a seventh of them.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel, kernel

Array = NDArray[np.float64]

SIDE = 512
"""Cells along a side of the ring buffer, a power of two."""
CELL = np.dtype([("x", np.uint16), ("y", np.uint16), ("stood_s", np.float32), ("time_s", np.float64)])
"""A cell in sixteen bytes, so that a visit waits for memory once: which of the blocks of `SIDE` cells it lies in (they
come again after 65,536 blocks, when it is long forgotten), for how long it was hit, 0 if never, and when last [s]."""
_BITS, _INSIDE, _BLOCKS = 9, SIDE - 1, 65535
_PAGE_BITS, _IN_PAGE, _PAGE = 3, 7, 64
_ACROSS = SIDE >> _PAGE_BITS
PAGES = 768
"""Room for pages at first, of 4096 in all: an office takes 400 to 770."""
_CROWDED = 0.875
"""Of the room: where more of the pages hold what is remembered, the next scans would lack room again."""


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
    """Where non-human things stand, cell by cell.

    Args:
        resolution: Side of a cell [m]; the grid covers `SIDE / 2` cells around the robot.
        still_s: What was hit for so long stands still [s].
        forget_s: What was not hit for so long is forgotten [s].
    """

    def __init__(self, resolution: float, still_s: float, forget_s: float) -> None:
        self._resolution, self._still_s, self._forget_s = resolution, still_s, forget_s
        self._all = no_cells(1)

    def mark(self, points: Array, centre: Array, time_s: float, dt: float) -> None:
        """Add `dt` seconds of non-human `points` (k, 2) seen at `time_s` from `centre` (2,), in the odometry frame."""
        while not make_pages(cells_of(self._all, 0), points, centre, self._resolution, time_s, self._forget_s):
            self._all = with_more_pages(self._all)
        mark(cells_of(self._all, 0), points, centre, self._resolution, time_s, dt, self._forget_s)

    def is_free(self, points: Array, time_s: float) -> NDArray[np.bool_]:
        """Return (n,) whether the cells of `points` (n, 2) and the eight around each are free at `time_s`."""
        return stood_for(cells_of(self._all, 0), points, self._resolution, time_s, self._forget_s) < self._still_s


@kernel
def cells_of(cells: Any, w: int) -> Any:
    """Return the cells of grid w."""
    return Cells(cells.pages[w], cells.cells[w])


@kernel
def free_all(cells: Any) -> None:
    """Let all cells be free."""
    for i in range(_PAGE * (cells.pages[-1] + 1)):
        cells.cells[i].stood_s = 0.0
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
def make_pages(cells: Any, points: Any, centre: Any, resolution: float, now: float, forget_s: float) -> bool:
    """Make the pages that `mark` needs for any of `points` (k, 2); return whether there was room for them.

    Where there is none, pages of which everything is forgotten `now` [s] give way.
    """
    if _made(cells, points, centre, resolution):
        return True
    few = _drop_forgotten(cells, now, forget_s) <= _CROWDED * (len(cells.cells) // _PAGE)
    return few and _made(cells, points, centre, resolution)


@inner_kernel
def _made(cells: Any, points: Any, centre: Any, resolution: float) -> bool:
    """Make pages as `make_pages`, as far as there is room."""
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


@inner_kernel
def _drop_forgotten(cells: Any, now: float, forget_s: float) -> int:
    """Drop the pages of which everything is forgotten, and move the others together; return how many those are."""
    pages, before, kept = cells.pages, int(cells.pages[-1]), 0
    owners = np.zeros(before + 1, np.int64)
    for page in range(_ACROSS * _ACROSS):
        owners[pages[page]] = page
    for k in range(1, before + 1):
        remembered = False
        for i in range(_PAGE * k, _PAGE * (k + 1)):
            cell = cells.cells[i]
            remembered |= cell.stood_s > 0.0 and now - cell.time_s <= forget_s
        kept += remembered
        pages[owners[k]] = kept if remembered else 0
        if remembered and kept < k:
            cells.cells[_PAGE * kept : _PAGE * (kept + 1)] = cells.cells[_PAGE * k : _PAGE * (k + 1)]
    for i in range(_PAGE * (kept + 1), _PAGE * (before + 1)):
        cells.cells[i].stood_s = 0.0
    pages[-1] = kept
    return kept


@kernel
def mark(cells: Any, points: Any, centre: Any, resolution: float, now: float, dt: float, forget_s: float) -> None:
    """Let the `cells` under `points` (k, 2) have been hit for `dt` [s] more, see `LocalGrid.mark`.

    They have their pages.
    """
    for k in range(len(points)):
        if not _within(points, k, centre, resolution):
            continue
        x, y = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        cell = cells.cells[_place_of(cells, x, y)]
        block_x, block_y = np.uint16((x >> _BITS) & _BLOCKS), np.uint16((y >> _BITS) & _BLOCKS)
        if cell.x != block_x or cell.y != block_y or now - cell.time_s > forget_s:
            cell.x, cell.y, cell.stood_s = block_x, block_y, 0.0
        elif cell.time_s == now and cell.stood_s > 0.0:
            continue
        cell.stood_s += dt
        cell.time_s = now


@kernel
def clear(cells: Any, points: Any, resolution: float) -> None:
    """Forget what stood in the nine cells at and around each of `points` (n, 2)."""
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                cells.cells[_place_of(cells, x, y)].stood_s = 0.0


@kernel
def stood_for(cells: Any, points: Any, resolution: float, now: float, forget_s: float) -> Any:
    """Return (n,) for how long one of the nine cells at and around each of `points` (n, 2) has been hit [s]."""
    stood = np.zeros(len(points))
    for k in range(len(points)):
        i, j = int(np.floor(points[k, 0] / resolution)), int(np.floor(points[k, 1] / resolution))
        for x in range(i - 1, i + 2):
            for y in range(j - 1, j + 2):
                cell = cells.cells[_place_of(cells, x, y)]
                if cell.stood_s <= stood[k] or now - cell.time_s > forget_s:
                    continue
                if cell.x == (x >> _BITS) & _BLOCKS and cell.y == (y >> _BITS) & _BLOCKS:
                    stood[k] = cell.stood_s
    return stood
