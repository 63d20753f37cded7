"""Whether a wish can be braked before anything is touched, compiled: what the guard asks, of one robot or of many.

The kernels make no arrays, so that a GPU's threads can run them, too.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, view_kernel

Array = NDArray[np.float64]

MOST_WISHES = 30
"""Wishes that are tried instead of one that cannot be braked."""
_SPEEDS = (1.0, 0.7, 0.45, 0.2, 0.0)
"""Shares of the wished speed that are tried; beside them, backing at `_BACK_MPS`."""
_TURNS = (1.0, 0.5, 0.0)
"""Shares of the wished turn rate that are tried; beside them, turning at `_ASIDE_RPS` to either side."""
_BACK_MPS, _ASIDE_RPS = -0.15, 0.6
_STANDS = 1e-3
"""Speed and turn rate together of a robot that stands [m/s, rad/s]."""
NEARER_M = 1e-4
"""Who may not come nearer to something may come so much nearer [m]: rounding."""


class GuardNumbers(NamedTuple):
    """Numbers of the guard, the robot and its steering; kernels take it as it is.

    Attributes:
        half_length: Of the robot's box [m].
        half_width: Of it [m].
        laser_x: Place of the laser in the robot frame [m].
        laser_y: The same [m].
        range_max: What a beam reads where the observation says 1 [m].
        step_s: Length of a step [s].
        margin: See `GuardConfig`, as the next ones.
        reach: See there.
        stride: See there.
        brake_steps: See there.
    """

    half_length: float
    half_width: float
    laser_x: float
    laser_y: float
    range_max: float
    step_s: float
    margin: float
    reach: float
    stride: float
    brake_steps: int


@view_kernel
def next_commands(
    v: float, a: float, w: float, b: float, speed: float, turn: float, dt: float, c: Array
) -> tuple[float, float, float, float]:
    """Do as `steering.steer` does; `c` (12,) is `SteeringConfig.as_tuple()`."""
    brakes = (speed - v) * v < 0.0
    most = c[6] if brakes else c[5]
    change = (c[9] if brakes else c[8]) * dt
    wanted = min(max((speed - v) / c[3], -most), most)
    a = min(max(wanted, a - change), a + change)
    turning = min(max((turn - w) / c[4], -c[7]), c[7])
    b = min(max(turning, b - c[10] * dt), b + c[10] * dt)
    v = min(max(v + a * dt, -c[1]), c[0])
    w = min(max(w + b * dt, -c[2]), c[2])
    return v, a, w, b


@view_kernel
def gap_to(ahead: float, aside: float, half_length: float, half_width: float) -> float:
    """Return the distance from the robot's box to a place in its frame [m]; within: minus the depth of it."""
    x, y = abs(ahead) - half_length, abs(aside) - half_width
    if x <= 0.0 and y <= 0.0:
        return max(x, y)
    return math.hypot(max(x, 0.0), max(y, 0.0))


@view_kernel
def goes_wide(gap: float, speed: float) -> bool:
    """Return whether nothing is so near, `gap` [m], that who drives at `speed` [m/s] could not brake before it."""
    return gap > 0.2 + 0.45 * abs(speed) + speed * speed / 3.0


@view_kernel
def put_bounds(things: Array, least: float, margin: float) -> None:
    """Write over how far each of `things` (m, 5) is now, the nearest `least` [m], how near the robot may come to it.

    To what is touched, no nearer than it is; to other things, not so near that it touches them.
    """
    for i in range(len(things)):
        things[i, 2] = min(margin, max(least, min(things[i, 2], 0.0)) - NEARER_M)


@view_kernel
def brakes_in_time(
    state: Array, speed: float, turn: float, things: Array, steering: Array, robot: GuardNumbers
) -> tuple[bool, float]:
    """Return whether one step of a wish, and braking then, keeps all bounds; and how far back that comes [m].

    A bound is broken by who would be beyond it both where the thing is now and where it will be if it walks on: who
    walks out of the way is not braked for, and who comes nearer is met where they are now.

    Args:
        state: (4,) what is commanded now.
        speed: Wished [m/s].
        turn: Wished [rad/s].
        things: (m, 5) place of each in the robot frame, how near the robot may come to it [m], its velocity [m/s].
        steering: (12,) `SteeringConfig.as_tuple()`.
        robot: Its numbers.
    """
    v, a, w, b = float(state[0]), float(state[1]), float(state[2]), float(state[3])
    x = y = heading = back = 0.0
    for k in range(robot.brake_steps + 1):
        if k == 0:
            v, a, w, b = next_commands(v, a, w, b, speed, turn, robot.step_s, steering)
        else:
            v, a, w, b = next_commands(v, a, w, b, 0.0, 0.0, robot.step_s, steering)
        middle, way = heading + 0.5 * w * robot.step_s, v * robot.step_s
        x, y, heading = x + way * math.cos(middle), y + way * math.sin(middle), heading + w * robot.step_s
        back = max(back, -x)
        cos, sin, after = math.cos(heading), math.sin(heading), (k + 1) * robot.step_s
        for i in range(len(things)):
            dx, dy = things[i, 0] - x, things[i, 1] - y
            gap = gap_to(cos * dx + sin * dy, cos * dy - sin * dx, robot.half_length, robot.half_width)
            if gap >= things[i, 2]:
                continue
            dx, dy = dx + after * things[i, 3], dy + after * things[i, 4]
            gap = gap_to(cos * dx + sin * dy, cos * dy - sin * dx, robot.half_length, robot.half_width)
            if gap < things[i, 2]:
                return False, back
        if abs(v) + abs(w) < _STANDS:  # whoever walks into a robot that stands is no matter of its braking
            break
    return True, back


