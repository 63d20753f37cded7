"""What the planner weighs in one step, drawn: a doorway, somebody who comes, and a leader who goes on."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from ...agents.planned.config import MPPIConfig
from ...agents.planned.fields import CELL_M, FAR_M, HALF_M, WAY_CELL_M, distance_field, ways_to
from ...agents.planned.menu import plans_to_weigh
from ...agents.planned.plan_kernel import Body, PlanningScene, Prices, drive, plan_costs
from ...agents.planned.prediction import walked_on
from ...agents.planned.robot_body import body_of
from ...envs.task.interface import FollowInterface
from ..figures.canvas import BLUE, GREEN, INK, ORANGE, PlanCanvas

Array = NDArray[np.float64]

_STEP_S, _EVERY, _SPEED_MPS = 0.1, 2, 0.8
_LEADER, _COMER = (1.6, 0.1, 0.9, 0.15), (3.2, -0.75, -0.7, 0.25)  # x, y [m], vx, vy [m/s]
_PALE = (190, 205, 235)
_SHOWN = 140


def planner_picture(seed: int) -> Image.Image:
    """Return the picture: things, where people will be, plans by their weight, and their mean."""
    c, robot = MPPIConfig(), FollowInterface()
    body, knot_s = body_of(robot, c.steering), c.horizon_s / (c.knots - 1)
    side = np.arange(0.55, 3.0, 0.04)
    things = np.concatenate([np.stack((np.full(len(side), 2.0), sign * side), axis=1) for sign in (-1.0, 1.0)])
    scene = _scene(things, body, c)
    last = np.zeros((c.knots, 3))
    last[:, 0] = _SPEED_MPS
    noise = np.random.default_rng(seed).standard_normal((c.samples, c.knots, 3))
    drawn = last + noise * (c.speed_noise, 0.0, c.turn_noise)
    plans = np.clip(
        np.concatenate((drawn, plans_to_weigh(c.knots, knot_s, False))), body.limits[:, 0], body.limits[:, 1]
    )
    prices = Prices(*(getattr(c.prices, name) for name in Prices._fields))
    costs = plan_costs(plans, knot_s, _STEP_S, _EVERY, scene, body, prices)
    weight = np.exp(-(costs - costs.min()) / c.temperature)
    mean = np.tensordot(weight / weight.sum(), plans, axes=1)
    sheet = PlanCanvas((-0.8, -1.7), (4.6, 1.7), "One step of the planner")
    for plan in plans[np.argsort(-costs)[-_SHOWN:]]:
        sheet.line(_path(plan, knot_s, c, body), _PALE, 1.0)
    sheet.cells(things, 0.05, INK)
    for person, colour in zip(scene.people, (ORANGE, GREEN), strict=True):
        sheet.circle(person[0], c.prices.person_radius, colour, 3.0)
        sheet.line(person, colour, 2.0)
    a, b = robot.half_length, robot.half_width
    sheet.polygon(np.array(((-a, -b), (a, -b), (a, b), (-a, b))), (245, 205, 90), INK)
    sheet.line(_path(mean, knot_s, c, body), BLUE, 4.0)
    sheet.legend(
        (
            ("plans weighed, the cheapest", _PALE),
            ("the new plan", BLUE),
            ("leader, 3 s", GREEN),
            ("somebody, 3 s", ORANGE),
        )
    )
    return sheet.finished()


def _scene(things: Array, body: Body, c: MPPIConfig) -> PlanningScene:
    distances = distance_field(things, HALF_M, CELL_M, FAR_M)
    people = np.array((_COMER, _LEADER))
    walked = walked_on(people, distances, HALF_M, CELL_M, c.evaluations, _EVERY * _STEP_S, c.prices.person_radius)
    narrow = body.half_width + c.prices.comfort
    places = (people[-1, :2], walked[-1, -1])
    now, then = (ways_to(place, distances, body.half_width, narrow, c.prices.keep) for place in places)
    motion = np.zeros((3, 2))
    motion[0, 0] = _SPEED_MPS
    cells, unseen = np.array((HALF_M, CELL_M, WAY_CELL_M)), np.zeros((0, 0))
    return PlanningScene(distances, distances, now, then, cells, walked, motion, 1.0, unseen)


def _path(plan: Array, knot_s: float, c: MPPIConfig, body: Body) -> Array:
    """Return (n, 2) where a plan leads, step by step [m]."""
    motion, pose, path = np.zeros((3, 2)), np.zeros(3), [np.zeros(2)]
    motion[0, 0] = _SPEED_MPS
    for t in np.arange(0.0, c.horizon_s, _STEP_S):
        wish = np.array([np.interp(t, knot_s * np.arange(len(plan)), plan[:, axis]) for axis in range(3)])
        drive(motion, pose, wish, _STEP_S, body, c.prices.turning)
        path.append(pose[:2].copy())
    return np.array(path)
