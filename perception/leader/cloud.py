"""Where the leader's body may be: a cloud of weighted bodies that walk on, are seen, or are hidden.

A particle filter (Gordon et al. 1993) of one person. What a single track lacks: it keeps its direction while two
people pass each other, it spreads behind corners, and it dies where the laser sees that nobody is.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import Within, check_numbers, check_positive
from ...slam.errors import InputError
from ...slam.view_kernel import kernel
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


@kernel
def begin_cloud(bodies, weights, x, draws, c):
    """Spread `bodies` (n, 4) around the state `x` (4,) by standard normal `draws` (n, 4)."""
    for i in range(len(bodies)):
        for k in range(4):
            deviation = c.cloud_place_deviation if k < 2 else c.cloud_velocity_deviation
            bodies[i, k] = x[k] + deviation * draws[i, k]
    weights[:] = 1.0 / len(bodies)


@kernel
def advance_cloud(bodies, weights, draws, dt, view, c):
    """Let the bodies walk for `dt` [s] by standard normal `draws` (n, 2), and not through what the laser sees."""
    pushes, calm = c.cloud_push * np.sqrt(dt) * draws, np.exp(-dt / c.cloud_calm_s)
    kernels.advance(
        bodies, weights, pushes, dt, calm, c.cloud_top_speed, view.ranges, view.first, view.step, view.laser
    )  # fmt: skip
    weights /= weights.sum()


@kernel
def weigh_cloud(bodies, weights, legs, count, view, c):
    """Weigh the bodies by `legs` (k, 2), each counting `count` (k,), and by the view; return whether too few count."""
    unseen = np.array((c.cloud_hidden, c.cloud_empty, c.cloud_instead))
    kernels.weigh(
        bodies, weights, legs, count, c.cloud_leg_deviation, c.cloud_most, unseen, view.ranges, view.first, view.step,
        view.laser,
    )  # fmt: skip
    weights /= weights.sum()
    return 1.0 / (weights * weights).sum() < c.cloud_resample * len(weights)


@kernel
def draw_anew(bodies, weights, draw):
    """Draw the bodies by their weights, at equal steps of the sum from `draw` in [0, 1) on (Kitagawa 1996)."""
    before, count = bodies.copy(), len(bodies)
    chosen, total = 0, weights[0]
    for i in range(count):
        while total < (draw + i) / count and chosen < count - 1:
            chosen += 1
            total += weights[chosen]
        for k in range(4):
            bodies[i, k] = before[chosen, k]
    weights[:] = 1.0 / count


@kernel
def mean_of(bodies, weights):
    """Return (4,) the mean of the bodies."""
    mean = np.zeros(4)
    for i in range(len(bodies)):
        for k in range(4):
            mean[k] += weights[i] * bodies[i, k]
    return mean


@kernel
def spread_of(bodies, weights):
    """Return the root mean square distance of the bodies from their mean place [m]."""
    mean, total = mean_of(bodies, weights), 0.0
    for i in range(len(bodies)):
        total += weights[i] * ((bodies[i, 0] - mean[0]) ** 2 + (bodies[i, 1] - mean[1]) ** 2)
    return np.sqrt(total)
