"""What plans would cost: each is driven in thought among what stands and what moves. Compiled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .fields import value_at
from .unseen import HALF_M as UNSEEN_HALF_M
from .unseen import PLACES_M

Array = NDArray[np.float64]


HARM_MPS = 0.5
"""Who comes faster than this harms [m/s]: slower, people in a queue push past each other."""
LEAST_HARM = 0.05
"""What share of a contact counts at which the robot stands."""
PERSONAL_SPACE_M = 0.45
HIDES_M = 0.4
"""Who is farther than this from a line of sight does not hide what is behind [m]: a body, and its stride."""
BLOCKS_M = 0.15
"""What stands nearer than this to a line of sight begins to hide what is behind [m]."""
MUCH_M2 = 1.0
"""New ground of this area is worth 0.63 of what any is."""
HELD_M = 2.0
"""From where the leader is hidden or not ahead, or the way to it so much too long, new ground is worth nothing."""


class PlanningScene(NamedTuple):
    """What the kernel is told of a step; robot frame of now.

    Attributes:
        distances: (n, n) distance from what stands [m].
        returns: (n, n) the same from all that the laser met, people who walk among it, but not the leader [m].
        way_now: (m, m) length of the way to where the leader is [m].
        way_then: (m, m) the same to where it will be at the end of the horizon [m].
        cells: (3,) half of the fields' side, side of a cell of the first and of the others [m].
        people: (k, t, 2) where people will be, the leader last [m].
        motion: (3, 2) commanded velocity forward, left, turn, and their rates.
        room_behind: How far back the ground is known to be free [m].
        unseen: (u, u) `unseen.unseen_field`; (0, 0) where it is worth nothing.
    """

    distances: Array
    returns: Array
    way_now: Array
    way_then: Array
    cells: Array
    people: Array
    motion: Array
    room_behind: float
    unseen: Array


class Body(NamedTuple):
    """What the kernel is told of the robot.

    Attributes:
        limits: (3, 7) for forward, left, turn: least and greatest velocity, time constant [s], greatest acceleration
            and braking, jerk and jerk of braking.
        discs: (d, 2) middles of discs that cover the robot's outline [m].
        disc_radius: Their radius [m].
        half_length: Of the robot [m].
        half_width: Of the robot [m].
        laser: (4,) x, y of the laser [m], direction of its rightmost beam, and its field of view [rad].
    """

    limits: Array
    discs: Array
    disc_radius: float
    half_length: float
    half_width: float
    laser: Array


class Prices(NamedTuple):
    """What the kernel is told of the costs; `PriceConfig` explains them."""

    keep: float
    way: float
    end: float
    facing: float
    sight: float
    tight: float
    comfort: float
    people: float
    space: float
    person_radius: float
    spread: float
    spread_rate: float
    touch: float
    still: float
    effort: float
    turning: float
    back: float
    unseen: float


@kernel
def axis_step(v: float, a: float, wish: float, dt: float, c: Array) -> tuple[float, float]:
    """Return velocity and acceleration of one axis after `dt`, on the way to `wish`; as `learned.steering.steer`."""
    brakes = (wish - v) * v < 0.0
    most = c[4] if brakes else c[3]
    change = (c[6] if brakes else c[5]) * dt
    wanted = min(max((wish - v) / c[2], -most), most)
    a = min(max(wanted, a - change), a + change)
    return min(max(v + a * dt, c[0]), c[1]), a


@kernel
def harm(speed: float) -> float:
    """Return what share of a contact counts at which the robot comes at `speed` [m/s]."""
    return min(max(speed / HARM_MPS, LEAST_HARM), 1.0)


@kernel
def drive(motion: Array, pose: Array, wish: Array, dt: float, body: Body, turning: float) -> float:
    """Drive `motion` (3, 2) and `pose` (3,) on by `dt`, in place; return the square of the jerk, turning among it."""
    jerk = 0.0
    for axis in range(3):
        before = motion[axis, 1]
        motion[axis, 0], motion[axis, 1] = axis_step(motion[axis, 0], before, wish[axis], dt, body.limits[axis])
        change = (motion[axis, 1] - before) / dt
        jerk += change * change * (turning if axis == 2 else 1.0)
    middle = pose[2] + 0.5 * motion[2, 0] * dt
    cos, sin = np.cos(middle), np.sin(middle)
    pose[0] += (motion[0, 0] * cos - motion[1, 0] * sin) * dt
    pose[1] += (motion[0, 0] * sin + motion[1, 0] * cos) * dt
    pose[2] += motion[2, 0] * dt
    return jerk


@kernel
def gap_to_things(pose: Array, far: float, field: Array, scene: PlanningScene, body: Body) -> float:
    """Return the gap between the robot's outline and the nearest thing of a field of distances, at most `far` [m]."""
    half, cell = scene.cells[0], scene.cells[1]
    around = value_at(field, pose[0], pose[1], half, cell) - np.hypot(body.half_length, body.half_width)
    if around >= far:
        return far
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    least = far
    for d in range(len(body.discs)):
        x = pose[0] + cos * body.discs[d, 0] - sin * body.discs[d, 1]
        y = pose[1] + sin * body.discs[d, 0] + cos * body.discs[d, 1]
        least = min(least, value_at(field, x, y, half, cell) - body.disc_radius)
    return least


