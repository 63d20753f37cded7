"""The robot's base on its wheels: what MuJoCo's slides, hinge, servos and contacts do, in the plane.

As `mjINT_IMPLICITFAST` integrates them: a servo that is not at its limit brakes implicitly. Contacts are MuJoCo's soft
constraints at its default `solref` and `solimp`, solved point by point; upright walls and people leave nothing of the
third dimension. Held to MuJoCo by tests.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel
from ..people.movement.things import Things, cell_of

Array = NDArray[np.float64]

MOST_CONTACTS = 64
"""Points of contact that are looked at: a chassis touches a handful."""
_ROUNDS = 12
_FRICTION = 0.3
_DEPTH, _SOFTEST, _HARDEST = 0.001, 0.9, 0.95  # solimp
_TIME_CONSTANT = 0.02  # solref


class Base(NamedTuple):
    """Size and servos of the robot; kernels take it as it is.

    Attributes:
        half_length: Of the chassis [m].
        half_width: Of the chassis [m].
        mass: [kg].
        inertia: About the vertical [kg m^2].
        gains: (3,) of the servos forward, sideways [N s/m] and turn [N m s].
        limits: (3,) largest force of each [N, N, N m].
        slopes: (3,) largest change of the setpoints [m/s^2, m/s^2, rad/s^2].
        max_speed: Largest linear speed of a command [m/s].
        max_turn_rate: Largest angular speed of a command [rad/s].
        dt: Time step of the physics [s].
    """

    half_length: float
    half_width: float
    mass: float
    inertia: float
    gains: Array
    limits: Array
    slopes: Array
    max_speed: float
    max_turn_rate: float
    dt: float


@inner_view_kernel
def cut_command(wanted: Array, base: Base) -> None:
    """Cut a wanted body velocity (3,) to the limits, in place."""
    speed = math.hypot(wanted[0], wanted[1])
    scale = min(1.0, base.max_speed / speed) if speed > 0.0 else 1.0
    wanted[0] *= scale
    wanted[1] *= scale
    wanted[2] = min(max(wanted[2], -base.max_turn_rate), base.max_turn_rate)


@inner_view_kernel
def ramp(setpoint: Array, wanted: Array, base: Base, dt: float) -> None:
    """Move the setpoints (3,) towards `wanted` (3,) for `dt` seconds, in place."""
    for k in range(3):
        step = base.slopes[k] * dt
        setpoint[k] += min(max(wanted[k] - setpoint[k], -step), step)


@inner_view_kernel
def drive(
    pose: Array, velocity: Array, setpoint: Array, base: Base, contacts: Array, touched: int, work: Array
) -> None:
    """Advance the base by one time step of the physics, in place.

    Args:
        pose: (3,) x, y [m], heading [rad], which is not wrapped.
        velocity: (3,) in the world [m/s, m/s, rad/s].
        setpoint: (3,) of the servos, in the body's frame.
        base: Size and servos.
        contacts: (MOST_CONTACTS, 5) point x, y [m], unit vector away from what is touched, depth [m].
        touched: How many there are.
        work: (MOST_CONTACTS, 2) scratch.
    """
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    ahead, aside = cos * velocity[0] + sin * velocity[1], cos * velocity[1] - sin * velocity[0]
    force_u, soft_u = _servo(0, setpoint[0] - ahead, base)
    force_v, soft_v = _servo(1, setpoint[1] - aside, base)
    torque, soft_turn = _servo(2, setpoint[2] - velocity[2], base)
    force_x, force_y = cos * force_u - sin * force_v, sin * force_u + cos * force_v
    if touched > 0:
        px, py, pt = _contact_forces(pose, velocity, (force_x, force_y, torque), base, contacts, touched, work)
        force_x, force_y, torque = force_x + px, force_y + py, torque + pt
    ahead = base.dt * (cos * force_x + sin * force_y) / (base.mass + soft_u)
    aside = base.dt * (cos * force_y - sin * force_x) / (base.mass + soft_v)
    velocity[0] += cos * ahead - sin * aside
    velocity[1] += sin * ahead + cos * aside
    velocity[2] += base.dt * torque / (base.inertia + soft_turn)
    for k in range(3):
        pose[k] += base.dt * velocity[k]


@inner_view_kernel
def _servo(k: int, missing: float, base: Base) -> tuple[float, float]:
    """Return the force of servo k that is so much too slow, and what its implicit braking adds to the mass [kg]."""
    force, limit = base.gains[k] * missing, base.limits[k]
    if -limit < force < limit:
        return force, base.dt * base.gains[k]
    return min(max(force, -limit), limit), 0.0


@inner_view_kernel
def _contact_forces(
    pose: Array,
    velocity: Array,
    acting: tuple[float, float, float],
    base: Base,
    contacts: Array,
    touched: int,
    work: Array,
) -> tuple[float, float, float]:
    """Return force x, y [N] and torque [N m] of all contacts, by projected Gauss-Seidel."""
    time_constant = max(_TIME_CONSTANT, 2.0 * base.dt)
    damping = 2.0 / (_HARDEST * time_constant)
    stiffness = 1.0 / (_HARDEST * time_constant) ** 2
    fx, fy, torque = acting
    work[:touched] = 0.0
    for _ in range(_ROUNDS):
        for k in range(touched):
            nx, ny, depth = contacts[k, 2], contacts[k, 3], contacts[k, 4]
            rx, ry = contacts[k, 0] - pose[0], contacts[k, 1] - pose[1]
            share = min(depth / _DEPTH, 1.0)
            share = 2.0 * share * share if share < 0.5 else 1.0 - 2.0 * (1.0 - share) ** 2
            impedance = _SOFTEST + share * (_HARDEST - _SOFTEST)
            for axis in range(2):
                ux, uy = (nx, ny) if axis == 0 else (-ny, nx)
                arm = rx * uy - ry * ux
                mobility = 1.0 / base.mass + arm * arm / base.inertia
                speed = ux * velocity[0] + uy * velocity[1] + arm * velocity[2]
                wanted = -damping * speed + (stiffness * depth if axis == 0 else 0.0)
                gives = (1.0 - impedance) / impedance * mobility
                present = (ux * fx + uy * fy) / base.mass + arm * torque / base.inertia
                change = (wanted - present - gives * work[k, axis]) / (mobility + gives)
                if axis == 0:
                    change = max(change, -work[k, 0])
                else:
                    most = _FRICTION * work[k, 0]
                    change = min(max(work[k, 1] + change, -most), most) - work[k, 1]
                work[k, axis] += change
                fx, fy, torque = fx + change * ux, fy + change * uy, torque + change * arm
    return fx - acting[0], fy - acting[1], torque - acting[2]


@inner_view_kernel
def touch_things(pose: Array, base: Base, things: Things, contacts: Array, touched: int) -> int:
    """Add where the chassis touches walls and furniture to `contacts`; return how many there are then."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    cell = cell_of(pose[0], pose[1], things.frame)
    for k in range(things.first[cell], things.first[cell + 1]):
        item = things.items[k]
        if item >= 0:
            touched = touch_box(pose, cos, sin, base, things.boxes[item], contacts, touched)
        else:
            circle = things.circles[-1 - item]
            touched = touch_circle(pose, cos, sin, base, circle[0], circle[1], circle[2], contacts, touched)
    return touched


