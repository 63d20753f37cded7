"""Where the leader's body may be: a cloud of weighted bodies that walk on, are seen, or are hidden.

A particle filter (Gordon et al. 1993) of one person. What a single track lacks: it keeps its direction while two
people pass each other, it spreads behind corners, and it dies where the laser sees that nobody is.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import Within, check_numbers, check_positive
from ...slam.errors import InputError
from ...slam.geometry import compose
from ...slam.scan import LaserScan
from . import cloud_kernels as kernels

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CloudConfig:
    """How a body walks and shows.

    Attributes:
        count: Bodies in the cloud.
        push: Deviation of the change of a body's velocity in a second [m/s].
        calm_s: How fast a velocity fades [s].
        top_speed: Nobody walks faster [m/s].
        place_deviation: Of the first bodies from the person chosen [m].
        velocity_deviation: The same of their velocities [m/s].
        leg_deviation: Of a seen leg from the body's centre [m].
        most: Legs near a body weigh no more than this in sum, where 1 is a body's weight if it is surely hidden.
        hidden: How likely nothing is seen of a body that something stands before, or that the laser does not reach.
        empty: The same of a body in free view.
        instead: The same of a body where the laser sees something else.
        resample: The cloud is drawn anew when fewer than this share of its bodies count.
    """

    count: Annotated[int, Within(1, 100_000)] = 200
    push: float = 1.0
    calm_s: float = 2.5
    top_speed: float = 1.6
    place_deviation: float = 0.1
    velocity_deviation: float = 0.3
    leg_deviation: float = 0.22
    most: float = 4.5
    hidden: float = 0.7
    empty: float = 0.12
    instead: float = 0.15
    resample: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.count < 1:
            raise InputError(f"a cloud needs a `count` of bodies, got {self.count}")
        check_positive(self, "calm_s", "top_speed", "leg_deviation")


@dataclass(frozen=True, eq=False)
class LeaderView:
    """How far the laser sees, in the odometry frame.

    Attributes:
        ranges: (N,) along the beams, the largest range where nothing was hit, 0 where nothing is known [m].
        first: Bearing of the first beam in the laser's frame [rad].
        step: Angle between two beams [rad].
        laser: (3,) T_odom_lidar.
    """

    ranges: Array
    first: float
    step: float
    laser: Array

    @staticmethod
    def of(scan: LaserScan, robot_pose: ArrayLike) -> "LeaderView":
        """Return the view of a scan, whose beams are at equal angles, with the robot at `robot_pose` (3,)."""
        known = scan.ranges >= scan.range_min
        ranges = np.where(known, np.minimum(scan.ranges, scan.range_max), 0.0)
        step = float(scan.bearings[-1] - scan.bearings[0]) / max(len(ranges) - 1, 1)
        return LeaderView(ranges, float(scan.bearings[0]), step, np.asarray(compose(robot_pose, scan.T_robot_lidar)))


class BodyCloud:
    """The bodies, each (x, y, vx, vy) in the odometry frame, with weights that sum to one.

    Args:
        config: How a body walks and shows.
        rng: Of all draws.
        position: (2,) of the person who is to be known again [m].
        velocity: (2,) [m/s].
    """

    def __init__(self, config: CloudConfig, rng: np.random.Generator, position: Array, velocity: Array) -> None:
        self.config, self._rng = config, rng
        deviation = np.repeat((config.place_deviation, config.velocity_deviation), 2)
        self.bodies = np.concatenate((position, velocity)) + deviation * rng.standard_normal((config.count, 4))
        self.weights = np.full(config.count, 1.0 / config.count)

    def advance(self, dt: float, view: LeaderView) -> None:
        """Let the bodies walk for `dt` [s], and not through what the laser sees."""
        c = self.config
        pushes = c.push * np.sqrt(dt) * self._rng.standard_normal((c.count, 2))
        beams = view.ranges, view.first, view.step, view.laser
        calm = float(np.exp(-dt / c.calm_s))
        kernels.advance(self.bodies, self.weights, pushes, dt, calm, c.top_speed, *beams)
        self.weights /= self.weights.sum()

    def explained(self, legs: Array) -> Array:
        """Return (k,) how well the bodies explain each of `legs` (k, 2), in [0, 1]."""
        out = np.empty(len(legs))
        kernels.explained(self.bodies, self.weights, legs, self.config.leg_deviation, out)
        return out

    def weigh(self, legs: Array, count: Array, view: LeaderView) -> None:
        """Weigh the bodies by `legs` (k, 2), each counting `count` (k,), and by the view; draw them anew if needed."""
        c = self.config
        unseen = np.array((c.hidden, c.empty, c.instead))
        beams = view.ranges, view.first, view.step, view.laser
        kernels.weigh(self.bodies, self.weights, legs, count, c.leg_deviation, c.most, unseen, *beams)
        self.weights /= self.weights.sum()
        if 1.0 / float(self.weights @ self.weights) < c.resample * c.count:
            self._draw_anew()

    def near(self, places: Array, radius: float) -> Array:
        """Return (k,) the share of the cloud nearer than `radius` [m] to each of `places` (k, 2)."""
        out = np.empty(len(places))
        kernels.mass_near(self.bodies, self.weights, places, radius, out)
        return out

    @property
    def mean(self) -> Array:
        """(4,) mean of the bodies."""
        return np.asarray(self.weights @ self.bodies)

    @property
    def spread(self) -> float:
        """Root mean square distance of the bodies from their mean place [m]."""
        return float(np.sqrt((self.weights @ (self.bodies[:, :2] - self.mean[:2]) ** 2).sum()))

    def _draw_anew(self) -> None:
        """Draw the bodies by their weights, at equal steps of the sum (Kitagawa 1996)."""
        count = self.config.count
        marks = (self._rng.random() + np.arange(count)) / count
        chosen = np.searchsorted(np.cumsum(self.weights), marks)
        self.bodies = self.bodies[np.minimum(chosen, count - 1)]
        self.weights = np.full(count, 1.0 / count)
