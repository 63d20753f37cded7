"""A scan as a node of the pose graph."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...scan import LaserScan
from ...scan_to_grid.extrapolator import Prediction

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Node:
    """A scan of the graph.

    Attributes:
        pose_local: (3,) T_local_robot [m, m, rad].
        points: (N, 2) thinned returns, robot frame [m].
        submaps: The submaps that it stands in.
        motion: By the odometry from the node before to this one.
        scan: The whole scan.
    """

    pose_local: Array
    points: Array
    submaps: tuple[int, ...]
    motion: Prediction
    scan: LaserScan
