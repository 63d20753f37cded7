"""What a camera tells the tracker: where people are, whether they move or not, some time after the exposure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import check_points, check_time, checked_pose
from ...slam.geometry import transform_points
from ...slam.scan import LaserScan
from ...slam.view_kernel import inner_kernel, kernel
from ..legs.detector import Detections, no_detections
from ..rgbd.people import RgbdPeople
from .assignment import assigned
from .evidence import log_odds_of
from .existence import begin_at
from .geometry_kernels import distances
from .kalman import correct_state
from .local_grid import clear
from .tracks import hypotheses_of

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SeenPeople:
    """People that a camera saw.

    Attributes:
        time_s: Time of the exposure [s].
        positions: (n, 2) odometry frame [m].
        likelihood: (n,) in [0, 1].
    """

    time_s: float
    positions: Array
    likelihood: Array

    def __post_init__(self) -> None:
        check_time(self.time_s)
        check_points(self.positions, "positions")

    @classmethod
    def at_exposure(cls, people: RgbdPeople, time_s: float, odometry: ArrayLike) -> "SeenPeople":
        """Return `people` of a frame taken at `time_s` [s] where the odometry said T_odom_robot (3,)."""
        return cls(time_s, transform_points(checked_pose(odometry), people.positions), people.likelihood)


class NoLegs:
    """A detector that finds no legs: for people by the camera alone."""

    def detect(self, scan: LaserScan) -> Detections:
        """Return nothing, whatever `scan` shows."""
        return no_detections()


@kernel
def take_in(tracks, places, likelihood, delay, laser, c):
    """Correct people by where a camera saw somebody, and begin hypotheses where it saw somebody new.

    That is a look at them, whether they move or not, and what stands there is no thing.

    Args:
        tracks: Of one tracker.
        places: (n, 2) where the camera saw somebody, odometry frame [m].
        likelihood: (n,) in [0, 1].
        delay: Since it saw them [s].
        laser: (3,) T_odom_lidar now.
        c: Numbers of the tracker.
    """
    rows = hypotheses_of(tracks)
    then, near = rows["x"][:, :2] - delay * rows["x"][:, 2:], np.zeros(len(places), np.bool_)
    away = distances(then, places)
    chosen, column = assigned(away, np.full(len(rows), c.camera_gate))
    for i in range(len(rows)):
        for k in range(len(places)):
            near[k] = near[k] or away[i, k] <= c.camera_gate
    for j in range(len(chosen)):
        i, k = chosen[j], column[j]
        x, legs = rows[i].x, rows[i].legs
        before = x[0], x[1]
        correct_state(x, rows[i].p, places[k, 0] + delay * x[2], places[k, 1] + delay * x[3], c.camera_r)
        for s in range(2):  # legs are where the laser saw them
            legs[s, 0], legs[s, 1] = legs[s, 0] + before[0] - x[0], legs[s, 1] + before[1] - x[1]
        looks = rows[i].looks + 1.0
        rows[i].evidence += (_evidence(likelihood[k], c) - rows[i].evidence) / looks
        rows[i].looks = min(looks, c.evidence_most_looks)
        rows[i].unseen_s, rows[i].missing, rows[i].stands_s = min(rows[i].unseen_s, delay), 0.0, 0.0
        clear(tracks.cells, legs + x[:2], c.things_resolution)
    for k in range(len(places)):
        if not near[k]:
            one = begin_at(tracks, places[k, 0], places[k, 1], laser, c)
            one.evidence, one.unseen_s = _evidence(likelihood[k], c), delay


@inner_kernel
def _evidence(likelihood, c):
    return c.evidence_base + log_odds_of(likelihood)
