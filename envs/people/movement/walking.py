"""How people move: along a route, round each other, the robot and the furniture, without overlaps."""

import math

import numpy as np
from numpy.typing import NDArray

from ....slam.view_kernel import inner_view_kernel, kernel, view_kernel
from .obstacles import is_clear, nearest_of_box, nearest_of_rectangle
from .social_force import pair_force
from .things import Things, cell_of, keep_clear

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

SPACING = 0.1
"""Distance of the points of a walker's path [m]."""
_LOOK_AHEAD = 0.8
_BESIDE = 0.03
_EVADE = 0.9
_PATIENCE = 0.6
_UNMOVED = 1.5


@view_kernel
def locate(position: Array, arc: Array, path: Array, tangent: Array, first: Ints, count: Ints) -> None:
    """Update `arc` (n,), the way of each person along their path [m], by a search near its last value.

    Args:
        position: (n, 2) [m].
        arc: (n,) updated.
        path: (m, 2) points of all paths, one path after the other, `SPACING` apart [m].
        tangent: (m, 2) unit vectors along them.
        first: (n,) row of `path` at which the path of each person begins.
        count: (n,) how many rows it has.
    """
    for i in range(len(arc)):
        last, base = count[i] - 1, first[i]
        middle = int(arc[i] / SPACING)
        best, found = np.inf, middle
        for k in range(max(0, middle - 6), min(last, middle + 7) + 1):
            away = (position[i, 0] - path[base + k, 0]) ** 2 + (position[i, 1] - path[base + k, 1]) ** 2
            if away < best:
                best, found = away, k
        along = (position[i, 0] - path[base + found, 0]) * tangent[base + found, 0]
        along += (position[i, 1] - path[base + found, 1]) * tangent[base + found, 1]
        arc[i] = min(max(found * SPACING + min(max(along, -SPACING), SPACING), 0.0), last * SPACING)


@kernel
def free_sides(path: Array, tangent: Array, boxes: Array, circles: Array, clearance: float, furthest: float) -> Array:
    """Return (m, 2) how far one can walk to the left and to the right of each point of `path` (m, 2) [m].

    Args:
        path: (m, 2) points [m].
        tangent: (m, 2) unit vectors along it.
        boxes: (b, 6) see `nearest_of_box`.
        circles: (c, 3) x, y, radius [m].
        clearance: Distance to keep from all of them [m].
        furthest: Where to stop looking [m].
    """
    step = 0.05
    found = np.zeros((len(path), 2))
    near, reach = np.empty((len(boxes), 6)), furthest + 2.0 * clearance + step
    for k in range(len(path)):
        close = 0
        for b in range(len(boxes)):
            aside = abs(boxes[b, 0] - path[k, 0]) + abs(boxes[b, 1] - path[k, 1])
            if aside < boxes[b, 4] + boxes[b, 5] + 1.5 * reach:
                near[close] = boxes[b]
                close += 1
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            free = 0.0
            while free < furthest:
                x = path[k, 0] - sign * (free + step) * tangent[k, 1]
                y = path[k, 1] + sign * (free + step) * tangent[k, 0]
                if not is_clear(x, y, near[:close], circles, clearance):
                    break
                free += step
            found[k, side] = free
    return found


@inner_view_kernel
def wanted_directions(
    position: Array,
    arc: Array,
    sense: Array,
    lateral: Array,
    path: Array,
    tangent: Array,
    first: Ints,
    count: Ints,
    direction: Array,
) -> None:
    """Write the unit vector `direction` (n, 2) towards the point a little further along each person's path.

    Args:
        position: (n, 2) [m].
        arc: (n,) way along the path [m].
        sense: (n,) +1 along the path, -1 against it.
        lateral: (n,) wanted offset from the path, left of its direction positive [m].
        path: (m, 2) points of all paths, see `locate`.
        tangent: (m, 2) unit vectors along them.
        first: (n,) where each person's path begins in `path`.
        count: (n,) how many rows it has.
        direction: (n, 2) written.
    """
    for i in range(len(arc)):
        last = count[i] - 1
        at = (arc[i] + sense[i] * _LOOK_AHEAD) / SPACING
        beyond = at - min(max(at, 0.0), float(last))
        at -= beyond
        k = min(int(at), last - 1)
        part = at - k
        k += first[i]
        tx, ty = tangent[k, 0], tangent[k, 1]
        x = path[k, 0] + part * (path[k + 1, 0] - path[k, 0]) + beyond * SPACING * tx - lateral[i] * ty - position[i, 0]
        y = path[k, 1] + part * (path[k + 1, 1] - path[k, 1]) + beyond * SPACING * ty + lateral[i] * tx - position[i, 1]
        length = max(math.sqrt(x * x + y * y), 1e-6)
        direction[i, 0], direction[i, 1] = x / length, y / length


