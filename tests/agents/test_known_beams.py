"""The laser that a policy knows, made of others."""

import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.agents.learned.known_beams import AHEAD, KnownBeams
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

KNOWN = float(np.radians(270.0))


def laser(first, last, beams, turned=0.0):
    """A robot whose laser has beams from `first` to `last` [deg], and is mounted turned by `turned` [deg]."""
    bearings = np.radians(np.linspace(first, last, beams))
    return FollowInterface(bearings=bearings, T_robot_lidar=(0.1, 0.0, float(np.radians(turned))))


def told(robot, least=60):
    """Bearings (robot frame), and what is told there of a laser that reads its bearing, as a share of the circle."""
    beams = KnownBeams(robot, KNOWN, least)
    ahead = (robot.bearings + robot.T_robot_lidar[2] + np.pi) % (2.0 * np.pi) - np.pi
    scan = beams.scan({"scan": (np.abs(ahead) / np.pi / 2.0).astype(np.float32)})
    return beams.interface.bearings + robot.T_robot_lidar[2], scan


def test_the_laser_that_a_policy_was_trained_with_is_told_as_it_is():
    robot = FollowInterface(bearings=np.linspace(-0.5 * KNOWN, 0.5 * KNOWN, 1081))
    beams, scan = KnownBeams(robot, KNOWN, 60), np.random.default_rng(0).random(1081, dtype=np.float32)
    assert np.array_equal(beams.scan({"scan": scan}), scan)
    assert np.array_equal(beams.interface.bearings, robot.bearings)


@pytest.mark.parametrize(
    "robot",
    [
        laser(-180.0, 179.5, 720),
        laser(180.0, -179.0, 360),  # clockwise
        laser(-180.0, 179.0, 360, turned=90.0),
        laser(-180.0, 179.0, 360, turned=180.0),
        laser(0.0, 359.0, 360),
        laser(-135.0, 134.8, 750),
        laser(-170.0, 170.0, 35),  # fewer beams than sectors
    ],
)
def test_of_a_laser_that_sees_more_each_beam_is_the_nearest(robot):
    bearings, scan = told(robot)
    spacing = np.abs(np.diff(robot.bearings)).max()
    assert len(scan) >= 60
    assert np.degrees(bearings[[0, -1]]) == pytest.approx((-135.0, 135.0))
    assert np.abs(scan * 2.0 * np.pi - np.abs(bearings))[1:-1].max() <= 0.51 * spacing
    assert np.abs(scan * 2.0 * np.pi - np.abs(bearings)).max() <= spacing


@pytest.mark.parametrize(("first", "last"), [(-90.0, 90.0), (-120.0, 120.0), (-43.0, 43.0), (-45.0, 130.0)])
def test_what_a_narrower_laser_does_not_see_reads_nothing(first, last):
    bearings, scan = told(laser(first, last, 181))
    beyond = (np.degrees(bearings) < first - 2.0) | (np.degrees(bearings) > last + 2.0)
    within = (np.degrees(bearings) > first) & (np.degrees(bearings) < last)
    assert (scan[beyond] == 1.0).all()
    assert (scan[within] < 0.5).all()


@pytest.mark.parametrize("name", ["learned", "reinforced"])
def test_who_does_not_look_ahead_is_refused(name):
    with pytest.raises(InputError, match="looks 30 degrees to either side of straight ahead, got one from 45 to 315"):
        make_follower(name, laser(-135.0, 135.0, 541, turned=180.0))
    with pytest.raises(InputError, match="straight ahead"):
        make_follower(name, laser(-20.0, 20.0, 81))
    make_follower(name, laser(-np.degrees(AHEAD), np.degrees(AHEAD), 81))


@pytest.mark.parametrize("name", ["learned", "reinforced", "reinforced-alone"])
@pytest.mark.parametrize("robot", [laser(-90.0, 90.0, 181), laser(-180.0, 179.0, 360), laser(-170.0, 170.0, 35)])
def test_policies_drive_with_other_lasers_and_mind_what_these_see(name, robot):
    follower = make_follower(name, robot)
    leader = np.array((1.6, 0.0, 0.5, 0.0, 1.0, 1.0), dtype=np.float32)
    seen = {"leader": leader, "people": np.zeros((5, 6), dtype=np.float32), "velocity": np.zeros(2, dtype=np.float32)}
    clear = np.ones(len(robot.bearings), dtype=np.float32)
    blocked = np.full(len(robot.bearings), 0.3 / robot.range_max, dtype=np.float32)
    forward = []
    for scan in (clear, blocked):
        follower.reset()
        for _ in range(10):
            action = follower.act({**seen, "scan": scan})
        forward.append(action[0])
    assert forward[0] > 0.1
    assert forward[1] < 0.5 * forward[0]
