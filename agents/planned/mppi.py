"""A follower by model predictive path integral control (Williams et al. 2017), among people whose walk it predicts.

Each step, hundreds of plans around the last one are driven in thought, each is priced by what it meets, and their mean,
weighted by exp(-price / temperature), is the new plan; its first wish is driven.
"""

import numpy as np
from numpy.typing import NDArray

from ...envs.task.interface import FollowInterface
from ...slam.errors import InputError
from ..protocol.follower import Observation
from ..scripted.ground_behind import GroundBehind
from ..scripted.leader_memory import Goal, LeaderMemory, Mode
from ..scripted.scan_points import leader_row, own_velocity, without
from .config import MPPIConfig
from .fields import CELL_M, FAR_M, HALF_M, WAY_CELL_M, distance_field, ways_to
from .menu import plans_to_weigh
from .plan_kernel import PlanningScene, Prices, axis_step, plan_costs
from .prediction import walked_on
from .robot_body import body_of
from .standing_things import StandingThings
from .unseen import unseen_field

Array = NDArray[np.float64]

ARRIVED_M = 0.3
"""Who comes so near to where a lost leader would be looks round there; less than at what the search begins (0.5 m)."""


class MPPIFollower:
    """Plans three seconds ahead in every step; sees only what the robot perceives.

    Args:
        interface: Scales of the environment.
        config: How it plans, and what it minds.

    Raises:
        InputError: If it minds what its map does not show yet, and nothing builds a map in the environment.
    """

    def __init__(self, interface: FollowInterface | None = None, config: MPPIConfig | None = None) -> None:
        self.interface = robot = interface or FollowInterface()
        self.config = c = config or MPPIConfig()
        if c.prices.unseen > 0.0 and robot.own_map is None:
            raise InputError(
                "a follower that looks for unseen floor needs the robot's own map: an environment with `slam`, got none"
            )
        self._step_s = 1.0 / robot.control_hz
        self._memory = LeaderMemory(c.memory, self._step_s)
        self._things, self._behind = StandingThings(robot, c.reach, c.remembered_s), GroundBehind(robot)
        self._every = max(1, round(c.horizon_s / (c.evaluations * self._step_s)))
        self._knot_s = c.horizon_s / (c.knots - 1)
        self._body, self._prices = body_of(robot, c.steering), Prices(*(getattr(c.prices, f) for f in Prices._fields))
        self._menu = plans_to_weigh(c.knots, self._knot_s, robot.holonomic)
        self._noise = np.array((c.speed_noise, c.speed_noise if robot.holonomic else 0.0, c.turn_noise))
        self.reset()

    def reset(self) -> None:
        """Forget everything; call it before each episode."""
        self._memory.reset()
        self._things.reset()
        self._behind.reset()
        self._rng = np.random.default_rng(self.config.seed)
        self._plan = np.zeros((self.config.knots, 3))
        self._motion = np.zeros((3, 2))  # commanded velocity forward, left, turn, and their rates

    def act(self, observation: Observation) -> NDArray[np.float32]:
        """Return the action (forward, turn), or (forward, left, turn) for a holonomic robot, each in [-1, 1].

        Raises:
            InputError: If nobody leads, or the scan has not as many beams as the interface.
        """
        goal = self._memory.update(leader_row(observation), own_velocity(observation))
        self._behind.observe(observation)
        rows = observation["people"].astype(np.float64)
        people = rows[rows[:, 5] > 0.5, :4]
        things = self._things.update(observation, self._moving(goal, people), self.config.body)
        if goal.mode is Mode.WAIT:
            self._plan[:] = 0.0
        elif goal.mode is Mode.SEARCH:
            self._plan[:] = (0.0, 0.0, self._memory.search_turn)
        else:
            self._prices = self._prices._replace(keep=self._keep(goal))
            self._improve(self._scene(goal, people, things))
        return self._drive(self._plan[0])

    def _moving(self, goal: Goal, people: Array) -> Array:
        """Return (k, 2) where those are who are no things: who walks, and the leader, standing or not [m]."""
        walking = people[np.hypot(people[:, 2], people[:, 3]) > self.config.walking, :2]
        return np.vstack((walking, (goal.x, goal.y))) if goal.mode is Mode.FOLLOW else walking

    def _keep(self, goal: Goal) -> float:
        """Return the way kept to the leader [m]; to the place of a leader who is not seen, hardly any."""
        return self.config.prices.keep if goal.mode is Mode.FOLLOW else ARRIVED_M

    def _scene(self, goal: Goal, people: Array, things: Array) -> PlanningScene:
        """Return what plans are priced by, from where people and (n, 2) things are [m]."""
        c, dt = self.config, self._every * self._step_s
        distances = distance_field(things, HALF_M, CELL_M, FAR_M)
        everybody = np.vstack((people, (goal.x, goal.y, goal.vx, goal.vy)))
        walked = walked_on(everybody, distances, HALF_M, CELL_M, c.evaluations, dt, c.prices.person_radius)
        half_width, keep = self._body.half_width, self._keep(goal)
        narrow, places = half_width + c.prices.comfort, (everybody[-1, :2], walked[-1, -1])
        now, then = (ways_to(place, distances, half_width, narrow, keep) for place in places)
        own = without(self._things.met, everybody[-1:, :2], c.body)
        returns = np.minimum(distance_field(own, HALF_M, CELL_M, FAR_M), distances)
        cells = np.array((HALF_M, CELL_M, WAY_CELL_M))
        room, unseen = self._behind.room(), self._unseen(everybody[-1, :2], walked[-1])
        return PlanningScene(distances, returns, now, then, cells, walked, self._motion, room, unseen)

    def _unseen(self, leader: Array, walked: Array) -> Array:
        """Return where ground comes into sight that the leader's way (t, 2) will not show; (0, 0) for who minds not."""
        ask = self.interface.own_map
        if self._prices.unseen <= 0.0 or ask is None:
            return np.zeros((0, 0))
        return unseen_field(ask(), np.vstack((0.5 * leader, leader, walked[4::5])))

    def _improve(self, scene: PlanningScene) -> None:
        """Move the plan to the weighted mean; to the best, where that is better: between two ways round is no way."""
        c = self.config
        times = self._knot_s * np.arange(c.knots)
        last = np.stack([np.interp(times + self._step_s, times, self._plan[:, k]) for k in range(3)], axis=1)
        drawn = last + self._rng.standard_normal((c.samples, c.knots, 3)) * self._noise
        plans = np.concatenate((last[None], drawn, self._menu))
        plans = np.clip(plans, self._body.limits[:, 0], self._body.limits[:, 1])
        costs = self._costs(plans, scene)
        pair = np.stack((np.tensordot(weights(costs, c.temperature), plans, axes=1), plans[int(np.argmin(costs))]))
        self._plan = pair[int(np.argmin(self._costs(pair, scene)))]

    def _costs(self, plans: Array, scene: PlanningScene) -> Array:
        return plan_costs(plans, self._knot_s, self._step_s, self._every, scene, self._body, self._prices)

    def _drive(self, wish: Array) -> NDArray[np.float32]:
        """Return the action one step on the way to `wish` (3,)."""
        motion = [axis_step(*self._motion[k], wish[k], self._step_s, self._body.limits[k]) for k in range(3)]
        self._motion = np.array(motion)
        robot, (forward, left, turn) = self.interface, self._motion[:, 0]
        scaled = [forward / robot.max_speed, left / robot.max_speed, turn / robot.max_turn_rate]
        action = np.array(scaled if robot.holonomic else [scaled[0], scaled[2]], dtype=np.float32)
        return np.clip(action, -1.0, 1.0)


def weights(costs: Array, temperature: float) -> Array:
    """Return (n,) how much each of n plans counts in their mean, the cheaper the more; 1 in all (Williams 2017)."""
    weight = np.exp(-(costs - costs.min()) / temperature)
    return weight / weight.sum()
