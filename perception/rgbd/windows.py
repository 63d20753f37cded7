"""Pictures of candidates, all of one size: brightness, relative depth and outline of each.

A window is a part of an upright plane through the candidate, that faces the camera: however the camera is tilted,
people stand upright in it and have their size. One of legs alone shows the lower half of a body, twice as large.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .heads import HIPS, Candidates
from .planes import Planes

Array = NDArray[np.float64]

CHANNELS, ROWS, COLUMNS = 3, 64, 32
"""Size of a picture [pixels]; it shows a person with a margin of 0.1 m, and half as much width as height."""
_MARGIN = 0.1
_USUAL = 2.0 * HIPS
"""Height of somebody whose head is above the picture [m]."""
_UPPER = 0.8
_THICK = 0.4
_LUMA = np.array([0.299, 0.587, 0.114], dtype=np.float32)


def candidate_windows(planes: Planes, candidates: Candidates) -> NDArray[np.float32]:
    """Return (n, CHANNELS, ROWS, COLUMNS): brightness in [0, 1]; depth before and behind the candidate, in [-1, 1]; its
    own pixels, 1, among all others, 0.

    All others are as bright as the candidate is on average: what is beside and behind it says nothing about it. Where
    nothing was measured, which is at edges, the depth counts as the background's.
    """
    frame, mount = planes.frame, planes.mount
    luma = (frame.colour @ _LUMA) / np.float32(255.0)
    ahead = planes.points[..., 0]
    windows = np.empty((len(candidates), CHANNELS, ROWS, COLUMNS), dtype=np.float32)
    projection = np.array([*frame.camera.focal, *frame.camera.axis])
    for k in range(len(candidates)):
        mine = candidates.label == k
        of = planes.points[mine]
        away, top = float(np.median(of[:, 0])), float(candidates.heads[k, 2])
        upper = of[of[:, 2] > top - _UPPER]
        middle = _middle(upper[:, 1] / upper[:, 0]) * away
        if candidates.legs[k]:
            top = HIPS
        elif candidates.cut[k]:
            top = max(top, _USUAL)
        scale = (top + 2.0 * _MARGIN) / ROWS
        corner = np.array([away, middle + COLUMNS * scale / 2.0, top + _MARGIN - mount.height])
        _sample(luma, ahead, mine, mount.R_level_camera, projection, corner, scale, windows[k])
    own = windows[:, 2]
    mean = (windows[:, 0] * own).sum(axis=(1, 2)) / np.maximum(own.sum(axis=(1, 2)), 1e-6)
    windows[:, 0] = own * windows[:, 0] + (1.0 - own) * mean[:, None, None]
    return windows


def _middle(across: Array) -> float:
    """Return the middle of what `across` (n,) covers, however many points there are at each place."""
    cells = np.unique(np.round(across, 2))
    return float(cells.mean())


@kernel
def _sample(luma, ahead, mine, R_level_camera, projection, corner, scale, window):
    """Write the channels of a window, its upper left `corner` (3,) in the level frame, less the camera's height [m].

    Each cell of `scale` x `scale` [m] takes the bilinear mean of the four pixels around its place in the picture, whose
    focal lengths and axis are the `projection` (4,).
    """
    height, width = luma.shape
    for i in range(ROWS):
        for j in range(COLUMNS):
            x, y, z = corner[0], corner[1] - (j + 0.5) * scale, corner[2] - (i + 0.5) * scale
            forward = R_level_camera[0, 0] * x + R_level_camera[1, 0] * y + R_level_camera[2, 0] * z
            left = R_level_camera[0, 1] * x + R_level_camera[1, 1] * y + R_level_camera[2, 1] * z
            up = R_level_camera[0, 2] * x + R_level_camera[1, 2] * y + R_level_camera[2, 2] * z
            forward = max(forward, 0.05)
            across = projection[2] - 0.5 - projection[0] * left / forward
            down = projection[3] - 0.5 - projection[1] * up / forward
            across, down = min(max(across, 0.0), width - 1.001), min(max(down, 0.0), height - 1.001)
            row, fy, col, fx = int(down), down - int(down), int(across), across - int(across)
            bright, apart, own = 0.0, 0.0, 0.0
            for r in range(2):
                for c in range(2):
                    share = (fy if r else 1.0 - fy) * (fx if c else 1.0 - fx)
                    bright += share * luma[row + r, col + c]
                    behind = (ahead[row + r, col + c] - corner[0]) / _THICK
                    apart += share * (min(max(behind, -1.0), 1.0) if np.isfinite(behind) else 1.0)
                    own += share * mine[row + r, col + c]
            window[0, i, j], window[1, i, j], window[2, i, j] = bright, apart, own
