"""Where the robot may be, as it is told."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlaceBelief:
    """Where the robot may be.

    Attributes:
        poses: (k, 3) T_map_robot now, distinct, the likeliest first.
        log_ratios: (k,) logarithm of each one's likelihood over the first's, 0 and below.
        explained: (k,) share of the beams that end at walls of the map.
        sure: Whether the first stands out.
    """

    poses: Array
    log_ratios: Array
    explained: Array
    sure: bool

    @property
    def ratio(self) -> float:
        """How many times likelier the best hypothesis is than the best rival; 0 without any, `inf` without a rival."""
        if not len(self.poses):
            return 0.0
        return float(np.exp(min(-self.log_ratios[1], 700.0))) if len(self.poses) > 1 else float("inf")
