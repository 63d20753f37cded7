"""Followers with a laser all round: how it is mounted, and where its beams are counted from, changes nothing."""

import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.envs.task import FollowInterface

DIRECTIONS = np.radians(np.arange(-180.0, 180.0))
LASERS = {
    "as usual": (np.arange(-180.0, 180.0), 0.0),
    "from ahead on": (np.arange(0.0, 360.0), 0.0),
    "clockwise": (np.arange(180.0, -180.0, -1.0), 0.0),
    "cable ahead": (np.arange(-180.0, 180.0), 180.0),
    "turned": (np.arange(-180.0, 180.0), -90.0),
    "turned, clockwise, from ahead on": (np.arange(360.0, 0.0, -1.0), 45.0),
}


def actions(name, half_width, bearings, turned):
    """What a follower does between walls while its leader goes from ahead to the right, out of sight, and back."""
    own = np.radians(bearings)
    mount = (0.1, 0.0, float(np.radians(turned)))
    robot = FollowInterface(bearings=own, T_robot_lidar=mount)
    order = np.round(np.degrees(own) + turned + 180.0).astype(int) % 360
    follower, done = make_follower(name, robot), []
    follower.reset()
    people = np.zeros((5, 6), dtype=np.float32)
    people[0] = 1.2, 0.8, 0.0, -0.5, 1.0, 1.0
    rng = np.random.default_rng(0)
    for k in range(25):
        there = k < 10 or k >= 20
        leader = np.array((1.8, -0.1 * k, 0.4, -0.4, 1.0, 1.0) if there else np.zeros(6), dtype=np.float32)
        ahead, aside = (np.maximum(np.abs(way(DIRECTIONS)), 1e-3) for way in (np.cos, np.sin))
        room = np.minimum(2.5 / ahead, half_width / aside)
        scan = ((room + rng.normal(0.0, 0.01, 360)) / robot.range_max).astype(np.float32)
        velocity = np.array((0.3, 0.8), dtype=np.float32)
        told = {"scan": scan[order], "leader": leader, "people": people, "velocity": velocity}
        done.append(np.asarray(follower.act(told)))
    return np.array(done)


NARROW, WIDE = 0.45, 0.9
"""Half of what is between the walls [m]; the narrower, the more roundings decide what a planner takes for possible."""


@pytest.mark.parametrize(
    ("name", "half_width", "within"),
    [
        ("pid", NARROW, 2e-3),
        ("pid+guard", NARROW, 2e-3),
        ("pure_pursuit", NARROW, 2e-3),
        ("reinforced", NARROW, 2e-3),
        ("learned", WIDE, 2e-3),
        ("dwa", WIDE, 2e-3),
        ("mppi", WIDE, 0.05),
    ],
)
def test_a_laser_all_round_is_the_same_however_it_is_mounted(name, half_width, within):
    usual = actions(name, half_width, *LASERS["as usual"])
    assert np.ptp(usual, axis=0).min() > 0.05
    for laser, numbers in LASERS.items():
        assert actions(name, half_width, *numbers) == pytest.approx(usual, abs=within), laser


@pytest.mark.parametrize("laser", LASERS)
def test_each_direction_is_at_its_beam_and_all_round_there_is_no_gap(laser):
    bearings, turned = LASERS[laser]
    own, turn = np.radians(bearings), float(np.radians(turned))
    robot = FollowInterface(bearings=own, T_robot_lidar=(0.1, 0.0, turn))
    assert robot.field_of_view == pytest.approx(2.0 * np.pi)
    inside = robot.along_scan(own[1:-1] + turn)
    assert inside == pytest.approx(np.arange(1, 359) / 359.0)
    step = own[1] - own[0]
    ends = robot.along_scan(own[0] + turn - step * np.array((0.4, 0.6)))
    assert ends == pytest.approx((0.0, 1.0))


def test_beside_a_narrower_view_the_laser_is_blind():
    robot = FollowInterface(bearings=np.radians(np.linspace(-90.0, 90.0, 181)), T_robot_lidar=(0.1, 0.0, np.pi / 2.0))
    assert robot.field_of_view == pytest.approx(np.pi)
    assert robot.along_scan(np.radians((1.0, 90.0, 179.0))) == pytest.approx((1.0 / 180.0, 0.5, 179.0 / 180.0))
    assert (robot.along_scan(np.radians((-1.0, -90.0, 181.0))) > 1.0).all()