@kernel
def person_costs(
    pose: Array, motion: Array, k: int, t: float, scene: PlanningScene, body: Body, p: Prices
) -> tuple[float, float]:
    """Return the greatest chance of a contact with a person at evaluation `k`, time `t` [s], and lack of space.

    A contact counts in full where the robot drives into somebody (`harm`); little where it stands and they come, or
    where they walk ahead as fast as it.
    """
    spread = p.spread + p.spread_rate * t
    certain = 0.25 / (0.25 + 2.0 * spread * spread)  # that a normal deviate comes within 0.5 m at all
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    chance = lack = 0.0
    for j in range(len(scene.people)):
        dx, dy = scene.people[j, k, 0] - pose[0], scene.people[j, k, 1] - pose[1]
        away = max(np.hypot(dx, dy), 1e-3)
        if away > 3.0:
            continue
        ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
        beyond, beside = max(abs(ahead) - body.half_length, 0.0), max(abs(aside) - body.half_width, 0.0)
        gap = np.hypot(beyond, beside) - p.person_radius
        own = (motion[0, 0] * ahead + motion[1, 0] * aside) / away
        first = max(k, 1)
        mx = scene.people[j, first, 0] - scene.people[j, first - 1, 0]
        my = scene.people[j, first, 1] - scene.people[j, first - 1, 1]
        theirs = (mx * dx + my * dy) / away * (k + 1.0) / t
        near = max(gap, 0.0) / spread
        chance = max(chance, harm(min(own, own - theirs)) * certain * np.exp(-0.5 * near * near))
        lack = max(lack, 1.0 - gap / PERSONAL_SPACE_M)
    return chance, lack


@kernel
def hidden(pose: Array, k: int, scene: PlanningScene, body: Body) -> float:
    """Return how hidden the leader is from the laser at evaluation `k`: 0 seen, 1 behind a thing, a person or it."""
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    x = pose[0] + cos * body.laser[0] - sin * body.laser[1]
    y = pose[1] + sin * body.laser[0] + cos * body.laser[1]
    dx, dy = scene.people[-1, k, 0] - x, scene.people[-1, k, 1] - y
    away = max(np.hypot(dx, dy), 1e-3)
    if (np.arctan2(dy, dx) - pose[2] - body.laser[2]) % (2.0 * np.pi) > body.laser[3]:
        return 1.0
    most = 0.0
    for j in range(len(scene.people) - 1):
        px, py = scene.people[j, k, 0] - x, scene.people[j, k, 1] - y
        if 0.0 < px * dx + py * dy < away * away:
            most = max(most, 1.0 - abs(px * dy - py * dx) / away / HIDES_M)
    steps = int(away / BLOCKS_M)
    for i in range(1, steps):
        part = i / steps
        if away * (1.0 - part) < 2.0 * BLOCKS_M:  # the leader's own returns, and the wall that it walks along
            break
        gap = value_at(scene.distances, x + part * dx, y + part * dy, scene.cells[0], scene.cells[1])
        most = max(most, 1.0 - gap / BLOCKS_M)
    return most


