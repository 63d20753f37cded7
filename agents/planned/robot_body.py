"""What the planner's kernels are told of a robot: the limits of its motion, discs that cover it, and where it looks."""

import math

import numpy as np

from ...envs.task.interface import FollowInterface
from ..learned.steering import SteeringConfig
from .plan_kernel import Body

_DISC_PITCH_M = 0.2
"""Of the discs' middles, at most [m]: so they reach beyond a Dingo's sides by 4 cm, the gap that the guard keeps."""


def body_of(robot: FollowInterface, s: SteeringConfig) -> Body:
    """Return what the kernels are told of `robot`, steered by `s`; sideways it is as slow as backwards."""
    top, turn = min(s.max_speed, robot.max_speed), min(s.max_turn_rate, robot.max_turn_rate)
    slow = min(s.reverse_speed, robot.max_speed)
    speed = (s.settle_s, s.acceleration, s.braking, s.jerk, s.brake_jerk)
    turning = (s.turn_settle_s, s.turn_acceleration, s.turn_acceleration, s.turn_jerk, s.turn_jerk)
    aside = slow if robot.holonomic else 0.0
    limits = np.array([(-slow, top, *speed), (-aside, aside, *speed), (-turn, turn, *turning)])
    a, b = robot.half_length, robot.half_width
    rows, columns = (math.ceil(2.0 * half / _DISC_PITCH_M) for half in (a, b))
    x = a * ((2.0 * np.arange(rows) + 1.0) / rows - 1.0)
    y = b * ((2.0 * np.arange(columns) + 1.0) / columns - 1.0)
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    inner = np.zeros((columns, rows), dtype=np.bool_)
    inner[1:-1, 1:-1] = True  # what touches one of these touches one of the outer ones first
    ahead, left, mount = robot.T_robot_lidar
    rightmost = min(robot.bearings[0], robot.bearings[-1]) + mount
    laser = np.array((ahead, left, rightmost, robot.field_of_view))
    return Body(limits, grid[~inner], math.hypot(a / rows, b / columns), a, b, laser)
