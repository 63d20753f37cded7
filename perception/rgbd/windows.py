"""Pictures of candidates, all of one size: brightness, relative depth and outline of each."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .frame import RgbdFrame
from .heads import Candidates

Array = NDArray[np.float64]

CHANNELS, ROWS, COLUMNS = 3, 64, 32
"""Size of a picture [pixels]; it shows a person with a margin of 0.1 m, and half as much width as height."""
_MARGIN = 0.1
_USUAL = 1.72
"""Height of somebody whose head is above the picture [m]."""
_THICK = 0.4
_LUMA = np.array([0.299, 0.587, 0.114], dtype=np.float32)


def candidate_windows(frame: RgbdFrame, candidates: Candidates) -> NDArray[np.float32]:
    """Return (n, CHANNELS, ROWS, COLUMNS): brightness in [0, 1]; depth before and behind the candidate, in [-1, 1]; its
    own pixels, 1, among all others, 0.

    All others are as bright as the candidate is on average: what is beside and behind it says nothing about it. Where
    nothing was measured, which is at edges, the depth counts as the background's.
    """
    down = frame.camera.focal[1]
    luma = (frame.colour @ _LUMA) / np.float32(255.0)
    windows = np.empty((len(candidates), CHANNELS, ROWS, COLUMNS), dtype=np.float32)
    for k in range(len(candidates)):
        row, col = candidates.pixels[k]
        mine = candidates.label == k
        depth = float(np.median(frame.depth[mine]))
        upper = mine.copy()
        upper[row + int(0.8 * down / depth) + 1 :] = False
        middle = float(np.flatnonzero(upper.any(axis=0)).mean()) if upper.any() else float(col)
        height = float(candidates.heads[k, 2])
        top = row - (_USUAL - height) * down / depth if row < 2 and height < _USUAL else float(row)
        height = max(height, _USUAL) if row < 2 else height
        scale = (height + 2.0 * _MARGIN) * down / depth / ROWS
        corner = (top - _MARGIN * down / depth, middle - COLUMNS * scale / 2.0)
        _sample(luma, frame.depth, mine, depth, corner[0], corner[1], scale, windows[k])
    own = windows[:, 2]
    mean = (windows[:, 0] * own).sum(axis=(1, 2)) / np.maximum(own.sum(axis=(1, 2)), 1e-6)
    windows[:, 0] = own * windows[:, 0] + (1.0 - own) * mean[:, None, None]
    return windows


@njit(cache=True, nogil=True)
def _sample(luma, depth, mine, middle, top, left, scale, window):
    """Write the channels of a window with its corner at (top, left), by bilinear interpolation."""
    height, width = luma.shape
    for i in range(ROWS):
        y = min(max(top + (i + 0.5) * scale, 0.0), height - 1.001)
        row, fy = int(y), y - int(y)
        for j in range(COLUMNS):
            x = min(max(left + (j + 0.5) * scale, 0.0), width - 1.001)
            col, fx = int(x), x - int(x)
            bright, apart, own = 0.0, 0.0, 0.0
            for r in range(2):
                for c in range(2):
                    share = (fy if r else 1.0 - fy) * (fx if c else 1.0 - fx)
                    bright += share * luma[row + r, col + c]
                    away = (depth[row + r, col + c] - middle) / _THICK
                    apart += share * (min(max(away, -1.0), 1.0) if np.isfinite(away) else 1.0)
                    own += share * mine[row + r, col + c]
            window[0, i, j], window[1, i, j], window[2, i, j] = bright, apart, own
