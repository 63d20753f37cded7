"""Notices that local matching has failed: the scan contradicts the submap it should fit on.

A low score alone says little: a robot that comes into a new room sees walls that no submap has. But a beam that goes
through a wall, or ends where others saw free space, says that the pose is wrong (or that people are about).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..view_kernel import kernel
from .submap import Submap
from .submap_kernels import beams, passes_wall

Array = NDArray[np.float64]

_MEMORY = 0.05  # share of the newest score in the usual one
_TRACE = 0.15  # occupancy from which a cell near the end of a beam explains it
_NEAR = 3  # cells around an end that are looked at


@dataclass(frozen=True, kw_only=True)
class MatchMonitorConfig:
    """Settings of `MatchMonitor`.

    Attributes:
        poor: A scan is rejected if its score is below so much of the usual one ...
        contradicted: ... and more than this share of its beams contradicts the submap.
        slack: A wall must stand so far before the end of a beam to contradict it [m].
        patience: After so many rejected scans in a row it is doubtful where the robot is ...
        most: ... and after so many the submap is given up.
    """

    poor: float = 0.75
    contradicted: float = 0.1
    slack: float = 0.4
    patience: int = 3
    most: int = 10

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not np.all(np.asarray(value) > 0):
                raise InputError(f"`{name}` must be positive, got {value}")


class MatchMonitor:
    """Judges matches of local SLAM by the submap that they were made on, before the scan is drawn there.

    Args:
        config: Settings.

    Attributes:
        rejected: How many scans in a row were rejected.
    """

    def __init__(self, config: MatchMonitorConfig) -> None:
        self._config = config
        self._usual = 0.0  # score
        self.rejected = 0

    @property
    def alarmed(self) -> bool:
        """Whether so many scans in a row were rejected that it is doubtful where the robot is."""
        return self.rejected >= self._config.patience

    @property
    def worn_out(self) -> bool:
        """Whether so many scans in a row were rejected that the submap can hardly be right."""
        return self.rejected >= self._config.most

    def doubt(self) -> None:
        """Reject a scan that may as well be elsewhere."""
        self.rejected += 1

    def alarm(self) -> None:
        """Say that it is doubtful where the robot is: the odometry alone has led there."""
        self.rejected = max(self.rejected, self._config.patience)

    def restart(self) -> None:
        """Begin anew with another submap; what score is usual stays known."""
        self.rejected = 0

    def rejects(self, submap: Submap, points: Array, sensor: Array, pose: Array, score: float) -> bool:
        """Return whether a match is rejected, since it is poor and the scan contradicts the submap there.

        Args:
            submap: What the scan was matched on.
            points: (N, 2) its thinned returns, robot frame [m].
            sensor: (2,) place of the laser, robot frame [m].
            pose: (3,) T_local_robot of the match.
            score: Of the match.
        """
        config = self._config
        if score < config.poor * self._usual:
            place = submap.field, submap.visits, submap.corner, submap.resolution
            if contradictions(*place, sensor, points, pose, config.slack) > config.contradicted * len(points):
                self.rejected += 1
                return True
        self._usual = score if self._usual == 0.0 else self._usual + _MEMORY * (score - self._usual)
        self.rejected = 0
        return False


@kernel
def contradictions(
    field: NDArray[np.float32],
    visits: NDArray[np.float32],
    corner: Array,
    resolution: float,
    sensor: Array,
    points: Array,
    pose: Array,
    slack: float,
) -> int:
    """Return how many of the beams that end at `points` (N, 2) contradict a submap, the robot at `pose` (3,).

    A beam contradicts it that comes through a cell of a wall more than `slack` [m] before its end, or that ends in a
    cell that was seen before, without any trace of a wall in the cells around.
    """
    rows, cols = field.shape
    x0, y0, x, y = beams(points, sensor, pose, corner, resolution)
    count = 0
    for n in range(len(points)):
        contradicts = passes_wall(field, x0, y0, x[n], y[n], slack / resolution)
        i, j = int(np.floor(y[n])), int(np.floor(x[n]))
        if not contradicts and 0 <= i < rows and 0 <= j < cols and visits[i, j] > 0:
            around = field[max(i - _NEAR, 0) : i + _NEAR + 1, max(j - _NEAR, 0) : j + _NEAR + 1]
            contradicts = around.max() < _TRACE
        count += contradicts
    return count
