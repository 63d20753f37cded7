"""The way over scans at which the odometry stood still, once it has caught up with the robot in one step.

It tells where all of them led, and not how. Either the robot went evenly, or as the scans seemed to show while they
waited, but for what is missing of the whole way: along a corridor they show nothing, and one that fitted elsewhere
shows too much. So each of these scans has both predictions, and tells which of them holds.
"""

import math
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ..geometry import compose, first_of_way
from ..scan_to_grid.extrapolator import Prediction

Array = NDArray[np.float64]

Bridge = list[tuple[float, Prediction]]
"""How the robot may have gone to the next of some scans, (3,) since the one before, each with its probability."""


def bridge_over(whole: Array, steps: Array, usual: Array, rough: Array) -> Bridge:
    """Return how the robot may have gone to the next of some scans: evenly, or as they seemed to show.

    It may have stood for some of them, and gone twice as fast in others. What they seemed to show is the less likely,
    the farther it leads from where the odometry does.

    Args:
        whole: (3,) how the robot went to the last of them, by the odometry.
        steps: (n, 3) how it seemed to go from each to the next.
        usual: (2,) a usual step [m, rad].
        rough: (2,) standard deviations of the odometry over the whole way [m, rad].
    """
    end = Prediction(reduce(compose, steps), np.hypot(rough, usual))
    shown = 1.0 / (1.0 + math.exp(0.5 * min(end.squared_distance(whole), 1000.0)))
    ways = first_of_way(np.zeros_like(steps), whole), first_of_way(steps, whole)
    sigmas = (np.hypot((math.hypot(way[0], way[1]), abs(way[2])), usual) for way in ways)
    return list(zip((1.0 - shown, shown), map(Prediction, ways, sigmas), strict=True))
