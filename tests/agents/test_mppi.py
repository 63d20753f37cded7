"""The planner on ideal motion, drawn rooms and single plans; no simulator."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike
from tagalong.agents import MPPIConfig, make_follower
from tagalong.agents.learned.steering import SteeringConfig, steer
from tagalong.agents.planned.config import PriceConfig
from tagalong.agents.planned.fields import CELL_M, FAR_M, HALF_M, WAY_CELL_M, distance_field, value_at, ways_to
from tagalong.agents.planned.mppi import MPPIFollower, weights
from tagalong.agents.planned.plan_kernel import axis_step, harm
from tagalong.agents.planned.prediction import walked_on
from tagalong.agents.planned.robot_body import body_of
from tagalong.agents.planned.standing_things import StandingThings
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

BEAMS = 181
BEARINGS = np.deg2rad(np.linspace(-135, 135, BEAMS))
ROBOT = FollowInterface(bearings=BEARINGS, T_robot_lidar=(0.0, 0.0, 0.0))
HOLONOMIC = replace(ROBOT, holonomic=True, half_length=0.34)
WALL = np.stack((np.linspace(-1.0, 3.0, 81), np.full(81, 1.0)), axis=1)


def seen(leader=None, velocity=(0.0, 0.0), ranges: ArrayLike = 30.0, people=()):
    table = np.zeros((6, 6), dtype=np.float32)
    for row, person in enumerate(people):
        table[row] = [*person, 0.9, 1.0]
    return {
        "scan": (np.full(BEAMS, ranges) / 30.0).astype(np.float32),
        "leader": np.array([0.0] * 6 if leader is None else [*leader, 0.9, 1.0], dtype=np.float32),
        "people": table,
        "velocity": np.array(velocity, dtype=np.float32),
    }


def driven(follower, leader_at, seconds, person=None):
    """Drive an ideal unicycle behind a leader who walks ahead; return rows of (x, y, theta, speed)."""
    pose, speed, turn, rows = np.zeros(3), 0.0, 0.0, []
    for t in np.arange(0.0, seconds, 0.1):
        cos, sin = math.cos(pose[2]), math.sin(pose[2])
        into = np.array([[cos, sin], [-sin, cos]])
        pace = (np.array(leader_at(t + 1e-3)) - leader_at(t)) / 1e-3
        row = [*(into @ (np.array(leader_at(t)) - pose[:2])), *(into @ pace)]
        others = [] if person is None else [[*(into @ (np.array(person) - pose[:2])), 0.0, 0.0]]
        action = follower.act(seen(row, (speed, turn), people=others))
        speed, turn = float(action[0]) * ROBOT.max_speed, float(action[1]) * ROBOT.max_turn_rate
        pose += np.array([speed * cos, speed * sin, turn]) * 0.1
        rows.append((*pose, speed))
    return np.array(rows)


def test_it_keeps_its_distance_behind_a_straight_leader_and_drives_smoothly():
    rows = driven(MPPIFollower(ROBOT), lambda t: (1.3 + 0.8 * t, 0.0), 12.0)
    gap = 1.3 + 0.8 * np.arange(0.0, 12.0, 0.1) - rows[:, 0]
    assert np.abs(gap[60:] - PriceConfig().keep).max() < 0.25
    assert np.abs(np.diff(rows[60:, 3], 2) * 100.0).max() < 3.0


def test_it_drives_round_who_stands_in_the_way():
    rows = driven(MPPIFollower(ROBOT), lambda t: (min(1.3 + 0.8 * t, 5.5), 0.0), 10.0, person=(2.5, 0.05))
    away = np.hypot(rows[:, 0] - 2.5, rows[:, 1] - 0.05)
    assert away.min() > 0.27 + 0.2
    assert rows[-1, 0] > 3.5


@pytest.mark.parametrize("robot", [ROBOT, HOLONOMIC])
def test_one_seed_draws_the_same_plans_and_another_seed_others(robot):
    still = (0.0,) * (3 if robot.holonomic else 2)
    sights = [seen([1.5, 0.1 * k, 0.7, 0.0], still, people=[[1.0, 1.0, 0.0, -0.5]]) for k in range(8)]
    one, again, other = (MPPIFollower(robot, MPPIConfig(seed=seed)) for seed in (0, 0, 1))
    first = [one.act(sight).tobytes() for sight in sights]
    assert [again.act(sight).tobytes() for sight in sights] == first
    one.reset()
    assert [one.act(sight).tobytes() for sight in sights] == first
    assert [other.act(sight).tobytes() for sight in sights] != first
    assert len(one.act(sights[0])) == (3 if robot.holonomic else 2)


def test_a_holonomic_robot_steps_aside_too():
    follower = MPPIFollower(HOLONOMIC)
    actions = np.array([follower.act(seen([1.2, 0.9, 0.0, 0.0], (0.0, 0.0, 0.0))) for _ in range(15)])
    assert np.abs(actions).max() <= 1.0
    assert np.abs(actions[:, 1]).max() > 0.05


def test_it_waits_for_a_leader_and_looks_for_a_lost_one():
    follower = make_follower("mppi", ROBOT)
    assert not follower.act(seen()).any()
    follower.act(seen([0.4, 0.2, 0.0, 0.0]))
    turns = [follower.act(seen())[1] for _ in range(80)]
    assert abs(turns[-1]) > 0.1


def test_a_step_of_an_axis_is_that_of_the_steering():
    c, robot = SteeringConfig(), ROBOT
    limits = body_of(robot, c).limits
    state, (v, a), (w, b) = (0.0, 0.0, 0.0, 0.0), (0.0, 0.0), (0.0, 0.0)
    for speed, rate in ((1.2, 1.0), (1.2, -1.5), (-0.3, 0.2), (0.0, 0.0)) * 3:
        state = steer(state, speed, rate, 0.1, c)
        (v, a), (w, b) = axis_step(v, a, speed, 0.1, limits[0]), axis_step(w, b, rate, 0.1, limits[2])
        assert (v, a, w, b) == pytest.approx(state)


@pytest.mark.parametrize("robot", [ROBOT, HOLONOMIC])
def test_the_discs_cover_the_outline_of_the_robot_and_little_more(robot):
    body = body_of(robot, SteeringConfig())
    a, b, t = robot.half_length, robot.half_width, np.linspace(-1.0, 1.0, 41)
    outline = np.vstack([np.stack((a * t, np.full(41, s * b)), axis=1) for s in (-1, 1)])
    outline = np.vstack([outline, *[np.stack((np.full(41, s * a), b * t), axis=1) for s in (-1, 1)]])
    away = np.hypot(*(outline[:, None] - body.discs).transpose(2, 0, 1)).min(axis=1)
    assert away.max() <= body.disc_radius + 1e-9
    assert (np.abs(body.discs) + body.disc_radius - (a, b)).max() < 0.05


def test_the_field_of_distances_is_that_of_brute_force():
    points = np.random.default_rng(3).uniform(-HALF_M, HALF_M, (40, 2))
    field = distance_field(points, HALF_M, CELL_M, FAR_M)
    middles = CELL_M * (np.arange(len(field)) + 0.5) - HALF_M
    places = np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)
    nearest = np.min([np.hypot(*(places - point).transpose(2, 0, 1)) for point in points], axis=0)
    assert np.abs(field - np.minimum(nearest, FAR_M)).max() < 0.5 * CELL_M
    assert value_at(field, middles[31], middles[57], HALF_M, CELL_M) == pytest.approx(field[31, 57])


def test_the_way_round_a_wall_is_longer_than_the_straight_one():
    wall = np.stack((np.full(81, 1.0), np.linspace(-2.0, 2.0, 81)), axis=1)
    ways = ways_to(np.array((2.0, 0.0)), distance_field(wall, HALF_M, CELL_M, FAR_M), 0.26, 0.5, 1.2)
    assert 4.5 < value_at(ways, 0.0, 0.0, HALF_M, WAY_CELL_M) < 8.0
    assert value_at(ways, 3.5, 0.0, HALF_M, WAY_CELL_M) == pytest.approx(1.5, abs=0.2)


def test_people_are_predicted_along_walls_and_not_through_them():
    distances = distance_field(WALL, HALF_M, CELL_M, FAR_M)
    people = np.array([[0.0, 0.0, 0.6, 0.6], [0.0, -1.0, 0.5, 0.0]])
    into, free = walked_on(people, distances, HALF_M, CELL_M, 15, 0.2, 0.22)
    assert into[:, 1].max() < 0.85
    assert into[-1, 0] > 1.4
    assert free[-1] == pytest.approx([1.5, -1.0])


def test_what_is_not_in_sight_is_remembered_until_a_beam_goes_through_it():
    things = StandingThings(ROBOT, 4.0, 10.0)
    none = np.zeros((0, 2))
    post = np.full(BEAMS, 30.0)
    post[88:93] = 2.0
    assert len(things.update(seen(ranges=post), none, 0.4)) > 0
    hidden = np.where(np.abs(BEARINGS) < 0.3, 1.0, 30.0)
    kept = things.update(seen(ranges=hidden), none, 0.4)
    assert (kept[:, 0] > 1.9).any()
    assert len(things.update(seen(), none, 0.4)) == 0
    assert len(things.update(seen(ranges=post), np.array([[2.0, 0.0]]), 0.4)) == 0


def test_who_drives_into_somebody_does_harm_and_who_is_run_into_hardly_any():
    assert harm(-0.3) == harm(0.0) < 0.1 < harm(0.25) < harm(0.6) == harm(1.3) == 1.0


def test_the_safety_filter_fits_behind_it():
    follower = make_follower("mppi+guard", ROBOT)
    near = np.where(np.abs(BEARINGS) < 0.5, 0.35, 30.0)
    actions = [follower.act(seen([2.5, 0.0, 0.5, 0.0], ranges=near)) for _ in range(10)]
    assert max(action[0] for action in actions) < 0.05


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: MPPIConfig(knots=1), "2 `knots`"),
        (lambda: MPPIConfig(temperature=0.0), "temperature"),
        (lambda: PriceConfig(people=-1.0), "`people`"),
    ],
)
def test_settings_that_cannot_be_are_refused(make, said):
    with pytest.raises(InputError, match=said):
        make()


def test_the_cheaper_a_plan_the_more_it_counts():
    counted = weights(np.array([3.0, 1.0, 2.0]), temperature=0.5)
    np.testing.assert_allclose(counted.sum(), 1.0)
    np.testing.assert_allclose(counted[1] / counted[2], np.exp(2.0))
    assert counted[1] > counted[2] > counted[0]