@inner_view_kernel
def _patience(
    i: int, position: Array, direction: Array, speed: float, radius: Array, heedless: bool, robot: Array
) -> float:
    """Return the share in [0, 1] of the wanted speed that those who stand in the way leave to person i."""
    share = 1.0
    for j in range(len(position) if heedless else len(position) + 1):
        if j == i:
            continue
        if j < len(position):
            x, y, room = position[j, 0] - position[i, 0], position[j, 1] - position[i, 1], radius[i] + radius[j]
        else:
            x, y, room = robot[0] - position[i, 0], robot[1] - position[i, 1], radius[i] + robot[7]
        along = x * direction[i, 0] + y * direction[i, 1]
        across = abs(x * direction[i, 1] - y * direction[i, 0])
        if along > 0.0 and across < room + 0.05:
            free = along - room - 0.12
            share = min(share, max(0.0, free / (_PATIENCE * speed + 0.05)))
    return share


@view_kernel
def advance_bodies(
    dt: float,
    position: Array,
    velocity: Array,
    heading: Array,
    direction: Array,
    wish: Array,
    radius: Array,
    heedless: NDArray[np.bool_],
    robot: Array,
    things: Things,
    force: Array,
    before: Array,
) -> None:
    """Move n people for `dt` seconds, in place.

    Args:
        dt: Time [s].
        position: (n, 2) [m].
        velocity: (n, 2) [m/s].
        heading: (n,) [rad]; people turn before they walk.
        direction: (n, 2) unit vectors of the wanted walk.
        wish: (n,) wanted speeds [m/s]; 0 stands.
        radius: (n,) of the bodies [m].
        heedless: (n,) who neither keeps a distance from the robot nor waits for it, and only walks round it.
        robot: (8,) x, y, cos, sin of its pose, velocity x and y [m/s], half length, half width [m].
        things: Furniture and walls.
        force: (9,) `SocialForceConfig.as_array()`.
        before: (n, 2) written: where they were [m].
    """
    n = len(position)
    for i in range(n):
        before[i, 0], before[i, 1] = position[i, 0], position[i, 1]
    for i in range(n):
        fx, fy = _forces(i, position, velocity, radius, heedless[i], robot, things, force)
        if wish[i] == 0.0 and fx * fx + fy * fy < _UNMOVED * _UNMOVED:
            fx, fy = 0.0, 0.0
        facing = math.cos(heading[i]) * direction[i, 0] + math.sin(heading[i]) * direction[i, 1]
        speed = wish[i] * min(max(1.5 * facing, 0.0), 1.0)
        if speed > 0.0:
            speed *= _patience(i, before, direction, speed, radius, heedless[i], robot)
        fx += (speed * direction[i, 0] - velocity[i, 0]) / force[0]
        fy += (speed * direction[i, 1] - velocity[i, 1]) / force[0]
        _move(dt, i, fx, fy, max(1.2 * wish[i], 0.6), position, velocity)
    for _ in range(4):
        if not _part(dt, position, radius, robot, things):
            break
    for i in range(n):
        velocity[i, 0] = (position[i, 0] - before[i, 0]) / dt
        velocity[i, 1] = (position[i, 1] - before[i, 1]) / dt


@inner_view_kernel
def _move(dt: float, i: int, fx: float, fy: float, fastest: float, position: Array, velocity: Array) -> None:
    """Accelerate person i by a force [m/s^2], at most 3 m/s^2 and up to the speed `fastest`, and move them."""
    strength = math.sqrt(fx * fx + fy * fy)
    scale = 3.0 / strength if strength > 3.0 else 1.0
    velocity[i, 0] += dt * fx * scale
    velocity[i, 1] += dt * fy * scale
    now = math.sqrt(velocity[i, 0] * velocity[i, 0] + velocity[i, 1] * velocity[i, 1])
    slower = fastest / now if now > fastest else 1.0
    velocity[i, 0] *= slower
    velocity[i, 1] *= slower
    position[i, 0] += dt * velocity[i, 0]
    position[i, 1] += dt * velocity[i, 1]