@inner_view_kernel
def touch_circle(
    pose: Array, cos: float, sin: float, base: Base, x: float, y: float, radius: float, contacts: Array, touched: int
) -> int:
    """Add where the chassis touches a circle; return how many contacts there are then."""
    dx, dy = x - pose[0], y - pose[1]
    u, v = cos * dx + sin * dy, cos * dy - sin * dx
    near_u = min(max(u, -base.half_length), base.half_length)
    near_v = min(max(v, -base.half_width), base.half_width)
    away = math.hypot(u - near_u, v - near_v)
    if away > radius:
        return touched
    if away > 1e-9:
        nu, nv, depth = (near_u - u) / away, (near_v - v) / away, radius - away
    elif base.half_length - abs(u) < base.half_width - abs(v):
        nu, nv, depth = -math.copysign(1.0, u), 0.0, radius + base.half_length - abs(u)
    else:
        nu, nv, depth = 0.0, -math.copysign(1.0, v), radius + base.half_width - abs(v)
    return _note(pose, cos, sin, (near_u, near_v), (nu, nv), depth, contacts, touched)


@inner_view_kernel
def _note(
    pose: Array,
    cos: float,
    sin: float,
    point: tuple[float, float],
    out: tuple[float, float],
    depth: float,
    contacts: Array,
    touched: int,
) -> int:
    """Add a contact, if there is room for one more; return how many there are then.

    Args:
        pose: (3,) of the chassis.
        cos: Of its heading.
        sin: Of its heading.
        point: Where, in the chassis' frame [m].
        out: Unit vector away from what is touched, in the chassis' frame.
        depth: [m].
        contacts: (MOST_CONTACTS, 5) see `drive`.
        touched: How many there are.
    """
    if touched == len(contacts):
        return touched
    row = contacts[touched]
    row[0], row[1] = pose[0] + cos * point[0] - sin * point[1], pose[1] + sin * point[0] + cos * point[1]
    row[2], row[3], row[4] = cos * out[0] - sin * out[1], sin * out[0] + cos * out[1], depth
    return touched + 1


