"""Where a picture of depth really ends: at its sides and its upper edge cameras may measure nothing."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

WIDEST = 0.125
"""A margin is no wider than this, as a share of the picture: what is farther inside and measures nothing is too far off
or too dark. Registered to colour, depth of the Kinect and the Xtion leaves 0.09 of the rows blank."""
EDGE = 2
"""What has a pixel in so many uppermost rows is cut by the picture's edge."""


class Margins(NamedTuple):
    """The part of a picture in which depth is measured.

    Attributes:
        top: Its first row.
        left: Its first column.
        right: The column after its last one.
    """

    top: int
    left: int
    right: int

    @property
    def edge(self) -> int:
        """The row after those that the upper edge cuts."""
        return self.top + EDGE


def margins(depth: NDArray[np.float32]) -> Margins:
    """Return where `depth` (h, w), NaN where nothing was measured [m], begins and ends."""
    measured = np.isfinite(depth)
    rows, columns = measured.any(axis=1), measured.any(axis=0)
    top, left, right = int(np.argmax(rows)), int(np.argmax(columns)), int(np.argmax(np.flip(columns)))
    down, across = (int(WIDEST * size) for size in depth.shape)
    return Margins(min(top, down), min(left, across), depth.shape[1] - min(right, across))