@inner_view_kernel
def _forces(
    i: int,
    position: Array,
    velocity: Array,
    radius: Array,
    heedless: bool,
    robot: Array,
    things: Things,
    force: Array,
) -> tuple[float, float]:
    """Return the force on person i of the others, the robot and the obstacles [m/s^2]."""
    x, y, vx, vy = position[i, 0], position[i, 1], velocity[i, 0], velocity[i, 1]
    fx = fy = 0.0
    if not heedless:
        fx, fy = pair_force(robot[0] - x, robot[1] - y, vx - robot[4], vy - robot[5], 0.1, force)
    for j in range(len(position)):
        if j != i:
            px, py = pair_force(
                position[j, 0] - x, position[j, 1] - y, vx - velocity[j, 0], vy - velocity[j, 1], 0.0, force
            )
            fx, fy = fx + px, fy + py
    px, py = _force_of_things(x, y, radius[i], things, force)
    return fx + px, fy + py


@inner_view_kernel
def _force_of_things(x: float, y: float, radius: float, things: Things, force: Array) -> tuple[float, float]:
    """Return the force of walls and furniture on a body at a point [m/s^2]."""
    fx = fy = 0.0
    reach, threshold = force[7], force[8]
    cell = cell_of(x, y, things.frame)
    for k in range(things.first[cell], things.first[cell + 1]):
        item = things.items[k]
        if item >= 0:
            distance, ux, uy = nearest_of_box(x, y, things.boxes[item])
            distance -= radius
        else:
            circle = things.circles[-1 - item]
            ux, uy = x - circle[0], y - circle[1]
            away = max(math.sqrt(ux * ux + uy * uy), 1e-6)
            ux, uy = ux / away, uy / away
            distance = away - circle[2] - radius
        if distance < threshold:
            push = force[6] * math.exp(-max(distance, 0.0) / reach)
            fx, fy = fx + push * ux, fy + push * uy
    return fx, fy


@inner_view_kernel
def _part(dt: float, position: Array, radius: Array, robot: Array, things: Things) -> bool:
    """Push apart who overlaps: from each other, from the robot (no faster than a person evades), from obstacles.

    Return whether anybody was pushed: if nobody was, nobody would be by doing it again.
    """
    n, pushed = len(position), False
    for i in range(n):
        for j in range(i + 1, n):
            dx, dy = position[j, 0] - position[i, 0], position[j, 1] - position[i, 1]
            room = radius[i] + radius[j] + _BESIDE
            if dx * dx + dy * dy < room * room:
                away = max(math.sqrt(dx * dx + dy * dy), 1e-6)
                push = (room - away) / 2.0
                position[i, 0] -= push * dx / away
                position[i, 1] -= push * dy / away
                position[j, 0] += push * dx / away
                position[j, 1] += push * dy / away
                pushed = True
    for i in range(n):
        room = radius[i] + _BESIDE
        x, y = _beside_robot(position[i, 0], position[i, 1], room, _EVADE * dt / 4.0, robot)
        x, y = keep_clear(x, y, room, things)
        pushed = pushed or x != position[i, 0] or y != position[i, 1]
        position[i, 0], position[i, 1] = x, y
    return pushed


@inner_view_kernel
def _beside_robot(x: float, y: float, room: float, fastest: float, robot: Array) -> tuple[float, float]:
    """Return the point (x, y) moved away from the robot's chassis where it is nearer than `room`, at most so far [m].

    `robot` as in `advance_bodies`.
    """
    dx, dy = x - robot[0], y - robot[1]
    along, across = robot[2] * dx + robot[3] * dy, robot[2] * dy - robot[3] * dx
    if abs(along) >= robot[6] + room or abs(across) >= robot[7] + room:
        return x, y
    distance, ux, uy = nearest_of_rectangle(along, across, robot[2], robot[3], robot[6], robot[7])
    push = min(room - distance, fastest)
    return (x + push * ux, y + push * uy) if push > 0.0 else (x, y)


@inner_view_kernel
def turn_bodies(dt: float, velocity: Array, direction: Array, wish: Array, face: Array, heading: Array) -> None:
    """Turn `heading` (n,) in place, at most 2.6 rad/s.

    Walkers turn towards their walk, those who want to walk (`wish` > 0) towards the wanted `direction` (n, 2), others
    towards `face` (n,) [rad], where NaN stays.
    """
    for i in range(len(heading)):
        wanted = face[i]
        if wish[i] > 0.0:
            wanted = math.atan2(direction[i, 1], direction[i, 0])
            along = velocity[i, 0] * direction[i, 0] + velocity[i, 1] * direction[i, 1]
            if along > 0.15:
                wanted = math.atan2(velocity[i, 1], velocity[i, 0])
        if math.isfinite(wanted):
            error = (wanted - heading[i] + np.pi) % (2.0 * np.pi) - np.pi
            step = min(max(error, -2.6 * dt), 2.6 * dt)
            heading[i] = (heading[i] + step + np.pi) % (2.0 * np.pi) - np.pi
