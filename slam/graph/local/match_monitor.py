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
        poor: A scan is rejected if its score is below so much of the usual one ...
        contradicted: ... and more than this share of its beams contradicts the submap.
        poor_after: Once one was rejected, the next ones are, too, if the score is below so much of the usual one ...
        contradicted_after: ... and more than this share of the beams contradicts the submap.
        poor_lost: As `poor`, for a scan that cannot belong there at all ...
        contradicted_lost: ... as `contradicted`.
        slack: A wall must stand so far before the end of a beam to contradict it [m].
        patience: After so many rejected scans in a row something has to be done.
        no_overlap: A score below so much of the usual one, and no larger a share of the points where the submap was
            seen, say that the scan has no overlap with it [score, share].
        far: A match is far off that lies farther from where the odometry has the robot [m, rad].
        no_overlap_far: As `no_overlap`, of such a match: after a gap some place nearby fits by chance.
    """

    poor: float = 0.75
    contradicted: float = 0.1
    poor_after: float = 0.9
    contradicted_after: float = 0.05
    poor_lost: float = 0.6
    contradicted_lost: float = 0.2
    slack: float = 0.4
    patience: int = 3
    no_overlap: tuple[float, float] = (0.1, 0.3)
    far: tuple[float, float] = (0.25, 0.1)
    no_overlap_far: tuple[float, float] = (0.3, 0.45)

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
        rejected: How many scans in a row were rejected.
        accepts_next: Whether the next scan is believed in any case.
    """

    def __init__(self, config: MatchMonitorConfig) -> None:
        self._config = config
        self._usual = 0.0  # score
        self.accepts_next = False
        self._lost = 0  # of the rejected scans, those that cannot belong to the submap at all
        self.rejected = 0

    @property
    def alarmed(self) -> bool:
        """Whether so many scans in a row were rejected that something has to be done."""
        return self.rejected >= self._config.patience

    @property
    def clearly_lost(self) -> bool:
        """Whether none of the rejected scans can belong to the submap."""
        return self.alarmed and self._lost == self.rejected

    def restart(self) -> None:
        """Begin anew with another submap; what score is usual stays known."""
        self.rejected = self._lost = 0

    def accept_next(self) -> None:
        """Believe the next scan in any case: nothing better is known than where the robot was thought to be."""
        self.rejected = self._lost = 0
        self.accepts_next = True

    def far_off(self, predicted: Array, pose: Array) -> bool:
        """Return whether a match at `pose` (3,) lies far from where the odometry has `predicted` (3,) the robot."""
        off, most = between(predicted, pose), self._config.far
        return bool(np.hypot(off[0], off[1]) > most[0] or abs(off[2]) > most[1])

    def has_no_overlap(self, submap: Submap, points: Array, predicted: Array, pose: Array, score: float) -> bool:
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
        if score >= max(config.no_overlap[0], config.no_overlap_far[0]) * self._usual:
            return False
        least, known = config.no_overlap_far if self.far_off(predicted, pose) else config.no_overlap
        if score >= least * self._usual:
            return False
        cells = np.floor((transform_points(pose, points) - submap.corner) / submap.resolution + 0.5).astype(np.int64)
        rows, cols = submap.field.shape
        inside = (cells >= 0).all(axis=1) & (cells[:, 1] < rows) & (cells[:, 0] < cols)
        seen = submap.visits[cells[inside, 1], cells[inside, 0]] > 0
        return bool(seen.sum() <= known * len(points))

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
        poor, contradicted = config.poor, config.contradicted
        if self.rejected:
            poor, contradicted = config.poor_after, config.contradicted_after
        place = submap.field, submap.visits, submap.corner, submap.resolution
        share = contradictions(*place, sensor, points, pose, config.slack) / len(points)
        if score < poor * self._usual and not self.accepts_next and share > contradicted:
            self.rejected += 1
            self._lost += score < config.poor_lost * self._usual and share > config.contradicted_lost
            return True
        self._usual = score if self._usual == 0.0 else self._usual + _MEMORY * (score - self._usual)
        self.accepts_next = False
        self.rejected = self._lost = 0
        return False


@njit(cache=True, nogil=True)
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
    c, s = np.cos(pose[2]), np.sin(pose[2])
    x0 = (pose[0] + c * sensor[0] - s * sensor[1] - corner[0]) / resolution + 0.5
    y0 = (pose[1] + s * sensor[0] + c * sensor[1] - corner[1]) / resolution + 0.5
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
