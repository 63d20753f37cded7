"""Episodes of many worlds: begun, stepped, judged and ended inside compiled calls."""

import math

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.selection import forget_leader
from ...slam.draws import mixed
from ...slam.processes.turns import Turns, next_slice
from ...slam.view_kernel import inner_view_kernel, spliced_kernel, view_kernel
from ..oracle import SAME_PERSON_M
from ..people.behaviours.leader import DONE
from ..task.endings import ending_code
from ..task.rewards import following_terms
from ..tracker_errors.kernel import forget
from ..world.config import TICK
from .copying import copy_row, copy_rows
from .moving import advance
from .perceiving import believe, perceive
from .plans import Plans
from .rules import Rules
from .state import Array, Floats, Scratch, Told, WorldsState

STEP, BEGIN, BEGIN_AGAIN, REST = 0, 1, 2, 3
"""What to do with a world: go on, begin the episode in its own row, begin one of those drawn ahead, or nothing."""


@view_kernel
def step_worlds(
    turns: Turns,
    what: NDArray[np.int8],
    actions: Array,
    rules: Rules,
    plans: Plans,
    state: WorldsState,
    told: Told,
    room: Scratch,
) -> None:
    """Do in each world what is asked for; what is told of it is written.

    Args:
        turns: At the worlds.
        what: (w,) `STEP`, `BEGIN`, `BEGIN_AGAIN` or `REST`.
        actions: (w, a) in any range; cut to [-1, 1].
        rules: What never changes.
        plans: The episodes.
        state: All worlds.
        told: What is told of them.
        room: Scratch of this thread.
    """
    first, end = next_slice(turns)
    while first < end:
        for w in range(first, end):
            if what[w] != REST:
                step_world(w, what[w], actions[w], rules, plans, state, told, room)
        first, end = next_slice(turns)


@spliced_kernel
def step_world(
    w: int, what: int, action: Array, rules: Rules, plans: Plans, state: WorldsState, told: Told, room: Scratch
) -> None:
    """Do in world w what is asked for, as `step_worlds`."""
    _go_on(w, what, action, rules, plans, state, told, room)
    believe(w, rules, plans, state, told, room)
    _judge(w, rules, plans, state, told)


@view_kernel
def sweep_worlds(
    turns: Turns,
    what: NDArray[np.int8],
    actions: Array,
    rules: Rules,
    plans: Plans,
    state: WorldsState,
    told: Told,
    room: Scratch,
) -> None:
    """Do as `step_worlds` up to the sweep, for those who know people by reading it; `judge_worlds` does the rest."""
    first, end = next_slice(turns)
    while first < end:
        for w in range(first, end):
            if what[w] != REST:
                _go_on(w, what[w], actions[w], rules, plans, state, told, room)
        first, end = next_slice(turns)


@spliced_kernel
def _go_on(
    w: int, what: int, action: Array, rules: Rules, plans: Plans, state: WorldsState, told: Told, room: Scratch
) -> None:
    """Step world w, or begin an episode in it, and take a sweep."""
    if what == STEP:
        state.change[w] = _cut(action, state.action[w])
        advance(w, state.action[w, : len(action)], rules, plans, state, room)
        state.steps[w] += 1
    else:
        state.change[w], slot = 0.0, rules.ahead + w
        if what == BEGIN_AGAIN:
            state.episode[w] += 1
            lot = mixed(state.seed[w] ^ mixed(np.uint64(state.episode[w])))
            slot = np.int64(lot % np.uint64(rules.ahead))
        _begin(w, slot, plans, state)  # pyright: ignore[reportArgumentType]
    told.time_s[w] = state.steps[w] * rules.ticks * TICK
    perceive(w, rules, plans, state, told, room)


@view_kernel
def judge_worlds(
    turns: Turns,
    what: NDArray[np.int8],
    rules: Rules,
    plans: Plans,
    state: WorldsState,
    told: Told,
) -> None:
    """Judge what was asked for in each world where others than kernels say what the robots know; as `step_worlds`."""
    first, end = next_slice(turns)
    while first < end:
        for w in range(first, end):
            if what[w] != REST:
                _judge(w, rules, plans, state, told)
        first, end = next_slice(turns)


@inner_view_kernel
def _cut(action: Array, last: Array) -> float:
    """Write an action, cut to [-1, 1], over the last one; return the norm of the change."""
    change = 0.0
    for k in range(len(action)):
        cut = min(max(action[k], -1.0), 1.0)
        change += (cut - last[k]) ** 2
        last[k] = cut
    return math.sqrt(change)


