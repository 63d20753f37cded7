"""Manoeuvres driven in thought: where they lead, and how near to things they come."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from .guard import box_gaps, driven
from .steering import State, SteeringConfig, steer_many

Array = NDArray[np.float64]

LONGEST_S = 5.0
"""Of a manoeuvre [s]: what is farther ahead than the laser sees things has no use, and takes time."""
SPACING_M = 0.1
"""Of the points of a path [m]."""
_LONGEST_M = 2.5


@dataclass(frozen=True, eq=False)
class Driven:
    """What manoeuvres lead to.

    Attributes:
        poses: (n, 3) where each ends, in the robot frame of now.
        gaps: (n,) the least distance from the robot's box to things on the way, negative inside it [m].
        back: (n,) how far back from here they come [m].
    """

    poses: Array
    gaps: Array
    back: Array


def drive_in_thought(
    state: State,
    plans: Array,
    things: Array,
    horizon_s: float,
    step_s: float,
    steering: SteeringConfig,
    robot: FollowInterface,
) -> Driven:
    """Drive manoeuvres of two parts each.

    Args:
        state: What is commanded now.
        plans: (n, 5) wished speed [m/s] and turn rate [rad/s], for how long [s], and the two wished after it.
        things: (m, 2) what is not to be touched, robot frame [m].
        horizon_s: Length of both parts [s].
        step_s: Length of a step [s].
        steering: How wishes are driven.
        robot: Its size.
    """
    states, poses = np.repeat(np.array([state]), len(plans), axis=0), np.zeros((len(plans), 3))
    least, back = np.full(len(plans), np.inf), np.zeros(len(plans))
    for k in range(round(horizon_s / step_s)):
        wishes = np.where((k * step_s < plans[:, 2])[:, None], plans[:, :2], plans[:, 3:])
        states = steer_many(states, wishes, step_s, steering)
        poses = driven(poses, states, step_s)
        back = np.maximum(back, -poses[:, 0])
        if k % 2:
            least = np.minimum(least, box_gaps(poses, things, robot))
    return Driven(poses, least, back)


def turned_away(poses: Array, places: Array) -> Array:
    """Return (n,) the angle [rad], 0 to pi, by which who stands at each of `poses` (n, 3) faces away from `places`.

    Those are (n, 2), or (2,) for one place [m].
    """
    bearing = np.arctan2(places[..., 1] - poses[:, 1], places[..., 0] - poses[:, 0]) - poses[:, 2]
    return np.abs((bearing + np.pi) % (2.0 * np.pi) - np.pi)


def resampled(path: Array, keep: float) -> Array:
    """Return (k, 2) points of `path` every 0.1 m from here, at most 2.5 m, ending `keep` before its end [m]."""
    whole = np.vstack((np.zeros(2), path))
    arc = np.append(0.0, np.cumsum(np.hypot(*np.diff(whole, axis=0).T)))
    ways = np.arange(SPACING_M, min(arc[-1] - keep, _LONGEST_M), SPACING_M)
    return np.stack([np.interp(ways, arc, whole[:, k]) for k in (0, 1)], axis=1)


def thinned(points: Array, within: float) -> Array:
    """Return one of `points` (n, 2) for each cell of 4 cm, of those nearer to the robot's centre than `within` [m]."""
    near = points[np.hypot(points[:, 0], points[:, 1]) < within]
    cells = np.round(near / 0.04).astype(np.int64)
    return near[np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)[1]]
