"""What the robot of one world measures and believes after a control period."""

import math

import numpy as np

from ...perception.leader.selection import Company, select
from ...slam.draws import Words, normal, until_failure
from ...slam.view_kernel import inner_view_kernel
from ..oracle import FARTHEST_M as KNOWN_M
from ..people.posture import cut_shins
from ..sensors.ray_kernel import measured
from ..task.observation import FASTEST_MPS, FASTEST_TURN
from ..tracker_errors import kernel
from ..world.config import TICK
from .beams import cast_ellipse, cast_rectangle, point_beams
from .entries import leader_entry, people_entry
from .moving import door_box
from .plans import Plans
from .rules import Laser, Rules
from .state import Array, Floats, Scratch, Told, WorldsState, bodies_of, first_of


@inner_view_kernel
def perceive(w: int, rules: Rules, plans: Plans, state: WorldsState, told: Told, room: Scratch) -> None:
    """Take a sweep, and write what the observation of world w tells of it and of the robot's velocity."""
    s, pose, odometry = state.slot[w], state.pose[w], state.odometry[w]
    n, began = int(plans.people[s]), state.steps[w] == 0
    bodies = bodies_of(state.bodies, w, n)
    _start_sweep(pose, rules.laser, room.beams)
    _meet_people(
        pose, bodies.position, bodies.heading, plans.size[s], bodies.feet, bodies.lift, rules.laser, room.ellipse,
        room.beams,
    )  # fmt: skip
    for d in range(plans.doors[s]):
        door_box(plans.leaves[s, d], state.open[w, d], room.robot[:6])
        x, y = _origin(pose, rules.laser)
        cast_rectangle(x, y, room.robot, pose[2] + rules.laser.first, rules.laser.spacing, room.beams)
    boxes, circles = plans.seen_boxes[s, : plans.rectangles[s]], plans.seen_circles[s, : plans.rounds[s]]
    _meet_walls(pose, rules.laser, boxes, circles, room.beams)
    _measure(rules.laser, state.random[w], room.beams[2], told.scan[w], told.ranges[w])
    if began:
        told.velocity[w] = 0.0
    else:
        dt = rules.ticks * TICK / rules.sweeps
        _velocity(state.odometry_before[w], odometry, dt, rules.sweeps, told.velocity[w])


@inner_view_kernel
def believe(w: int, rules: Rules, plans: Plans, state: WorldsState, told: Told, room: Scratch) -> None:
    """Let the robot of world w know people by the sweep just taken, and choose its leader; write both entries."""
    pose, odometry, n, began = state.pose[w], state.odometry[w], int(plans.people[state.slot[w]]), state.steps[w] == 0
    position, velocity = state.bodies.position[w, :n], state.bodies.velocity[w, :n]
    if rules.modelled:
        dt, tracks = 0.0 if began else rules.ticks * TICK, state.tracks[w, : kernel.rows_for(n)]
        _track(dt, pose, position, velocity, room.beams[2], rules, state.random[w], tracks)
        count = _know_tracks(pose, odometry, tracks, room.company)
    else:
        count = _know(pose, odometry, position, velocity, told.time_s[w], room.company)
    known, leader, row = first_of(room.company, count), state.leader[w], -1
    sweeps = 1 if began else rules.sweeps
    for sweep in range(sweeps):
        time_s = told.time_s[w] - (sweeps - 1 - sweep) * rules.ticks * TICK / sweeps
        row = select(leader, known, odometry, time_s, rules.selecting)
    told.tracked[w], told.track[w] = count, leader.track
    leader_entry(leader, odometry, told.leader[w])
    people_entry(row, odometry, known, room.others[:count], told.people[w])


@inner_view_kernel
def _start_sweep(pose: Array, laser: Laser, beams: Array) -> None:
    """Point the beams (3, n) from the robot's pose (3,); they have met nothing yet."""
    point_beams(pose[2], laser.cos_bearing, laser.sin_bearing, beams[0], beams[1])
    beams[2] = np.inf


@inner_view_kernel
def _origin(pose: Array, laser: Laser) -> tuple[float, float]:
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    x, y = laser.mount[0], laser.mount[1]
    return pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y


@inner_view_kernel
def _meet_people(
    pose: Array,
    position: Array,
    heading: Array,
    size: Array,
    feet: Array,
    lift: Array,
    laser: Laser,
    ellipse: Array,
    beams: Array,
) -> None:
    """Let the beams meet the legs of the people, see `WorldsState` and `Plans`; `ellipse` (2, 6) is scratch."""
    x, y = _origin(pose, laser)
    first, reach = pose[2] + laser.first, laser.range_max + 2.0
    for i in range(len(position)):
        if (position[i, 0] - x) ** 2 + (position[i, 1] - y) ** 2 < reach * reach:
            legs = cut_shins(position[i], heading[i], size[i], feet[i], lift[i], laser.height, ellipse)
            for leg in range(legs):
                e = ellipse[leg]
                cast_ellipse(e[0] - x, e[1] - y, e[2], e[3], e[4], e[5], first, laser.spacing, beams)


