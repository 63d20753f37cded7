"""One control period of one world: people decide and walk, doors open, the robot drives and touches things."""

import math

from ...slam.draws import Words, normal
from ...slam.view_kernel import inner_view_kernel
from ..people.behaviours.deciding import decide
from ..people.behaviours.mind import Around, Minds
from ..people.movement.ground import Ways
from ..people.movement.walking import locate
from ..people.walk_kernel import Walkers, walk
from ..robot.odometry import believed_motion
from ..world.config import TICK
from ..world.doors import SPEED
from .copying import copy_row
from .driving import Base, cut_command, drive, ramp, touch_box, touch_circle, touch_things
from .plans import HALF_LEAF, Plans, things_of, touchable_of, ways_of
from .rules import Rules
from .state import Array, Scratch, WorldsState, bodies_of


@inner_view_kernel
def advance(w: int, action: Array, rules: Rules, plans: Plans, state: WorldsState, room: Scratch) -> None:
    """Move world w for one control period.

    Args:
        w: Which world.
        action: (2,) or (3,) in [-1, 1].
        rules: What never changes.
        plans: The episodes.
        state: All worlds.
        room: Scratch.
    """
    s = state.slot[w]
    n, group, leaves, opened = (
        int(plans.people[s]),
        int(plans.group[s]),
        plans.leaves[s, : plans.doors[s]],
        state.open[w],
    )
    ways, things, touchable = ways_of(plans, s), things_of(plans, s), touchable_of(plans, s)
    _command(action, rules.top, rules.base, room.wanted)
    pose, speed, setpoint, touches = state.pose[w], state.speed[w], state.setpoint[w], state.touches[w]
    touches[0] = touches[1] = False
    _robot_row(pose, speed, rules.base, room.robot)
    if n > 0:
        _decide(w, s, rules.ticks * TICK, plans, state, ways, room.robot)
    bodies = bodies_of(state.bodies, w, n)
    walkers = Walkers(
        plans.size[s, :n], plans.radius[s, :n], plans.heedless[s, :n], plans.way[s, :n], plans.own_first[s, :n],
        plans.own_count[s, :n],
    )  # fmt: skip
    for tick in range(rules.ticks):
        ramp(setpoint, room.wanted, rules.base, TICK)
        if n > 0:
            _robot_row(pose, speed, rules.base, room.robot)
            walk(TICK, bodies, walkers, group, ways, things, rules.force, room.robot, room.before[:n])
            _turn_doors(leaves, bodies.position, opened)
        for _ in range(rules.substeps):
            touched = touch_things(pose, rules.base, touchable, room.contacts, 0)
            touched = _touch_doors(pose, rules.base, leaves, opened, room.robot[:6], room.contacts, touched)
            touches[1] |= touched > 0
            before = touched
            touched = _touch_people(pose, rules.base, bodies.position, walkers.radius, room.contacts, touched)
            touches[0] |= touched > before
            drive(pose, speed, setpoint, rules.base, room.contacts, touched, room.work)
        copy_row(pose, room.poses[tick])
    _roll(state.random[w], state.odometry[w], state.odometry_before[w], state.rolled[w], plans.errors[s], room.poses,
          room.noise)  # fmt: skip
    room.place[0, 0], room.place[0, 1] = pose[0], pose[1]
    locate(room.place, state.progress[w], ways.points, ways.tangents, ways.first[:1], ways.rows[:1])


@inner_view_kernel
def _command(action: Array, top: Array, base: Base, wanted: Array) -> None:
    """Write the body velocity (3,) that an action asks for, cut to the robot's limits."""
    last = len(action) - 1
    wanted[0], wanted[2] = action[0] * top[0], action[last] * top[2]
    wanted[1] = action[1] * top[1] if last == 2 else 0.0
    cut_command(wanted, base)


