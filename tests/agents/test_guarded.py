"""The safety filter that every follower can wear, and the follower of the paper that wears nothing."""

import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.agents.learned.guarded import Guarded
from tagalong.envs.task import FollowInterface
from tagalong.slam import InputError

BEAMS = 361
INTERFACE = FollowInterface(bearings=np.deg2rad(np.linspace(-135.0, 135.0, BEAMS)))


def seen(wall=30.0, leader=(3.0, 0.0, 0.0, 0.0, 1.0, 1.0), velocity=(0.0, 0.0)):
    """An observation with a wall `wall` metres ahead of the robot's centre."""
    with np.errstate(divide="ignore"):
        ways = np.where(np.cos(INTERFACE.bearings) > 0.05, (wall - 0.1) / np.cos(INTERFACE.bearings), 30.0)
    return {
        "scan": np.minimum(ways / 30.0, 1.0).astype(np.float32),
        "leader": np.array(leader, np.float32),
        "people": np.zeros((6, 6), np.float32),
        "velocity": np.array(velocity, np.float32),
    }


def test_the_plain_pid_sees_no_wall_and_with_the_filter_it_stops_before_it():
    for name, stops in (("plain_pid", False), ("plain_pid+guard", True)):
        follower, place, speed = make_follower(name, INTERFACE), 0.0, 0.0
        follower.reset()
        for _ in range(40):
            wall = 2.0 - place
            if wall < 0.3:
                break
            leader = (3.0 - place, 0.0, 0.0, 0.0, 1.0, 1.0)
            action = follower.act(seen(wall, leader, (speed, 0.0)))
            speed += float(np.clip(1.3 * action[0] - speed, -0.2, 0.2))
            place += 0.1 * speed
        assert (2.0 - place > 0.3) == stops


def test_in_the_open_the_filter_changes_nothing_to_the_bit():
    alone, guarded = make_follower("pid", INTERFACE), make_follower("pid+guard", INTERFACE)
    for k in range(10):
        shown = seen(leader=(2.0, 0.1 * k, 0.5, 0.0, 1.0, 1.0))
        assert np.array_equal(alone.act(shown), guarded.act(shown))


def test_the_plain_pid_stands_until_somebody_leads():
    follower = make_follower("plain_pid", INTERFACE)
    assert np.array_equal(follower.act(seen(leader=np.zeros(6))), [0.0, 0.0])
    assert follower.act(seen())[0] > 0.5


def test_who_drives_sideways_cannot_wear_the_filter():
    class Crab:
        def reset(self):
            pass

        def act(self, observation):
            return np.array([0.0, 0.5, 0.0], np.float32)

    with pytest.raises(InputError, match="drives sideways"):
        Guarded(Crab(), INTERFACE).act(seen())


def test_the_filter_is_for_those_who_follow():
    with pytest.raises(InputError, match="frontier explores without a leader"):
        make_follower("frontier+guard")
    with pytest.raises(InputError, match="needs a leader"):
        make_follower("plain_pid+guard", INTERFACE).act({"scan": seen()["scan"]})
