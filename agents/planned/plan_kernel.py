"""What plans would cost: each is driven in thought among what stands and what moves. Compiled."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .fields import value_at

Array = NDArray[np.float64]


class Scene(NamedTuple):
    """What the kernel is told of a step; robot frame of now.

    Attributes:
        distances: (n, n) distance from what stands [m].
        returns: (n, n) the same from all that the laser met, people who walk among it, but not the leader [m].
        way_now: (m, m) length of the way to where the leader is [m].
        way_then: (m, m) the same to where it will be at the end of the horizon [m].
        cells: (3,) half of the fields' side, side of a cell of the first and of the others [m].
        leader: (t, 2) where the leader will be [m].
        people: (k, t, 2) where people will be, the leader last [m].
        state: (3, 2) commanded velocity forward, left, turn, and their rates.
        room_behind: How far back the ground is known to be free [m].
    """

    distances: Array
    returns: Array
    way_now: Array
    way_then: Array
    cells: Array
    leader: Array
    people: Array
    state: Array
    room_behind: float


class Body(NamedTuple):
    """What the kernel is told of the robot.

    Attributes:
        limits: (3, 7) for forward, left, turn: least and greatest velocity, time constant [s], greatest acceleration
            and braking, jerk and jerk of braking.
        discs: (d, 2) middles of discs that cover the robot's outline [m].
        disc_radius: Their radius [m].
        half_length: Of the robot [m].
        half_width: Of the robot [m].
        laser: (4,) x, y of the laser [m], bearings of its first and its last beam [rad].
    """

    limits: Array
    discs: Array
    disc_radius: float
    half_length: float
    half_width: float
    laser: Array


class Prices(NamedTuple):
    """What the kernel is told of the costs; `MPPIConfig` explains them."""

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


@njit(cache=True, nogil=True)
def axis_step(v: float, a: float, wish: float, dt: float, c: Array) -> tuple[float, float]:
    """Return velocity and acceleration of one axis after `dt`, on the way to `wish`; as `learned.steering.steer`."""
    brakes = (wish - v) * v < 0.0
    most = c[4] if brakes else c[3]
    change = (c[6] if brakes else c[5]) * dt
    wanted = min(max((wish - v) / c[2], -most), most)
    a = min(max(wanted, a - change), a + change)
    return min(max(v + a * dt, c[0]), c[1]), a


@njit(cache=True, nogil=True)
def gap_to_things(x: float, y: float, cos: float, sin: float, far: float, field: Array, scene: Scene, body: Body) -> float:
    """Return the gap between the robot's outline and the nearest thing of a field of distances, at most `far` [m]."""
    half, cell = scene.cells[0], scene.cells[1]
    around = value_at(field, x, y, half, cell) - np.hypot(body.half_length, body.half_width)
    if around >= far:
        return far
    least = far
    for d in range(len(body.discs)):
        px = x + cos * body.discs[d, 0] - sin * body.discs[d, 1]
        py = y + sin * body.discs[d, 0] + cos * body.discs[d, 1]
        least = min(least, value_at(field, px, py, half, cell) - body.disc_radius)
    return least


@njit(cache=True, nogil=True)
def person_costs(
    x: float,
    y: float,
    cos: float,
    sin: float,
    ahead_v: float,
    aside_v: float,
    k: int,
    t: float,
    scene: Scene,
    body: Body,
    p: Prices,
) -> tuple[float, float]:
    """Return the greatest chance of a contact with a person at evaluation `k`, time `t` [s], and lack of space.

    A contact counts in full where the robot drives into somebody (`harm`); little where it stands and they come, or
    where they walk ahead as fast as it.
    """
    spread = p.spread + p.spread_rate * t
    certain = 0.25 / (0.25 + 2.0 * spread * spread)
    chance = lack = 0.0
    for j in range(len(scene.people)):
        dx, dy = scene.people[j, k, 0] - x, scene.people[j, k, 1] - y
        away = np.hypot(dx, dy)
        if away > 3.0:
            continue
        ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
        beyond, beside = max(abs(ahead) - body.half_length, 0.0), max(abs(aside) - body.half_width, 0.0)
        gap = np.hypot(beyond, beside) - p.person_radius
        own = (ahead_v * ahead + aside_v * aside) / max(away, 1e-3)
        first = max(k, 1)
        mx = scene.people[j, first, 0] - scene.people[j, first - 1, 0]
        my = scene.people[j, first, 1] - scene.people[j, first - 1, 1]
        theirs = (mx * dx + my * dy) / max(away, 1e-3) * (k + 1.0) / t
        near = max(gap, 0.0) / spread
        chance = max(chance, harm(min(own, own - theirs)) * certain * np.exp(-0.5 * near * near))
        lack = max(lack, 1.0 - gap / 0.45)
    return chance, lack


@njit(cache=True, nogil=True)
def harm(speed: float) -> float:
    """Return what share of a contact counts at which the robot comes so fast [m/s]: passive safety, but for a rest."""
    return min(max(speed / 0.5, 0.05), 1.0)