@inner_view_kernel
def _meet_walls(pose: Array, laser: Laser, boxes: Array, circles: Array, beams: Array) -> None:
    """Let the beams meet boxes (b, 6) and circles (c, 3)."""
    x, y = _origin(pose, laser)
    first, spacing = pose[2] + laser.first, laser.spacing
    for k in range(len(boxes)):
        cast_rectangle(x, y, boxes[k], first, spacing, beams)
    for k in range(len(circles)):
        form, radius = 1.0 / (circles[k, 2] * circles[k, 2]), circles[k, 2]
        cast_ellipse(circles[k, 0] - x, circles[k, 1] - y, form, 0.0, form, radius, first, spacing, beams)


@inner_view_kernel
def _measure(laser: Laser, random: Words, exact: Array, entry: Floats, ranges: Array) -> None:
    """Write a measured sweep as the observation has it: shares of the largest range, 1 where there is no return.

    And, where `ranges` has room, as the laser gives it: inf where nothing was met, NaN where a beam failed [m].
    """
    failing = until_failure(random, laser.dropout)
    for j in range(len(exact)):
        noise = normal(random)
        beyond = exact[j] if exact[j] <= laser.range_max else np.inf
        sigma = laser.sigma_near if beyond <= laser.near else laser.sigma_far
        range_ = measured(beyond, sigma * noise, laser.range_max)
        if j == failing:
            failing += 1 + until_failure(random, laser.dropout)
            range_ = np.nan
        if len(ranges) > 0:
            ranges[j] = range_
        entry[j] = range_ / laser.range_max if laser.range_min <= range_ <= laser.range_max else 1.0


@inner_view_kernel
def _track(
    dt: float, pose: Array, position: Array, velocity: Array, exact: Array, rules: Rules, random: Words, tracks: Array
) -> None:
    """Bring the tracks to the present sweep, `dt` [s] after the last one, with the ranges `exact` (beams,)."""
    laser = rules.laser.mount[0], rules.laser.mount[1], rules.laser.first, rules.laser.spacing
    kernel.track_people(dt, pose, position, velocity, exact, laser, rules.errors, random, tracks)


@inner_view_kernel
def _know(pose: Array, odometry: Array, position: Array, velocity: Array, time_s: float, company: Company) -> int:
    """Write whom the robot knows by the truth, since the beginning; return how many."""
    count = 0
    for i in range(len(position)):
        if math.hypot(position[i, 0] - pose[0], position[i, 1] - pose[1]) < KNOWN_M:
            _place(count, pose, odometry, position[i, 0], position[i, 1], velocity[i, 0], velocity[i, 1], company.x)
            company.ids[count], company.confidence[count] = i, 1.0
            company.unseen_s[count], company.age_s[count] = 0.0, time_s
            count += 1
    return count


@inner_view_kernel
def _know_tracks(pose: Array, odometry: Array, tracks: Array, company: Company) -> int:
    """Write whom the robot knows by tracks (n, COLUMNS), none of which is ever new; return how many."""
    count = 0
    for i in range(len(tracks)):
        row = tracks[i]
        if row[kernel.PHASE] != kernel.UNKNOWN:
            _place(count, pose, odometry, row[kernel.X], row[kernel.Y], row[kernel.VX], row[kernel.VY], company.x)
            company.ids[count], company.confidence[count] = i, row[kernel.TRUST]
            company.unseen_s[count], company.age_s[count] = row[kernel.UNSEEN_S], np.inf
            count += 1
    return count


@inner_view_kernel
def _place(row: int, pose: Array, odometry: Array, x: float, y: float, vx: float, vy: float, states: Array) -> None:
    """Write into a `row` of `states` where in the odometry frame somebody is, and how they move, given in the world."""
    turn = odometry[2] - pose[2]
    cos, sin = math.cos(turn), math.sin(turn)
    dx, dy = x - pose[0], y - pose[1]
    states[row, 0], states[row, 1] = odometry[0] + cos * dx - sin * dy, odometry[1] + sin * dx + cos * dy
    states[row, 2], states[row, 3] = cos * vx - sin * vy, sin * vx + cos * vy


@inner_view_kernel
def _velocity(before: Array, now: Array, dt: float, sweeps: int, entry: Floats) -> None:
    """Write the robot's velocity by odometry, from the last sweep but one to the last one, `dt` [s] later."""
    x, y, turn = _between(before[0], before[1], before[2], now[0], now[1], now[2])
    share = (sweeps - 1.0) / sweeps
    if share > 0.0:  # the sweep before this one was taken on the way, which is taken to be even
        x, y, turn = _between(share * x, share * y, share * turn, x, y, turn)
    last = len(entry) - 1
    entry[0] = min(max(x / dt, -FASTEST_MPS), FASTEST_MPS)
    if last == 2:
        entry[1] = min(max(y / dt, -FASTEST_MPS), FASTEST_MPS)
    entry[last] = min(max(turn / dt, -FASTEST_TURN), FASTEST_TURN)


@inner_view_kernel
def _between(x0: float, y0: float, theta0: float, x1: float, y1: float, theta1: float) -> tuple[float, float, float]:
    """Return the second pose seen from the first."""
    cos, sin = math.cos(theta0), math.sin(theta0)
    dx, dy = x1 - x0, y1 - y0
    turn = (theta1 - theta0 + np.pi) % (2.0 * np.pi) - np.pi
    return cos * dx + sin * dy, cos * dy - sin * dx, turn
