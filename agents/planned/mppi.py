"""Model predictive path integral control (Williams et al. 2017): many plans driven in thought, their mean is driven."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.bounds import check_positive
from ..learned.hindsight import Hindsight
from ..learned.steering import SteeringConfig
from ..learned.trail import Trail
from ..protocol.follower import Observation
from ..scripted.leader_memory import Goal, LeaderMemory, MemoryConfig, Mode
from ..scripted.scan_points import leader_row, own_velocity, without
from .fields import CELL_M, FAR_M, HALF_M, WAY_CELL_M, distance_field, ways_to
from .plan_kernel import Body, Prices, Scene, axis_step, plan_costs
from .prediction import walked_on
from .things import Things

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PriceConfig:
    """What a plan costs; a cost of 1 is that of being 1 m too far from the leader all the time.

    Attributes:
        keep: Way kept to the leader, centre to centre [m].
        way: Weight of the way that is too long or too short, mean over the plan [1/m].
        end: Of that in the end [1/m].
        facing: Of looking away from the leader, mean over the plan: 0 ahead, 1 behind.
        sight: Of a leader who is hidden, at three moments.
        tight: Of coming near to things.
        comfort: Gap to things beyond which they cost nothing [m].
        people: Of the chance of a contact with a person.
        space: Of a gap to people of less than their personal space of 0.45 m.
        person_radius: Radius of a body [m].
        spread: Deviation of where a person is said to be [m].
        spread_rate: By how much it grows with the time ahead [m/s].
        touch: Of touching a thing.
        still: For so long people are taken to be where the laser met them, too: tracks lag behind who turns [s].
        effort: Of jerk, mean square [s^6/m^2].
        turning: Of the jerk of turning, against that [m^2].
        back: Of backing over what was never seen [1/m].
    """

    keep: float = 1.2
    way: float = 1.0
    end: float = 0.5
    facing: float = 0.6
    sight: float = 0.7
    tight: float = 0.8
    comfort: float = 0.25
    people: float = 10.0
    space: float = 0.3
    person_radius: float = 0.22
    spread: float = 0.1
    spread_rate: float = 0.2
    touch: float = 10.0
    still: float = 0.4
    effort: float = 0.03
    turning: float = 0.3
    back: float = 10.0


@dataclass(frozen=True, kw_only=True)
class MPPIConfig:
    """How plans are drawn, driven and weighed.

    Attributes:
        horizon_s: How far ahead is planned [s].
        knots: Wishes of a plan.
        samples: Plans drawn around the last one in each step.
        speed_noise: Deviation of the drawn wishes [m/s].
        turn_noise: Likewise [rad/s].
        temperature: A plan that costs so much more than the best counts 1/e of it.
        evaluations: At so many moments of a plan its place is judged.
        reach: Things farther away than this do not matter [m].
        remembered_s: For how long things are remembered that are not in sight [s].
        walking: Who is faster than this walks and is no thing [m/s].
        body: Returns nearer to a person who walks are that person [m].
        seed: Of the draws.
        prices: What plans cost.
        steering: How wishes are driven.
        memory: What it does when the leader is lost.
    """

    horizon_s: float = 3.0
    knots: int = 7
    samples: int = 256
    speed_noise: float = 0.3
    turn_noise: float = 0.4
    temperature: float = 0.05
    evaluations: int = 15
    reach: float = 4.0
    remembered_s: float = 10.0
    walking: float = 0.25
    body: float = 0.4
    seed: int = 0
    prices: PriceConfig = field(default_factory=PriceConfig)
    steering: SteeringConfig = field(default_factory=lambda: SteeringConfig(settle_s=0.5))
    memory: MemoryConfig = field(default_factory=lambda: MemoryConfig(predicted=True))

    def __post_init__(self) -> None:
        check_positive(self, "horizon_s", "knots", "samples", "temperature", "evaluations")


class MPPIFollower:
    """Plans three seconds ahead in every step; sees only what the robot perceives.

    Args:
        interface: Scales of the environment.
        config: How it plans.
    """

    def __init__(self, interface: FollowInterface | None = None, config: MPPIConfig | None = None) -> None:
        self.interface = robot = interface or FollowInterface()
        self.config = c = config or MPPIConfig()
        self._step_s = 1.0 / robot.control_hz
        self._memory, self._trail = LeaderMemory(c.memory, self._step_s), Trail()
        self._things, self._behind = Things(robot, c.reach, c.remembered_s), Hindsight(robot)
        self._every = max(1, round(c.horizon_s / (c.evaluations * self._step_s)))
        self._knot_s = c.horizon_s / (c.knots - 1)
        self._body, self._prices = body_of(robot, c.steering), Prices(*(getattr(c.prices, f) for f in Prices._fields))
        self._menu = menu(c.knots, self._knot_s, robot.holonomic)
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._memory.reset()
        self._trail = Trail()
        self._things.reset()
        self._behind.reset()
        self._rng = np.random.default_rng(self.config.seed)
        self._plan = np.zeros((self.config.knots, 3))
        self._state = np.zeros((3, 2))

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, left, turn) for a holonomic robot, each in [-1, 1]."""
        leader, velocity = leader_row(observation), own_velocity(observation)
        goal, seen = self._memory.update(leader, velocity), leader[5] > 0.5
        self._trail.update(velocity, self._step_s, (goal.x, goal.y) if seen else None)
        self._behind.observe(observation)
        rows = observation["people"].astype(np.float64)
        people = rows[rows[:, 5] > 0.5, :4]
        walk = people[np.hypot(people[:, 2], people[:, 3]) > self.config.walking, :2]
        moving = np.vstack((walk, (goal.x, goal.y))) if goal.mode is Mode.FOLLOW else walk
        things = self._things.update(observation, moving, self.config.body)
        if goal.mode is Mode.WAIT:
            return self._drive(np.zeros(3))
        if goal.mode is Mode.SEARCH:
            self._plan[:] = (0.0, 0.0, self._memory.search_turn)
            return self._drive(self._plan[0])
        scene = self._scene(goal, people, things, self._things.met)
        self._improve(scene)
        return self._drive(self._plan[0])

    def _scene(self, goal: Goal, people: Array, things: Array, met: Array) -> Scene:
        c, dt = self.config, self._every * self._step_s
        distances = distance_field(things, HALF_M, CELL_M, FAR_M)
        room = c.prices.person_radius
        everybody = np.vstack((people, (goal.x, goal.y, goal.vx, goal.vy)))
        walked = walked_on(everybody, distances, HALF_M, CELL_M, c.evaluations, dt, room)
        leader = walked[-1]
        narrow = self._body.half_width + c.prices.comfort
        ways = [ways_to(place, distances, self._body.half_width, narrow, c.prices.keep) for place in ((goal.x, goal.y), leader[-1])]
        cells = np.array((HALF_M, CELL_M, WAY_CELL_M))
        own = np.array([[goal.x, goal.y]])
        returns = distance_field(without(met, own, c.body + 0.05), HALF_M, CELL_M, FAR_M)
        return Scene(distances, np.minimum(returns, distances), ways[0], ways[1], cells, leader, walked, self._state, self._behind.room())

    def _improve(self, scene: Scene) -> None:
        """Move the plan to the mean of what was drawn, weighted by its cost; to the best where the mean is worse."""
        c = self.config
        times = self._knot_s * np.arange(c.knots)
        last = np.stack([np.interp(times + self._step_s, times, self._plan[:, k]) for k in range(3)], axis=1)
        scale = np.array((c.speed_noise, c.speed_noise if self.interface.holonomic else 0.0, c.turn_noise))
        noise = self._rng.standard_normal((c.samples, c.knots, 3)) * scale
        plans = np.concatenate((last[None], last + noise, self._menu))
        low, high = self._body.limits[:, 0], self._body.limits[:, 1]
        plans = np.clip(plans, low, high)
        costs = self._costs(plans, scene)
        weight = np.exp(-(costs - costs.min()) / c.temperature)
        mean = np.tensordot(weight / weight.sum(), plans, axes=1)
        best = plans[int(np.argmin(costs))]
        pair = np.stack((mean, best))
        self._plan = pair[int(np.argmin(self._costs(pair, scene)))]

    def _costs(self, plans: Array, scene: Scene) -> Array:
        return plan_costs(plans, self._knot_s, self._step_s, self._every, scene, self._body, self._prices)

    def _drive(self, wish: Array) -> NDArray[np.float32]:
        for k in range(3):
            v, a = axis_step(self._state[k, 0], self._state[k, 1], wish[k], self._step_s, self._body.limits[k])
            self._state[k] = v, a
        robot = self.interface
        forward, left = self._state[:2, 0] / robot.max_speed
        turn = self._state[2, 0] / robot.max_turn_rate
        action = [forward, left, turn] if robot.holonomic else [forward, turn]
        return np.clip(np.array(action, dtype=np.float32), -1.0, 1.0)