@inner_view_kernel
def touch_box(pose: Array, cos: float, sin: float, base: Base, box: Array, contacts: Array, touched: int) -> int:
    """Add where the chassis touches a box; return how many contacts there are then.

    By the four directions in which two rectangles can be apart. The way out is the one of least depth; points are the
    corners of each that are in the other.
    """
    dx, dy = box[0] - pose[0], box[1] - pose[1]
    u, v = cos * dx + sin * dy, cos * dy - sin * dx
    c, s = cos * box[2] + sin * box[3], cos * box[3] - sin * box[2]  # the box' yaw in the chassis' frame
    long, wide, half_x, half_y = base.half_length, base.half_width, box[4], box[5]
    least, nu, nv = _way_out((u, v), (c, s), (long, wide), (half_x, half_y))
    if least < 0.0:
        return touched
    across_box = half_x * abs(c * nu + s * nv) + half_y * abs(c * nv - s * nu)
    across_chassis = long * abs(nu) + wide * abs(nv)
    before = touched
    for corner in range(4):
        a, b = (1.0 if corner < 2 else -1.0), (1.0 if corner % 2 else -1.0)
        x, y = a * long - u, b * wide - v  # a corner of the chassis, seen from the box
        if abs(c * x + s * y) <= half_x and abs(c * y - s * x) <= half_y:
            depth = max(min(across_box - nu * x - nv * y, least), 0.0)
            touched = _note(pose, cos, sin, (a * long, b * wide), (nu, nv), depth, contacts, touched)
        x, y = u + a * half_x * c - b * half_y * s, v + a * half_x * s + b * half_y * c  # of the box
        if abs(x) <= long and abs(y) <= wide:
            depth = max(min(across_chassis + nu * x + nv * y, least), 0.0)
            touched = _note(pose, cos, sin, (x, y), (nu, nv), depth, contacts, touched)
    if touched == before:  # two that cross: no corner of either is in the other
        touched = _note(pose, cos, sin, (0.5 * u, 0.5 * v), (nu, nv), least, contacts, touched)
    return touched


@inner_view_kernel
def _way_out(
    centre: tuple[float, float], yaw: tuple[float, float], chassis: tuple[float, float], box: tuple[float, float]
) -> tuple[float, float, float]:
    """Return the least depth of a box in the chassis [m], below 0 where they are apart, and the unit vector out of it.

    All in the chassis' frame: the box' centre [m], cos and sin of its yaw; half sides of both [m].
    """
    (u, v), (c, s), (long, wide), (half_x, half_y) = centre, yaw, chassis, box
    along, aside = abs(c), abs(s)
    by_u, by_v = long + half_x * along + half_y * aside - abs(u), wide + half_x * aside + half_y * along - abs(v)
    if by_u < 0.0 or by_v < 0.0:
        return -1.0, 0.0, 0.0
    p, q = -(c * u + s * v), -(c * v - s * u)  # the chassis, seen from the box
    by_p, by_q = half_x + long * along + wide * aside - abs(p), half_y + long * aside + wide * along - abs(q)
    least = min(by_u, by_v, by_p, by_q)
    if least == by_u:
        return least, -math.copysign(1.0, u), 0.0
    if least == by_v:
        return least, 0.0, -math.copysign(1.0, v)
    if least == by_p:
        return least, math.copysign(1.0, p) * c, math.copysign(1.0, p) * s
    return least, -math.copysign(1.0, q) * s, math.copysign(1.0, q) * c
