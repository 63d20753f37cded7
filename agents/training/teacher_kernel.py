"""What a wish would lead to: the teacher's look ahead, compiled."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True)
def steer_kernel(
    v: float, a: float, w: float, b: float, speed: float, turn: float, dt: float, c: Array
) -> tuple[float, float, float, float]:
    """Do as `learned.steering.steer` does; `c` (11,) is `SteeringConfig.as_tuple()`."""
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


@njit(cache=True, nogil=True)
def box_gap(x: float, y: float, half_length: float, half_width: float) -> float:
    """Return how far (x, y) in the robot frame is from the robot's box [m]; 0 inside."""
    dx, dy = max(abs(x) - half_length, 0.0), max(abs(y) - half_width, 0.0)
    return np.sqrt(dx * dx + dy * dy)


@njit(cache=True, nogil=True)
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
        steering: (11,) as `steer_kernel` takes it.
        box: (3,) half length, half width, radius of the robot's circle [m].
        look_at: (2,) place to face in the end, robot frame [m].
        weights: (8,) of: tracking, end, facing, clearance, its reach [m], people, change, touching.
        dt: Step [s].
        switch: Step at which the turn rate changes.
    """
    costs = np.zeros(len(wishes))
    for i in range(len(wishes)):
        v, a, w, b = state[0], state[1], state[2], state[3]
        x = y = th = 0.0
        track = tight = crowd = touch = 0.0
        for step in range(2 * len(reference)):
            turn = wishes[i, 1] if step < switch else wishes[i, 2]
            v, a, w, b = steer_kernel(v, a, w, b, wishes[i, 0], turn, dt, steering)
            middle = th + 0.5 * w * dt
            x += v * dt * np.cos(middle)
            y += v * dt * np.sin(middle)
            th += w * dt
            if step % 2 == 0:
                continue
            k = step // 2
            later = 1.0 - 0.5 * k / len(reference)
            track += np.hypot(x - reference[k, 0], y - reference[k, 1])
            cos, sin = np.cos(th), np.sin(th)
            least = weights[4]
            for j in range(len(points)):
                dx, dy = points[j, 0] - x, points[j, 1] - y
                if abs(dx) + abs(dy) < 0.9:
                    gap = box_gap(cos * dx + sin * dy, cos * dy - sin * dx, box[0], box[1])
                    if gap < least:
                        least = gap
            lack = 1.0 - least / weights[4]
            tight = max(tight, lack * lack * later)
            if least < 0.03:
                touch = max(touch, later)
            t = (step + 1) * dt
            for j in range(len(people)):
                dx, dy = people[j, 0] + people[j, 2] * t - x, people[j, 1] + people[j, 3] * t - y
                gap = np.hypot(dx, dy) - people[j, 4] - box[2]
                if gap < people[j, 5]:
                    short = 1.0 - gap / people[j, 5]
                    crowd = max(crowd, short * later)
                    ahead, aside = cos * dx + sin * dy, cos * dy - sin * dx
                    if box_gap(ahead, aside, box[0], box[1]) - people[j, 4] < 0.05:
                        touch = max(touch, 0.7 * later)
        end = len(reference) - 1
        bearing = np.arctan2(look_at[1] - y, look_at[0] - x) - th
        bearing = abs((bearing + np.pi) % (2.0 * np.pi) - np.pi)
        costs[i] = (
            weights[0] * track / len(reference)
            + weights[1] * np.hypot(x - reference[end, 0], y - reference[end, 1])
            + weights[2] * bearing
            + weights[3] * tight
            + weights[5] * crowd
            + weights[6] * (abs(wishes[i, 1] - state[2]) + abs(wishes[i, 0] - state[0]))
            + weights[7] * touch
        )
    return costs
