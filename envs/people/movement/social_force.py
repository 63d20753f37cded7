"""The social force: how people make room for each other and for walls.

The interaction of two people is that of Moussaid et al. 2009 ("Experimental study of the behavioural mechanisms
underlying self-organization in human crowds"), which the package PySocialForce offers as well and is compared with in
the tests; the drive to the wanted velocity and the walls follow Helbing and Molnar 1995.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ....slam.bounds import Within, check_numbers
from ....slam.view_kernel import view_kernel

Array = NDArray[np.float64]
_Number = Annotated[float, Within(1e-3, 1e3)]  # a force of 1e3 m/s^2 throws people about; below 1e-3 there is none

NOTICED = 9.0
"""Nobody minds others farther away than so many reaches: what they would do is below 1e-3 m/s^2."""


@dataclass(frozen=True, kw_only=True)
class SocialForceConfig:
    """Strengths and reaches.

    Attributes:
        relaxation_time: Time in which the wanted velocity is taken up [s].
        social_factor: Strength of the force between people [m/s^2].
        velocity_weight: Weight of the relative velocity against the direction to the other [s/m] (lambda).
        gamma: Reach of the force per unit of interaction [m].
        n: Angular sharpness of the turning part.
        n_prime: Angular sharpness of the braking part.
        obstacle_factor: Strength of the force of walls and furniture [m/s^2].
        obstacle_reach: Distance in which it falls to 1/e [m].
        obstacle_threshold: Distance beyond which it is zero [m].
    """

    relaxation_time: _Number = 0.5
    social_factor: _Number = 5.1
    velocity_weight: _Number = 2.0
    gamma: _Number = 0.35
    n: _Number = 2.0
    n_prime: _Number = 3.0
    obstacle_factor: _Number = 5.0
    obstacle_reach: _Number = 0.08
    obstacle_threshold: _Number = 0.6

    def __post_init__(self) -> None:
        check_numbers(self)

    def as_array(self) -> Array:
        """Return (9,) the fields in their order, as the kernels take them."""
        return np.array(list(self.__dict__.values()), dtype=np.float64)


@view_kernel
def pair_force(dx: float, dy: float, vx: float, vy: float, gap: float, config: Array) -> tuple[float, float]:
    """Return the force that another makes on this one [m/s^2]; 0 where there is none.

    Args:
        dx: The other's x minus this one's [m].
        dy: The other's y minus this one's [m].
        vx: This one's velocity minus the other's, x [m/s].
        vy: The same, y [m/s].
        gap: Subtracted from the distance, for others that are larger than a person [m].
        config: `SocialForceConfig.as_array()`.
    """
    distance = max(math.sqrt(dx * dx + dy * dy), 1e-6)
    ex, ey = dx / distance, dy / distance
    ix, iy = config[2] * vx + ex, config[2] * vy + ey
    strength = math.sqrt(ix * ix + iy * iy)
    away, reach = max(distance - gap, 0.0), config[3] * strength
    if strength < 1e-9 or away > NOTICED * reach:
        return 0.0, 0.0
    ix, iy = ix / strength, iy / strength
    angle = math.atan2(ex * iy - ey * ix, ex * ix + ey * iy)
    decay = -away / reach
    brake = math.exp(decay - (config[5] * reach * angle) ** 2)
    aside = math.exp(decay - (config[4] * reach * angle) ** 2)
    turn = -math.copysign(aside, angle) if angle != 0.0 else 0.0
    return -config[1] * (brake * ix - turn * iy), -config[1] * (brake * iy + turn * ix)