@inner_view_kernel
def _robot_row(pose: Array, speed: Array, base: Base, row: Array) -> None:
    """Write the robot (8,) as `advance_bodies` takes it."""
    row[0], row[1], row[2], row[3] = pose[0], pose[1], math.cos(pose[2]), math.sin(pose[2])
    row[4], row[5], row[6], row[7] = speed[0], speed[1], base.half_length, base.half_width


@inner_view_kernel
def _decide(w: int, s: int, period: float, plans: Plans, state: WorldsState, ways: Ways, robot: Array) -> None:
    """Let the people of world w, which plays plan s, wish something for a control period."""
    n = int(plans.people[s])
    b = bodies_of(state.bodies, w, n)
    around = Around(
        b.position, b.velocity, b.direction, b.arc, b.sense, b.lateral, b.wish, b.face, b.goal, plans.way[s, :n],
        plans.ground[s, :n], plans.elsewhere[s, :n], plans.group[s], robot, state.progress[w, 0], ways,
    )  # fmt: skip
    decide(Minds(plans.kind[s, :n], state.numbers[w, :n], plans.script[s, :n]), around, period)


@inner_view_kernel
def _turn_doors(leaves: Array, position: Array, opened: Array) -> None:
    """Open the doors near which somebody is, and go on with those that have begun."""
    for d in range(len(leaves)):
        leaf, near = leaves[d], opened[d] > 0.0
        x, y = leaf[0] + 0.5 * leaf[6] * math.cos(leaf[2]), leaf[1] + 0.5 * leaf[6] * math.sin(leaf[2])
        for person in range(len(position)):
            near = near or math.hypot(position[person, 0] - x, position[person, 1] - y) < leaf[5]
        if near:
            opened[d] = min(1.0, opened[d] + SPEED * TICK / abs(leaf[3]))


@inner_view_kernel
def door_box(leaf: Array, opened: float, box: Array) -> None:
    """Write the box (6,) of a door's leaf that is open so far."""
    yaw = leaf[2] + opened * leaf[3]
    cos, sin = math.cos(yaw), math.sin(yaw)
    half = 0.5 * leaf[6]
    box[0], box[1], box[2], box[3] = leaf[0] + half * cos, leaf[1] + half * sin, cos, sin
    box[4], box[5] = leaf[4], HALF_LEAF


@inner_view_kernel
def _touch_doors(
    pose: Array, base: Base, leaves: Array, opened: Array, box: Array, contacts: Array, touched: int
) -> int:
    """Add the contacts with doors; return how many there are then. `box` is scratch."""
    for d in range(len(leaves)):
        door_box(leaves[d], opened[d], box)
        touched = touch_box(pose, math.cos(pose[2]), math.sin(pose[2]), base, box, contacts, touched)
    return touched


@inner_view_kernel
def _touch_people(pose: Array, base: Base, position: Array, radius: Array, contacts: Array, touched: int) -> int:
    """Add the contacts with people; return how many there are then."""
    reach = math.sqrt(base.half_length**2 + base.half_width**2)
    for i in range(len(position)):
        x, y = position[i, 0], position[i, 1]
        if (x - pose[0]) ** 2 + (y - pose[1]) ** 2 < (reach + radius[i]) ** 2:
            cos, sin = math.cos(pose[2]), math.sin(pose[2])
            touched = touch_circle(pose, cos, sin, base, x, y, radius[i], contacts, touched)
    return touched


@inner_view_kernel
def _roll(
    random: Words, odometry: Array, odometry_before: Array, rolled: Array, errors: Array, poses: Array, noise: Array
) -> None:
    """Let the wheels believe what they measured of the period's `poses` (k, 3), see `WorldsState`."""
    for tick in range(len(poses)):
        for k in range(3):
            noise[tick, k] = normal(random)
    copy_row(odometry, odometry_before)
    odometry[0], odometry[1], odometry[2] = believed_motion(odometry_before, rolled, poses, errors, noise)
    copy_row(poses[len(poses) - 1], rolled)