@inner_view_kernel
def _begin(w: int, slot: int, plans: Plans, state: WorldsState) -> None:
    """Put the episode of plan `slot` into world w."""
    n = plans.people[slot]
    state.slot[w], state.steps[w], state.ended[w] = slot, 0, False
    state.random[w, 0] = mixed(state.seed[w] + mixed(np.uint64(state.episode[w]) + np.uint64(1)))
    bodies = state.bodies
    copy_rows(plans.place[slot, :n], bodies.position[w])
    copy_rows(plans.numbers[slot, :n], state.numbers[w])
    copy_row(plans.heading[slot, :n], bodies.heading[w])
    copy_row(plans.arc[slot, :n], bodies.arc[w])
    copy_row(plans.sense[slot, :n], bodies.sense[w])
    copy_row(plans.lateral[slot, :n], bodies.lateral[w])
    for i in range(n):
        copy_rows(plans.feet[slot, i], bodies.feet[w, i])
    bodies.velocity[w], bodies.origin[w], bodies.lift[w], bodies.direction[w] = 0.0, 0.0, 0.0, 0.0
    bodies.phase[w], bodies.wish[w], bodies.swing[w] = 0.0, 0.0, -1
    bodies.face[w], bodies.goal[w] = np.nan, np.nan
    copy_row(plans.start[slot], state.pose[w])
    copy_row(plans.start[slot], state.rolled[w])
    state.speed[w], state.setpoint[w], state.action[w], state.odometry[w] = 0.0, 0.0, 0.0, 0.0
    state.odometry_before[w], state.progress[w, 0], state.open[w] = 0.0, plans.start_arc[slot], 0.0
    state.touches[w], state.lost_s[w] = False, 0.0
    forget_leader(state.leader[w])
    forget(state.tracks[w])


@inner_view_kernel
def _judge(w: int, rules: Rules, plans: Plans, state: WorldsState, told: Told) -> None:
    """Write what is so in world w, and what the step is worth."""
    s, pose, steps = state.slot[w], state.pose[w], state.steps[w]
    position, step_s = state.bodies.position[w, : plans.people[s]], rules.ticks * TICK
    facts, following = told.facts[w], _follows(position, pose, told.leader[w])
    _facts(position, plans.radius[s], pose, rules.robot_radius, state.change[w], facts)
    copy_row(state.odometry[w], told.odometry[w])
    told.robot_pose[w, 0], told.robot_pose[w, 1] = pose[0], pose[1]
    told.robot_pose[w, 2] = (pose[2] + np.pi) % (2.0 * np.pi) - np.pi
    state.lost_s[w] = 0.0 if following or steps == 0 else state.lost_s[w] + step_s
    told.following[w], told.lost_s[w] = following, state.lost_s[w]
    if steps == 0:
        told.reward[w], told.terms[w], told.ending[w] = 0.0, 0.0, 0
        told.terminated[w] = told.truncated[w] = told.touched[w] = told.done[w] = False
        return
    done = state.numbers[w, 0, DONE] > 0.0 and facts[0] < 2.0
    person, static, ends = state.touches[w, 0], state.touches[w, 1], rules.ends_on_contact
    told.touched[w], told.done[w] = person or static, done
    following_terms(facts, following, person or static, done, step_s, rules.weights, rules.shapes, told.terms[w])
    told.reward[w] = told.terms[w].sum()
    told.ending[w] = ending_code(person and ends, static and ends, done, False, state.lost_s[w] > rules.lost_limit_s)
    told.terminated[w], told.truncated[w] = told.ending[w] > 0, 0 < rules.limit <= steps
    state.ended[w] = told.terminated[w] or told.truncated[w]


@inner_view_kernel
def _facts(position: Array, radius: Array, pose: Array, robot_radius: float, change: float, facts: Array) -> None:
    """Write distance and bearing of the leader, free space to the others, and the action's change into `facts`."""
    space = np.inf
    for i in range(1, len(position)):
        dx, dy = position[i, 0] - pose[0], position[i, 1] - pose[1]
        space = min(space, math.sqrt(dx * dx + dy * dy) - radius[i] - robot_radius)
    dx, dy = position[0, 0] - pose[0], position[0, 1] - pose[1]
    facts[0], facts[1] = math.hypot(dx, dy), (math.atan2(dy, dx) - pose[2] + np.pi) % (2.0 * np.pi) - np.pi
    facts[2], facts[3] = space, change


@inner_view_kernel
def _follows(position: Array, pose: Array, leader: Floats) -> bool:
    """Return whether the robot sees a leader, and it is truly the one: the first of the people."""
    if leader[5] == 0.0:
        return False
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    x, y = pose[0] + cos * leader[0] - sin * leader[1], pose[1] + sin * leader[0] + cos * leader[1]
    own = math.hypot(position[0, 0] - x, position[0, 1] - y)
    for i in range(1, len(position)):
        if math.hypot(position[i, 0] - x, position[i, 1] - y) < own:
            return False
    return own <= SAME_PERSON_M