@kernel
def judge(
    pose: Array, motion: Array, k: int, t: float, scene: PlanningScene, body: Body, p: Prices, worst: Array
) -> tuple[float, float]:
    """Judge a place at evaluation `k`, time `t` [s]: return how much too long the way is [m], and what else it costs.

    Updates `worst` (5,): tightness, touching of things, chance of a contact with a person, lack of space, and what new
    ground comes into sight, each less where it comes later, as there is time to plan anew.
    """
    count = scene.people.shape[1]
    share, half, cell = (k + 1.0) / count, scene.cells[0], scene.cells[2]
    later, soon = 1.0 - 0.5 * share, 1.0 - 0.9 * share
    way = (1.0 - share) * value_at(scene.way_now, pose[0], pose[1], half, cell)
    lag = way + share * value_at(scene.way_then, pose[0], pose[1], half, cell) - p.keep
    gap = gap_to_things(pose, p.comfort, scene.distances, scene, body)
    worst[0] = max(worst[0], later * (1.0 - gap / p.comfort) ** 2)
    if gap < 0.02:
        worst[1] = max(worst[1], later * (1.0 + (0.02 - gap) / 0.05))
    chance, lack = person_costs(pose, motion, k, t, scene, body, p)
    worst[2], worst[3] = max(worst[2], soon * chance), max(worst[3], later * lack)
    if t <= p.still and gap_to_things(pose, p.comfort, scene.returns, scene, body) < 0.02:
        worst[2] = max(worst[2], harm(np.hypot(motion[0, 0], motion[1, 0])))
    bearing = np.arctan2(scene.people[-1, k, 1] - pose[1], scene.people[-1, k, 0] - pose[0]) - pose[2]
    cost = p.facing * (0.5 - 0.5 * np.cos(bearing)) / count
    if (k + 1) % 5 == 0:
        lost = hidden(pose, k, scene, body)
        cost += p.sight * later * lost
        if len(scene.unseen):
            area = value_at(scene.unseen, pose[0], pose[1], UNSEEN_HALF_M, PLACES_M)
            held = (1.0 - lost) * max(1.0 - max(lag, 0.0) / HELD_M, 0.0) * max(np.cos(bearing), 0.0)
            worst[4] = max(worst[4], later * held * (1.0 - np.exp(-area / MUCH_M2)))
    return lag, cost


@kernel
def plan_cost(plan: Array, knot_s: float, dt: float, every: int, scene: PlanningScene, body: Body, p: Prices) -> float:
    """Return what one plan (m, 3) of wishes, `knot_s` [s] apart, would cost."""
    count = scene.people.shape[1]
    motion, pose, worst, wish = scene.motion.copy(), np.zeros(3), np.zeros(5), np.zeros(3)
    cost = jerk = back = lag = 0.0
    for step in range(count * every):
        at = step * dt / knot_s
        i = min(int(at), len(plan) - 2)
        part = min(at - i, 1.0)
        for axis in range(3):
            wish[axis] = plan[i, axis] + part * (plan[i + 1, axis] - plan[i, axis])
        jerk += drive(motion, pose, wish, dt, body, p.turning)
        back = max(back, -pose[0])
        if (step + 1) % every == 0:
            lag, more = judge(pose, motion, (step + 1) // every - 1, (step + 1) * dt, scene, body, p, worst)
            cost += more + p.way / count * (lag if lag > 0.0 else -1.5 * lag)
    cost += p.end * abs(lag) + p.tight * worst[0] + p.touch * worst[1] + p.people * worst[2]
    cost += p.space * worst[3] * worst[3] + p.effort * jerk / (count * every) - p.unseen * worst[4]
    return cost + p.back * max(back - scene.room_behind, 0.0)


@kernel
def plan_costs(
    plans: Array, knot_s: float, dt: float, every: int, scene: PlanningScene, body: Body, p: Prices
) -> Array:
    """Return (n,) what each of `plans` (n, m, 3) would cost.

    Args:
        plans: Wishes forward, left [m/s] and turn [rad/s] at knots, in straight lines between them.
        knot_s: Time between knots [s].
        dt: Step of the drive [s].
        every: So many steps are driven from one evaluation to the next.
        scene: What is scene.
        body: The robot.
        p: Costs.
    """
    costs = np.empty(len(plans))
    for n in range(len(plans)):
        costs[n] = plan_cost(plans[n], knot_s, dt, every, scene, body, p)
    return costs
