"""How far off what odometry alone tells may be."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIGMAS = 3.0  # standard deviations within which something is looked for
# With one in a thousand, pieces were laid into the next equal room: see docs/methods/graph-slam.md.
_FAULTY = 1e-6  # share of ways without a scan to tell of them of which odometry told nothing true


@dataclass(frozen=True, slots=True)
class Slack:
    """How far off a pose by odometry may be, standard deviations.

    Attributes:
        linear: [m].
        angular: [rad].
    """

    linear: float = 0.0
    angular: float = 0.0

    def __add__(self, other: "Slack") -> "Slack":
        """Return how far off a pose over two such ways may be, whose errors are independent."""
        return Slack(math.hypot(self.linear, other.linear), math.hypot(self.angular, other.angular))

    def after(self, way: Array) -> "Slack":
        """Return how far off a pose is that hangs by a `way` (3,) on one that is so far off."""
        aside = math.hypot(way[0], way[1]) * min(self.angular, 1.0)
        return Slack(math.hypot(self.linear, aside), self.angular)

    def cost(self, off: Array) -> float:
        """Return the negative log-likelihood of being `off` (3,) [m, m, rad]; drift without slack costs nothing."""
        if not self.angular:
            return 0.0
        x, y, turn = off.tolist()
        squared = (x * x + y * y) / self.linear**2 + (turn / self.angular) ** 2
        return -math.log(_FAULTY + (1.0 - _FAULTY) * math.exp(-0.5 * squared))
