"""The social force against its reference and against PySocialForce."""

import logging

import numpy as np
import pytest
from social_force_reference import social_force
from tagalong.envs.people.movement.obstacles import nearest_of_box
from tagalong.envs.people.movement.social_force import SocialForceConfig, pair_force
from tagalong.envs.people.movement.things import cell_of, keep_clear, things_around
from tagalong.envs.people.movement.walking import advance_bodies
from tagalong.envs.scenes.solids import Solid
from tagalong.slam import InputError

CONFIG = SocialForceConfig()


def random_pairs(count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-3.0, 3.0, (count, 2)), rng.uniform(-1.5, 1.5, (count, 2))


def test_the_kernel_equals_the_reference():
    for offset, velocity in zip(*random_pairs(200), strict=True):
        kernel = pair_force(*offset, *velocity, 0.0, CONFIG.as_array())
        assert kernel == pytest.approx(social_force(offset, velocity, CONFIG), abs=1e-12)


def test_the_force_between_people_equals_that_of_pysocialforce(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # the package writes a log file where it is imported
    level = logging.getLogger().level
    pysocialforce = pytest.importorskip("pysocialforce")
    logging.getLogger().setLevel(level)
    # The package does not wrap the angle between interaction and direction; here nothing needs wrapping.
    people = np.array(
        [
            [0.0, 0.0, 1.0, 0.2, 5.0, 0.0],
            [2.0, 0.5, -1.0, 0.1, -5.0, 0.0],
            [1.0, -1.0, 0.1, 0.5, 0.0, 5.0],
        ]
    )
    simulator = pysocialforce.Simulator(people.copy(), obstacles=[[10.0, 11.0, 10.0, 10.0]])
    force = next(f for f in simulator.forces if type(f).__name__ == "SocialForce")
    ours = [
        sum(
            social_force(people[j, :2] - people[i, :2], people[i, 2:4] - people[j, 2:4], CONFIG)
            for j in range(len(people))
            if j != i
        )
        for i in range(len(people))
    ]
    assert np.array(ours) == pytest.approx(force.get_force(), abs=1e-9)


def test_the_nearest_point_of_a_box_agrees_with_the_scene():
    rng = np.random.default_rng(1)
    solid = Solid(kind="box", x=0.4, y=-0.2, yaw=0.7, half_length=1.1, half_width=0.3)
    row = np.array([solid.x, solid.y, np.cos(solid.yaw), np.sin(solid.yaw), solid.half_length, solid.half_width])
    for point in rng.uniform(-2.0, 2.0, (200, 2)):
        distance, ux, uy = nearest_of_box(*point, row)
        assert distance == pytest.approx(float(solid.distance(point)), abs=1e-9)
        assert solid.distance(point + 0.01 * np.array([ux, uy])) == pytest.approx(distance + 0.01, abs=1e-6)


def test_a_point_too_near_to_furniture_is_moved_to_its_edge():
    things = things_around(np.array([[0.0, 0.0, 1.0, 0.0, 1.0, 0.5]]), np.array([[5.0, 0.0, 0.3]]), reach=0.5)
    assert keep_clear(0.2, 0.6, 0.25, things) == pytest.approx((0.2, 0.75))
    assert keep_clear(5.1, 0.0, 0.25, things) == pytest.approx((5.55, 0.0))
    assert keep_clear(3.0, 3.0, 0.25, things) == (3.0, 3.0)


def test_what_is_near_is_found_on_the_grid_wherever_somebody_stands():
    rng = np.random.default_rng(2)
    yaw = rng.uniform(-np.pi, np.pi, 30)
    middles, halves = rng.uniform(-8.0, 8.0, (30, 2)), rng.uniform(0.05, 2.5, (30, 2))
    boxes = np.column_stack((middles, np.cos(yaw), np.sin(yaw), halves))
    circles = np.column_stack((rng.uniform(-8.0, 8.0, (20, 2)), rng.uniform(0.02, 0.8, 20)))
    few = things_around(boxes, circles, reach=0.85)
    for x, y in rng.uniform(-14.0, 14.0, (500, 2)):
        cell = cell_of(x, y, few.frame)
        near = set(few.items[few.first[cell] : few.first[cell + 1]].tolist())
        wanted = {k for k in range(30) if nearest_of_box(x, y, boxes[k])[0] < 0.85}
        wanted |= {-1 - k for k in range(20) if np.hypot(x - circles[k, 0], y - circles[k, 1]) - circles[k, 2] < 0.85}
        assert wanted <= near


def test_two_who_meet_head_on_pass_each_other_without_touching():
    position, velocity = np.array([[0.0, 0.0], [6.0, 0.02]]), np.zeros((2, 2))
    direction, heading = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.0, np.pi])
    far_robot = np.array([0.0, 50.0, 1.0, 0.0, 0.0, 0.0, 0.3, 0.3])
    nearest = np.inf
    for _ in range(400):
        advance_bodies(0.025, position, velocity, heading, direction, np.ones(2), np.full(2, 0.23),
                       np.zeros(2, dtype=np.bool_), far_robot,
                       things_around(np.zeros((0, 6)), np.zeros((0, 3)), 1.0), CONFIG.as_array(),
                       np.empty((2, 2)))  # fmt: skip
        nearest = min(nearest, np.hypot(*(position[0] - position[1])))
    assert nearest > 0.46
    assert position[0, 0] > 5.0
    assert position[1, 0] < 1.0


def test_a_force_without_strength_is_an_error():
    with pytest.raises(InputError, match="gamma"):
        SocialForceConfig(gamma=0.0)
