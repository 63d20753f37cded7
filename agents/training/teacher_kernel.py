"""What a wish would lead to: the teacher's look ahead, compiled."""

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from ..learned.braking import next_commands

Array = NDArray[np.float64]


@kernel
def box_gap(x: float, y: float, half_length: float, half_width: float) -> float:
    """Return how far (x, y) in the robot frame is from the robot's box [m]; 0 inside."""
    dx, dy = max(abs(x) - half_length, 0.0), max(abs(y) - half_width, 0.0)
    return np.sqrt(dx * dx + dy * dy)


@kernel
def nearest_thing(points: Array, x: float, y: float, theta: float, box: Array, reach: float) -> float:
    """Return the distance from the robot's box at a pose to the nearest of `points` (m, 2), at most `reach` [m]."""
    cos, sin = np.cos(theta), np.sin(theta)
    least = reach
    for j in range(len(points)):
        dx, dy = points[j, 0] - x, points[j, 1] - y
        if abs(dx) + abs(dy) < 0.9:
            gap = box_gap(cos * dx + sin * dy, cos * dy - sin * dx, box[0], box[1])
            if gap < least:
                least = gap
    return least


@kernel
def lack_of_space(people: Array, x: float, y: float, theta: float, t: float, box: Array) -> tuple[float, bool]:
    """Return the greatest lack of space to `people` (k, 6) after `t` [s], 0 .. 1 and beyond; and whether it touches."""
    cos, sin = np.cos(theta), np.sin(theta)
    most, touches = 0.0, False
    for j in range(len(people)):
        dx, dy = people[j, 0] + people[j, 2] * t - x, people[j, 1] + people[j, 3] * t - y
        gap = np.hypot(dx, dy) - people[j, 4] - box[2]
        if gap < people[j, 5]:
            most = max(most, 1.0 - gap / people[j, 5])
            ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
            touches = touches or box_gap(ahead, aside, box[0], box[1]) - people[j, 4] < 0.05
    return most, touches


@kernel
def drive_ahead(
    state: Array,
    wish: Array,
    reference: Array,
    points: Array,
    people: Array,
    steering: Array,
    box: Array,
    reach: float,
    dt: float,
    switch: int,
) -> tuple[float, float, float, float, float, float, float]:
    """Return what one wish leads to; the arguments are those of `look_ahead`.

    Returns:
        Sum of the distances from the reference [m], worst tightness, lack of space and touching (0 .. 1, less where it
        comes later), and the pose in the end [m, m, rad].
    """
    v, a, w, b = state[0], state[1], state[2], state[3]
    x = y = theta = track = tight = crowd = touch = 0.0
    for step in range(2 * len(reference)):
        turn = wish[1] if step < switch else wish[2]
        v, a, w, b = next_commands(v, a, w, b, wish[0], turn, dt, steering)
        middle = theta + 0.5 * w * dt
        x += v * dt * np.cos(middle)
        y += v * dt * np.sin(middle)
        theta += w * dt
        if step % 2 == 0:
            continue
        k = step // 2
        later = 1.0 - 0.5 * k / len(reference)
        track += np.hypot(x - reference[k, 0], y - reference[k, 1])
        least = nearest_thing(points, x, y, theta, box, reach)
        tight = max(tight, (1.0 - least / reach) ** 2 * later)
        lack, touches = lack_of_space(people, x, y, theta, (step + 1) * dt, box)
        crowd = max(crowd, lack * later)
        touch = max(touch, later if least < 0.03 else (0.7 * later if touches else 0.0))
    return track, tight, crowd, touch, x, y, theta


@kernel
def look_ahead(
    state: Array,
    wishes: Array,
    reference: Array,
    points: Array,
    people: Array,
    steering: Array,
    box: Array,
    look_at: Array,
    weights: Array,
    dt: float,
    switch: int,
) -> Array:
    """Return (n,) what each wish would cost.

    Args:
        state: (4,) commanded speed, its rate, turn rate, its rate.
        wishes: (n, 3) speed [m/s], turn rate until step `switch` and after it [rad/s].
        reference: (t, 2) where to be after 2, 4, ... steps, robot frame [m].
        points: (m, 2) things that must not be touched, robot frame [m].
        people: (k, 6) x, y, vx, vy, radius, wanted space; robot frame [m, m/s].
        steering: (12,) as `braking.next_commands` takes it.
        box: (3,) half length, half width, radius of the robot's circle [m].
        look_at: (2,) place to face in the end, robot frame [m].
        weights: (8,) of: tracking, end, facing, clearance, its reach [m], people, change, touching.
        dt: Step [s].
        switch: Step at which the turn rate changes.
    """
    costs, last = np.zeros(len(wishes)), reference[-1]
    for i in range(len(wishes)):
        track, tight, crowd, touch, x, y, theta = drive_ahead(
            state, wishes[i], reference, points, people, steering, box, weights[4], dt, switch
        )
        bearing = np.arctan2(look_at[1] - y, look_at[0] - x) - theta
        bearing = abs((bearing + np.pi) % (2.0 * np.pi) - np.pi)
        change = abs(wishes[i, 1] - state[2]) + abs(wishes[i, 0] - state[0])
        costs[i] = weights[0] * track / len(reference) + weights[1] * np.hypot(x - last[0], y - last[1])
        costs[i] += weights[2] * bearing + weights[3] * tight + weights[5] * crowd
        costs[i] += weights[6] * change + weights[7] * touch
    return costs
