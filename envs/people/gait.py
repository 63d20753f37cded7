"""Steps: the stance foot stands still on the floor, step length and cadence follow the speed.

Per step time T the swing foot flies during the first `SWING` of it and both feet stand for the rest. Step length over
cadence is a person's own constant (the walk ratio w), so T = sqrt(w / speed) and the step is sqrt(w * speed) long.
The landing place is as far ahead of the body as the stance foot will be behind it when it lifts off.
"""

import math

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, view_kernel
from .movement.things import Things, keep_clear

Array = NDArray[np.float64]

SWING = 0.8
"""Share of the step time in which one foot is in the air."""
_SLOWEST, _FASTEST = 0.95, 0.42
_RESTLESS = 0.09
_BETWEEN_LEGS = 0.02
_BESIDE_LEG = 0.03


@view_kernel
def advance_gait(
    dt: float,
    position: Array,
    velocity: Array,
    heading: Array,
    size: Array,
    feet: Array,
    origin: Array,
    lift: Array,
    phase: Array,
    swing: NDArray[np.int64],
    things: Things,
) -> None:
    """Move the feet of n people for `dt` seconds, in place.

    Args:
        dt: Time [s].
        position: (n, 2) bodies [m].
        velocity: (n, 2) of the bodies [m/s].
        heading: (n,) [rad].
        size: (n, k) columns 2 to 4: radius of legs, half distance between the feet's tracks [m], walk ratio [m s].
        feet: (n, 2, 2) left and right foot on the floor [m].
        origin: (n, 2) where the swing foot lifted off [m].
        lift: (n, 2) heights of the feet above the floor [m].
        phase: (n,) of the present step, in [0, 1); unused while standing.
        swing: (n,) the foot of the present step, 0 left, 1 right; -1 while standing.
        things: Furniture and walls, where no foot is set.
    """
    for i in range(len(position)):
        speed = math.sqrt(velocity[i, 0] * velocity[i, 0] + velocity[i, 1] * velocity[i, 1])
        step_time = min(_SLOWEST, max(_FASTEST, math.sqrt(size[i, 4] / max(speed, 0.05))))
        if swing[i] < 0:
            foot = _restless_foot(position[i], velocity[i], heading[i], size[i, 3], feet[i], speed)
            if foot < 0:
                continue
            _lift_off(i, foot, feet, origin, phase, swing)
        phase[i] += dt / step_time
        foot = swing[i]
        if phase[i] - dt / step_time < SWING:
            _swing(i, foot, step_time, speed, position, velocity, heading, size, feet, origin, lift, phase)
            x, y, room = feet[i, foot, 0], feet[i, foot, 1], size[i, 2] + _BESIDE_LEG
            feet[i, foot, 0], feet[i, foot, 1] = keep_clear(x, y, room, things)
        if phase[i] >= 1.0:
            remaining = phase[i] - 1.0
            swing[i] = -1
            if _restless_foot(position[i], velocity[i], heading[i], size[i, 3], feet[i], speed) >= 0:
                _lift_off(i, 1 - foot, feet, origin, phase, swing)
                phase[i] = remaining


@inner_view_kernel
def _swing(
    i: int,
    foot: int,
    step_time: float,
    speed: float,
    position: Array,
    velocity: Array,
    heading: Array,
    size: Array,
    feet: Array,
    origin: Array,
    lift: Array,
    phase: Array,
) -> None:
    """Put the swing foot on its way between where it lifted off and where it will land."""
    share = min(phase[i] / SWING, 1.0)
    ahead = step_time * (max(SWING - phase[i], 0.0) + 1.0 - SWING / 2.0)
    side, cos, sin = size[i, 3] if foot == 0 else -size[i, 3], math.cos(heading[i]), math.sin(heading[i])
    target_x = position[i, 0] + ahead * velocity[i, 0] - side * sin
    target_y = position[i, 1] + ahead * velocity[i, 1] + side * cos
    blend = share * share * share * (10.0 - 15.0 * share + 6.0 * share * share)
    feet[i, foot, 0] = origin[i, 0] + blend * (target_x - origin[i, 0])
    feet[i, foot, 1] = origin[i, 1] + blend * (target_y - origin[i, 1])
    _keep_apart(feet[i], foot, 2.0 * size[i, 2] + _BETWEEN_LEGS, cos, sin)
    lift[i, foot] = (0.03 + 0.05 * min(speed, 1.3)) * math.sin(np.pi * share) if share < 1.0 else 0.0


@inner_view_kernel
def _keep_apart(feet: Array, foot: int, room: float, cos: float, sin: float) -> None:
    """Move the swing foot aside where it would pass through the standing leg: legs do not cross in a turn."""
    side = 1.0 if foot == 0 else -1.0
    x, y = feet[foot, 0] - feet[1 - foot, 0], feet[foot, 1] - feet[1 - foot, 1]
    forward, aside = cos * x + sin * y, side * (cos * y - sin * x)
    needed = room * max(0.0, 1.0 - (forward / (2.5 * room)) ** 2)
    if aside < needed:
        feet[foot, 0] -= side * (needed - aside) * sin
        feet[foot, 1] += side * (needed - aside) * cos


@inner_view_kernel
def _lift_off(person: int, foot: int, feet: Array, origin: Array, phase: Array, swing: NDArray[np.int64]) -> None:
    swing[person] = foot
    phase[person] = 0.0
    origin[person, 0], origin[person, 1] = feet[person, foot, 0], feet[person, foot, 1]


@inner_view_kernel
def _restless_foot(
    position: Array, velocity: Array, heading: float, half_width: float, feet: Array, speed: float
) -> int:
    """Return the foot that has to step next, -1 where both stand well."""
    worst, found, cos, sin = _RESTLESS, -1, math.cos(heading), math.sin(heading)
    for foot in range(2):
        side = half_width if foot == 0 else -half_width
        x = feet[foot, 0] - position[0] + side * sin
        y = feet[foot, 1] - position[1] - side * cos
        away = -(x * velocity[0] + y * velocity[1]) / speed + 1.0 if speed > 0.1 else math.sqrt(x * x + y * y)
        if away > worst:
            worst, found = away, foot
    return found
