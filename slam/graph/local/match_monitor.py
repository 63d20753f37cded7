"""Notices that local matching has failed: the scan contradicts the submap it should fit on.

A low score alone says little: a robot that comes into a new room sees walls that no submap has. But a beam that goes
through a wall, or ends where others saw free space, says that the pose is wrong (or that people are about).
"""

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from ...bounds import check_numbers
from ...errors import InputError
from ...geometry import between, transform_points
from .submap import Submap

Array = NDArray[np.float64]

_MEMORY = 0.05  # share of the newest score in the usual one
_WALL = 0.5  # occupancy from which a cell stops a beam
_TRACE = 0.15  # occupancy from which a cell near the end of a beam explains it
_NEAR = 3  # cells around an end that are looked at


@dataclass(frozen=True, kw_only=True)
class MatchMonitorConfig:
    """Settings of `MatchMonitor`.

    Attributes:
        poor: A score below so much of the usual one makes it look closer ...
        contradicted: ... and if more than this share of the beams contradicts the submap, the scan is doubtful.
        settled_poor: Once in doubt, it stays so until the score is no longer below so much of the usual one ...
        settled_contradicted: ... or no more than this share of the beams contradicts the submap.
        plain_poor: As `poor`, for a scan that cannot belong there at all ...
        plain_contradicted: ... as `contradicted`.
        slack: A wall must stand so far before the end of a beam to contradict it [m].
        patience: After so many doubtful scans in a row something has to be done.
        nothing: A score below so much of the usual one, and no larger a share of the points where the submap was seen,
            say that the scan sees nothing of it [score, share].
        far: A match is far off that lies farther from where the odometry has the robot [m, rad].
        nothing_far: As `nothing`, of such a match: after a gap some place nearby fits by chance.
    """

    poor: float = 0.75
    contradicted: float = 0.1
    settled_poor: float = 0.9
    settled_contradicted: float = 0.05
    plain_poor: float = 0.6
    plain_contradicted: float = 0.2
    slack: float = 0.4
    patience: int = 3
    nothing: tuple[float, float] = (0.1, 0.3)
    far: tuple[float, float] = (0.25, 0.1)
    nothing_far: tuple[float, float] = (0.3, 0.45)

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not np.all(np.asarray(value) > 0):
                raise InputError(f"`{name}` must be positive, got {value}")


