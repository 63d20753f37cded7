"""What is known of people in one frame, whoever finds them."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from .frame import RgbdFrame
from .planes import Planes

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RgbdPeople:
    """n people of one frame.

    Attributes:
        positions: (n, 2) centres, robot frame [m].
        likelihood: (n,) calibrated probability that it is somebody, in [0, 1].
        label: (h, w) int32 row of the person whom each pixel of `Planes.frame` belongs to, -1 for nobody.
        floor_known: Whether the floor was, by this frame or before; else heights, and with them people, are guesses.
    """

    positions: Array
    likelihood: Array
    label: NDArray[np.int32]
    floor_known: bool = True

    def __len__(self) -> int:
        return len(self.likelihood)


def nobody(height: int, width: int) -> RgbdPeople:
    """Return that there is nobody in a frame of this size [pixels]."""
    return RgbdPeople(np.zeros((0, 2)), np.zeros(0), np.full((height, width), -1, dtype=np.int32))


class RgbdPeopleFinder(Protocol):
    """Finds people in frames."""

    def find(self, frame: RgbdFrame, planes: Planes) -> RgbdPeople:
        """Return the people in `frame`, whose planes are known; their pixels are those of `planes.frame`."""
        ...


class NoPeopleFinder:
    """Finds nobody: planes and laser alone."""

    def find(self, frame: RgbdFrame, planes: Planes) -> RgbdPeople:
        """Return nobody."""
        return nobody(*planes.surface.shape)