@view_kernel
def put_alternatives(speed: float, turn: float, wishes: Array) -> None:
    """Write what is tried instead of a wish into `wishes` (MOST_WISHES, 3): speed, turn rate, and how far off it is.

    Less of the speed or the turn, turning on the spot to either side, and backing; the least change first.
    """
    count = 0
    for i in range(len(_SPEEDS) + 1):
        forward = speed * _SPEEDS[i] if i < len(_SPEEDS) else _BACK_MPS
        for j in range(len(_TURNS) + 2):
            about = turn * _TURNS[j] if j < len(_TURNS) else _ASIDE_RPS if j > len(_TURNS) else -_ASIDE_RPS
            change, row = abs(forward - speed) + 0.4 * abs(about - turn), count
            while row > 0 and wishes[row - 1, 2] > change:
                for k in range(3):
                    wishes[row, k] = wishes[row - 1, k]
                row -= 1
            wishes[row, 0], wishes[row, 1], wishes[row, 2] = forward, about, change
            count += 1


@view_kernel
def stopping(speed: float, step_s: float, steering: Array) -> float:
    """Return the speed to wish of who is to stand as soon as can be [m/s]: to wish for none is to slow down gently."""
    return speed - steering[3] * min(max(speed / step_s, -steering[6]), steering[6])


@view_kernel
def away_from(dx: float, dy: float, vx: float, vy: float, stride: float) -> float:
    """Return how far a place is from a person, or infinity if it is not theirs [m].

    Legs are a stride before and behind, and half as far to the sides: a door post beside a walker does not walk.

    Args:
        dx: The place as seen from the person [m].
        dy: The same [m].
        vx: Velocity of the person [m/s].
        vy: The same [m/s].
        stride: See `GuardConfig`.
    """
    away, aside = math.hypot(dx, dy), abs(dx * vy - dy * vx)
    if away > stride or aside > 0.5 * stride * math.hypot(vx, vy):
        return np.inf
    return away


@view_kernel
def put_velocities(things: Array, leader: Array, people: Array, stride: float) -> None:
    """Write the velocity of the person whose leg each of `things` (n, 5) is, the nearest one's; of others, zero."""
    for i in range(len(things)):
        x, y, nearest = things[i, 0], things[i, 1], np.inf
        things[i, 3] = things[i, 4] = 0.0
        for j in range(-1, len(people)):
            person = leader if j < 0 else people[j]
            if person[5] < 0.5:
                continue
            away = away_from(x - person[0], y - person[1], person[2], person[3], stride)
            if away < nearest:
                nearest, things[i, 3], things[i, 4] = away, person[2], person[3]


@inner_view_kernel
def guard_world(
    state: Array,
    wish: Array,
    scan: Array,
    leader: Array,
    people: Array,
    directions: Array,
    steering: Array,
    robot: GuardNumbers,
    things: Array,
    wishes: Array,
) -> None:
    """Write over `wish` (2,) the nearest that can be braked, by the returns of this step's scan alone.

    Args:
        state: (4,) what is commanded.
        wish: Speed [m/s] and turn rate [rad/s].
        scan: (beams,) of the observation.
        leader: (6,) of it.
        people: (m, 6) of it.
        directions: (beams, 2) of the beams in the robot frame.
        steering: (12,) `SteeringConfig.as_tuple()`.
        robot: Its numbers.
        things: (beams, 5) scratch.
        wishes: (MOST_WISHES, 3) scratch.
    """
    count, least = 0, np.inf
    for j in range(len(scan)):
        away = float(scan[j]) * robot.range_max
        if scan[j] >= 1.0 or away >= robot.reach:
            continue
        x, y = robot.laser_x + away * directions[j, 0], robot.laser_y + away * directions[j, 1]
        things[count, 0], things[count, 1] = x, y
        things[count, 2] = gap_to(x, y, robot.half_length, robot.half_width)
        least = min(least, things[count, 2])
        count += 1
    if goes_wide(least, float(state[0])):
        return
    near, speed, turn = things[:count], float(wish[0]), float(wish[1])
    put_bounds(near, least, robot.margin)
    put_velocities(near, leader, people, robot.stride)
    if brakes_in_time(state, speed, turn, near, steering, robot)[0]:
        return
    put_alternatives(speed, turn, wishes)
    for i in range(MOST_WISHES):
        if brakes_in_time(state, wishes[i, 0], wishes[i, 1], near, steering, robot)[0]:
            wish[0], wish[1] = wishes[i, 0], wishes[i, 1]
            return
    wish[0], wish[1] = stopping(float(state[0]), robot.step_s, steering), 0.0


@view_kernel
def guard_worlds(
    states: Array,
    wanted: Array,
    scans: Array,
    leaders: Array,
    people: Array,
    directions: Array,
    steering: Array,
    robot: GuardNumbers,
    things: Array,
    wishes: Array,
) -> None:
    """Do as `guard_world` for each of n worlds; scratch as there."""
    for w in range(len(wanted)):
        guard_world(
            states[w], wanted[w], scans[w], leaders[w], people[w], directions, steering, robot, things, wishes
        )  # fmt: skip