@njit(cache=True, nogil=True)
def hidden(x: float, y: float, theta: float, k: int, scene: Scene, body: Body) -> float:
    """Return how hidden the leader is from the robot at evaluation `k`: 0 seen, 1 behind a thing, a person or it."""
    cos, sin = np.cos(theta), np.sin(theta)
    lx, ly = x + cos * body.laser[0] - sin * body.laser[1], y + sin * body.laser[0] + cos * body.laser[1]
    dx, dy = scene.leader[k, 0] - lx, scene.leader[k, 1] - ly
    away = max(np.hypot(dx, dy), 1e-3)
    bearing = (np.arctan2(dy, dx) - theta + np.pi) % (2.0 * np.pi) - np.pi
    if bearing < body.laser[2] or bearing > body.laser[3]:
        return 1.0
    most = 0.0
    for j in range(len(scene.people) - 1):
        px, py = scene.people[j, k, 0] - lx, scene.people[j, k, 1] - ly
        along = (px * dx + py * dy) / away
        if 0.0 < along < away:
            aside = abs(px * dy - py * dx) / away
            most = max(most, 1.0 - aside / 0.4)
    steps = int(away / 0.15)
    for i in range(1, steps):
        part = i / steps
        if away * (1.0 - part) < 0.3:
            break
        gap = value_at(scene.distances, lx + part * dx, ly + part * dy, scene.cells[0], scene.cells[1])
        most = max(most, 1.0 - gap / 0.15)
    return most


@njit(cache=True, nogil=True)
def plan_cost(plan: Array, knot_s: float, dt: float, every: int, scene: Scene, body: Body, p: Prices) -> float:
    """Return what one plan (m, 3) of wishes, `knot_s` [s] apart, would cost."""
    count = scene.leader.shape[0]
    v, a, turn_v, turn_a = scene.state[0, 0], scene.state[0, 1], scene.state[2, 0], scene.state[2, 1]
    u, b = scene.state[1, 0], scene.state[1, 1]
    x = y = theta = 0.0
    track = tight = crowd = lacks = touch = effort = back = facing = unseen = lag = 0.0
    half, cell = scene.cells[0], scene.cells[2]
    for step in range(count * every):
        at = step * dt / knot_s
        i = min(int(at), len(plan) - 2)
        part = min(at - i, 1.0)
        was, was_b, was_turn = a, b, turn_a
        v, a = axis_step(v, a, plan[i, 0] + part * (plan[i + 1, 0] - plan[i, 0]), dt, body.limits[0])
        u, b = axis_step(u, b, plan[i, 1] + part * (plan[i + 1, 1] - plan[i, 1]), dt, body.limits[1])
        turn_v, turn_a = axis_step(turn_v, turn_a, plan[i, 2] + part * (plan[i + 1, 2] - plan[i, 2]), dt, body.limits[2])
        middle = theta + 0.5 * turn_v * dt
        cos, sin = np.cos(middle), np.sin(middle)
        x += (v * cos - u * sin) * dt
        y += (v * sin + u * cos) * dt
        theta += turn_v * dt
        effort += ((a - was) ** 2 + (b - was_b) ** 2 + p.turning * (turn_a - was_turn) ** 2) / (dt * dt)
        back = max(back, -x)
        if (step + 1) % every:
            continue
        k = (step + 1) // every - 1
        share = (k + 1.0) / count
        later = 1.0 - 0.5 * share
        cos, sin = np.cos(theta), np.sin(theta)
        way = (1.0 - share) * value_at(scene.way_now, x, y, half, cell)
        lag = way + share * value_at(scene.way_then, x, y, half, cell) - p.keep
        track += lag if lag > 0.0 else -1.5 * lag
        gap = gap_to_things(x, y, cos, sin, p.comfort, scene.distances, scene, body)
        tight = max(tight, later * (1.0 - gap / p.comfort) ** 2)
        if gap < 0.02:
            touch = max(touch, later * (1.0 + (0.02 - gap) / 0.05))
        chance, lack = person_costs(x, y, cos, sin, v, u, k, (step + 1) * dt, scene, body, p)
        crowd = max(crowd, chance * (1.0 - 0.9 * share))
        if (step + 1) * dt <= p.still and gap_to_things(x, y, cos, sin, p.comfort, scene.returns, scene, body) < 0.02:
            crowd = max(crowd, harm(np.hypot(v, u)))
        lacks = max(lacks, later * lack)
        bearing = np.arctan2(scene.leader[k, 1] - y, scene.leader[k, 0] - x) - theta
        facing += 0.5 - 0.5 * np.cos(bearing)
        if (k + 1) % 5 == 0:
            unseen += later * hidden(x, y, theta, k, scene, body)
    cost = p.way * track / count + p.end * abs(lag) + p.facing * facing / count + p.sight * unseen
    cost += p.tight * tight + p.people * crowd + p.space * lacks * lacks + p.touch * touch
    cost += p.effort * effort / (count * every) + p.back * max(back - scene.room_behind, 0.0)
    return cost


@njit(cache=True, nogil=True)
def plan_costs(plans: Array, knot_s: float, dt: float, every: int, scene: Scene, body: Body, p: Prices) -> Array:
    """Return (n,) what each of `plans` (n, m, 3) would cost.

    Args:
        plans: Wishes forward, left [m/s] and turn [rad/s] at knots, in straight lines between them.
        knot_s: Time between knots [s].
        dt: Step of the drive [s].
        every: So many steps are driven from one evaluation to the next.
        scene: What is around.
        body: The robot.
        p: Costs.
    """
    costs = np.empty(len(plans))
    for n in range(len(plans)):
        costs[n] = plan_cost(plans[n], knot_s, dt, every, scene, body, p)
    return costs