def body_of(robot: FollowInterface, s: SteeringConfig) -> Body:
    """Return what the kernel is told of a robot that is steered so."""
    top, turn = min(s.max_speed, robot.max_speed), min(s.max_turn_rate, robot.max_turn_rate)
    speed = (s.settle_s, s.acceleration, s.braking, s.jerk, s.brake_jerk)
    aside = s.reverse_speed if robot.holonomic else 0.0
    turning = (s.turn_settle_s, s.turn_acceleration, s.turn_acceleration, s.turn_jerk, s.turn_jerk)
    limits = np.array([(-s.reverse_speed, top, *speed), (-aside, aside, *speed), (-turn, turn, *turning)])
    a, b = robot.half_length, robot.half_width
    rows, columns = math.ceil(2.0 * a / 0.2), math.ceil(2.0 * b / 0.2)
    grid = np.stack(
        np.meshgrid(
            a * ((2.0 * np.arange(rows) + 1.0) / rows - 1.0), b * ((2.0 * np.arange(columns) + 1.0) / columns - 1.0)
        ),
        axis=-1,
    ).reshape(-1, 2)
    edge = (np.abs(grid[:, 0]) > a - 1.5 * a / rows) | (np.abs(grid[:, 1]) > b - 1.5 * b / columns)
    x, y, mount = robot.T_robot_lidar
    laser = np.array((x, y, robot.bearings[0] + mount, robot.bearings[-1] + mount))
    return Body(limits, grid[edge], math.hypot(a / rows, b / columns), a, b, laser)


def menu(knots: int, knot_s: float, holonomic: bool) -> Array:
    """Return (n, knots, 3) plans that are always weighed: one speed, one turn rate for a while, and another then."""
    plans = []
    early = knot_s * np.arange(knots) < 0.8
    for speed in (-0.3, 0.0, 0.4, 0.8, 1.2):
        for turn in (-1.5, -0.8, -0.35, 0.0, 0.35, 0.8, 1.5):
            for then in (-0.8, 0.0, 1.0) if turn else (0.0,):
                plan = np.zeros((knots, 3))
                plan[:, 0], plan[:, 2] = speed, np.where(early, turn, then * turn)
                plans.append(plan)
    if holonomic:
        for side in (-0.4, 0.4):
            for speed in (-0.3, 0.0, 0.4, 0.8):
                plan = np.zeros((knots, 3))
                plan[:, :2] = speed, side
                plans.append(plan)
    return np.array(plans)
