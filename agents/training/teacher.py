"""The teacher: drives by the truth, which the robot never sees, and so shows what the policy is to do by what it sees.

It samples wishes, drives each of them ahead in thought, and takes the mean of the best ones weighted by their cost
(Williams et al. 2016, model predictive path integral control). Where to be is read off the leader's true trail: one
following distance behind, so it goes round corners where the leader did.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.follow_env import FollowEnv
from ...slam.geometry import inverse, transform_points
from ..learned.steering import State, SteeringConfig
from .teacher_kernel import look_ahead

Array = NDArray[np.float64]
_KEPT_M, _KEPT_S = 3.0, 3.0
_STEP_S = 0.1


@dataclass(frozen=True, kw_only=True)
class TeacherConfig:
    """What the teacher wants.

    Attributes:
        distance: Distance behind the leader along the trail, centre to centre [m].
        speeds: Forward speeds tried [m/s].
        turns: Turn rates tried in the first part [rad/s].
        later_turns: Turn rates tried after it, as factors of the first.
        switch_s: Length of the first part [s].
        horizon_s: How far it looks ahead [s].
        spacing: Of remembered returns and of the trail [m].
        space: Free space wanted to bystanders, and to the leader, surface to surface [m].
        patience_s: The weights of clearance and people are halved when it has stood for this long though it should be
            elsewhere, and so on [s].
        temperature: Cost at which a worse wish counts 1/e of the best.
        weights: Of tracking, end of the path, facing, clearance, its reach [m], people, change, touching.
        steering: How wishes are driven.
    """

    distance: float = 1.3
    speeds: tuple[float, ...] = (-0.4, -0.15, 0.0, 0.2, 0.4, 0.65, 0.9, 1.1, 1.3)
    turns: tuple[float, ...] = (-1.5, -1.0, -0.6, -0.35, -0.15, 0.0, 0.15, 0.35, 0.6, 1.0, 1.5)
    later_turns: tuple[float, ...] = (-0.8, 0.0, 1.0)
    switch_s: float = 0.7
    horizon_s: float = 2.0
    spacing: float = 0.07
    space: tuple[float, float] = (0.75, 0.5)
    patience_s: float = 1.5
    temperature: float = 0.04
    weights: tuple[float, ...] = (1.0, 0.6, 0.15, 0.8, 0.25, 2.5, 0.03, 10.0)
    steering: SteeringConfig = field(default_factory=SteeringConfig)


class Teacher:
    """Says which wish is best now, from the true state of an environment; one for each episode.

    Args:
        env: The environment, after `reset`.
        config: What it wants.
    """

    def __init__(self, env: FollowEnv, config: TeacherConfig | None = None) -> None:
        self.config = c = config or TeacherConfig()
        self._env = env
        first, later = np.meshgrid(c.turns, c.later_turns, indexing="ij")
        turns = np.unique(np.stack((first.ravel(), (first * later).ravel()), axis=1), axis=0)
        speeds = np.repeat(c.speeds, len(turns))
        self._wishes = np.column_stack((speeds, np.tile(turns, (len(c.speeds), 1))))
        robot = env.world.config.robot
        self._box = np.array((robot.size[0] / 2.0, robot.size[1] / 2.0, robot.radius))
        lidar = env.interface
        self._stride = max(1, len(lidar.bearings) // 270)
        bearings = lidar.bearings[:: self._stride] + lidar.T_robot_lidar[2]
        self._directions = np.stack((np.cos(bearings), np.sin(bearings)), axis=1)
        self._laser = np.array(lidar.T_robot_lidar[:2])
        self._seen = np.zeros((0, 3))
        self._trail = [env.truth.robot_pose[:2].copy()]
        self._steering = np.array(c.steering.as_tuple())
        self._weights = np.array(c.weights)
        self._stood_s = 0.0

    def wish(self, state: State) -> tuple[float, float]:
        """Return the best speed [m/s] and turn rate [rad/s] to wish now; call it once a step.

        Args:
            state: What is commanded now.
        """
        truth, c = self._env.truth, self.config
        people = truth.people
        T_robot_world = inverse(truth.robot_pose)
        points = self._things(people.positions, T_robot_world)
        turn = np.array((0.0, 0.0, T_robot_world[2]))
        order = np.append(np.delete(np.arange(len(people)), truth.leader_index), truth.leader_index)
        space = np.append(np.full(len(people) - 1, c.space[0]), c.space[1])
        where = transform_points(T_robot_world, people.positions[order])
        moves = transform_points(turn, people.velocities[order])
        table = np.column_stack((where, moves, people.radii[order], space))
        near = np.hypot(where[:, 0], where[:, 1]) < 5.0
        near[-1] = True
        reference = self._reference(T_robot_world)
        self._stand(state, reference)
        look_at = where[-1] + moves[-1]
        if np.hypot(*reference[2]) > 0.8:
            look_at = reference[2]
        weights = self._weights.copy()
        weights[[3, 5]] /= 1.0 + self._stood_s / c.patience_s
        weights[5] /= 1.0 + max(float(np.hypot(*where[-1])) - 2.0, 0.0)
        costs = look_ahead(
            np.array(state), self._wishes, reference, points, table[near], self._steering,
            self._box, look_at, weights, _STEP_S, round(c.switch_s / _STEP_S),
        )  # fmt: skip
        weight = np.exp(-(costs - costs.min()) / c.temperature)
        speed, turn_rate = (weight / weight.sum()) @ self._wishes[:, :2]
        return float(speed), float(turn_rate)

    def _stand(self, state: State, reference: Array) -> None:
        stands = abs(state[0]) < 0.1 and float(np.hypot(*reference[-1])) > 0.6
        self._stood_s = self._stood_s + _STEP_S if stands else 0.8 * self._stood_s

    def _things(self, people: Array, T_robot_world: Array) -> Array:
        """Return (n, 2) returns of the building and the things in it, of this scan and those before, robot frame."""
        pose, spacing = self._env.truth.robot_pose, self.config.spacing
        scan, truth_time = self._env.belief.scan, self._env.truth.time_s
        ranges = np.where(scan.is_return, scan.ranges, np.inf)[:: self._stride]
        near = ranges < _KEPT_M + 0.5
        new = transform_points(pose, self._laser + ranges[near, None] * self._directions[near])
        gap = np.hypot(*(new[:, None] - people[None]).transpose(2, 0, 1)).min(axis=1)
        new = np.column_stack((new[gap > 0.5], np.full(int((gap > 0.5).sum()), truth_time)))
        seen = np.vstack((new, self._seen))
        cells = np.round(seen[:, :2] / spacing).astype(np.int64)
        first = np.unique(cells[:, 0] * 100_003 + cells[:, 1], return_index=True)[1]
        near = np.abs(seen[:, :2] - pose[:2]).max(axis=1, initial=0.0) < _KEPT_M
        kept = first[(near & (truth_time - seen[:, 2] < _KEPT_S))[first]]
        self._seen = seen[kept]
        return transform_points(T_robot_world, self._seen[:, :2])

    def _reference(self, T_robot_world: Array) -> Array:
        """Return (t, 2) where to be after 0.2, 0.4, ... s, robot frame [m]."""
        c, truth = self.config, self._env.truth
        leader = truth.people.positions[truth.leader_index]
        if np.hypot(*(leader - self._trail[-1])) > c.spacing:
            self._trail.append(leader.copy())
        times = 2.0 * _STEP_S * np.arange(1, round(c.horizon_s / (2.0 * _STEP_S)) + 1)
        trail = transform_points(T_robot_world, np.vstack((self._trail, leader)))
        pace = truth.people.velocities[truth.leader_index]
        speed = float(np.hypot(*pace))
        gap = trail[-1]
        away = float(np.hypot(*gap))
        if away < c.distance - 0.05 and speed < 0.3:
            return np.repeat(gap[None] / max(away, 1e-6) * min(away - c.distance + 0.05, 0.0), len(times), axis=0)
        turn = np.array((0.0, 0.0, T_robot_world[2]))
        future = gap + times[:, None] * transform_points(turn, pace[None])[0]
        path = np.vstack((trail, future)) if speed > 0.1 else trail
        arc = np.append(0.0, np.cumsum(np.hypot(*np.diff(path, axis=0).T)))
        off = np.hypot(trail[:, 0], trail[:, 1])
        mine = arc[np.flatnonzero(off < max(0.5, off.min() + 0.15))[-1]]
        target = arc[len(trail) - 1] - c.distance + speed * times
        target = np.clip(target, mine, mine + 0.3 + 1.3 * times)
        return np.stack([np.interp(target, arc, path[:, k]) for k in (0, 1)], axis=1)