class MatchMonitor:
    """Judges matches of local SLAM by the submap that they were made on.

    Args:
        config: Settings.

    Attributes:
        in_doubt: How many scans in a row were doubtful.
    """

    def __init__(self, config: MatchMonitorConfig) -> None:
        self._config = config
        self._usual = 0.0
        self._pardoned = False
        self._plain = 0
        self.in_doubt = 0

    @property
    def alarmed(self) -> bool:
        """Whether so many scans in a row were doubtful that something has to be done."""
        return self.in_doubt >= self._config.patience

    @property
    def plainly_lost(self) -> bool:
        """Whether none of the doubtful scans can belong to the submap."""
        return self.alarmed and self._plain == self.in_doubt

    def restart(self) -> None:
        """Begin anew with another submap; what is usual stays."""
        self.in_doubt = self._plain = 0

    def pardon(self) -> None:
        """Nothing better is known than where the robot was thought to be: the next scan is believed."""
        self.in_doubt = self._plain = 0
        self._pardoned = True

    def far_off(self, predicted: Array, pose: Array) -> bool:
        """Return whether a match at `pose` (3,) lies far from where the odometry has `predicted` (3,) the robot."""
        off, most = between(predicted, pose), self._config.far
        return bool(np.hypot(off[0], off[1]) > most[0] or abs(off[2]) > most[1])

    def sees_nothing(self, submap: Submap, points: Array, predicted: Array, pose: Array, score: float) -> bool:
        """Return whether a scan lies beside all that a submap knows where it fits best.

        That match then says nothing: the odometry alone knows how the two lie to each other, if anything does.

        Args:
            submap: What the scan was matched on.
            points: (N, 2) its thinned returns, robot frame [m].
            predicted: (3,) T_local_robot by the odometry.
            pose: (3,) T_local_robot of the match.
            score: Of the match.
        """
        config = self._config
        if score >= max(config.nothing[0], config.nothing_far[0]) * self._usual:
            return False
        least, known = config.nothing_far if self.far_off(predicted, pose) else config.nothing
        if score >= least * self._usual:
            return False
        cells = np.floor((transform_points(pose, points) - submap.corner) / submap.resolution + 0.5).astype(np.int64)
        rows, cols = submap.field.shape
        inside = (cells >= 0).all(axis=1) & (cells[:, 1] < rows) & (cells[:, 0] < cols)
        seen = submap.visits[cells[inside, 1], cells[inside, 0]] > 0
        return bool(seen.sum() <= known * len(points))

    def doubts(self, submap: Submap, points: Array, foot: Array, pose: Array, score: float) -> bool:
        """Return whether a match is doubtful.

        Args:
            submap: What the scan was matched on.
            points: (N, 2) its thinned returns, robot frame [m].
            foot: (2,) the laser, robot frame [m].
            pose: (3,) T_local_robot of the match.
            score: Of the match.
        """
        config = self._config
        poor, contradicted = config.poor, config.contradicted
        if self.in_doubt:
            poor, contradicted = config.settled_poor, config.settled_contradicted
        place = submap.field, submap.visits, submap.corner, submap.resolution
        share = contradictions(*place, foot, points, pose, config.slack) / len(points)
        if score < poor * self._usual and not self._pardoned and share > contradicted:
            self.in_doubt += 1
            self._plain += score < config.plain_poor * self._usual and share > config.plain_contradicted
            return True
        self._usual = score if self._usual == 0.0 else self._usual + _MEMORY * (score - self._usual)
        self._pardoned = False
        self.in_doubt = self._plain = 0
        return False


@njit(cache=True, nogil=True)
def contradictions(
    field: NDArray[np.float32],
    visits: NDArray[np.float32],
    corner: Array,
    resolution: float,
    foot: Array,
    points: Array,
    pose: Array,
    slack: float,
) -> int:
    """Return how many of the beams that end at `points` (N, 2) contradict a submap, the robot at `pose` (3,).

    A beam contradicts it that comes through a cell of a wall more than `slack` [m] before its end, or that ends in a
    cell that was seen before, without any trace of a wall in the cells around.
    """
    rows, cols = field.shape
    c, s = np.cos(pose[2]), np.sin(pose[2])
    x0 = (pose[0] + c * foot[0] - s * foot[1] - corner[0]) / resolution + 0.5
    y0 = (pose[1] + s * foot[0] + c * foot[1] - corner[1]) / resolution + 0.5
    count = 0
    for n in range(len(points)):
        x1 = (pose[0] + c * points[n, 0] - s * points[n, 1] - corner[0]) / resolution + 0.5
        y1 = (pose[1] + s * points[n, 0] + c * points[n, 1] - corner[1]) / resolution + 0.5
        length = np.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2)
        contradicts = False
        for step in range(1, int(length - slack / resolution) + 1):
            i = int(np.floor(y0 + step / length * (y1 - y0)))
            j = int(np.floor(x0 + step / length * (x1 - x0)))
            if 0 <= i < rows and 0 <= j < cols and field[i, j] > _WALL:
                contradicts = True
                break
        i, j = int(np.floor(y1)), int(np.floor(x1))
        if not contradicts and 0 <= i < rows and 0 <= j < cols and visits[i, j] > 0:
            around = field[max(i - _NEAR, 0) : i + _NEAR + 1, max(j - _NEAR, 0) : j + _NEAR + 1]
            contradicts = around.max() < _TRACE
        count += contradicts
    return count
