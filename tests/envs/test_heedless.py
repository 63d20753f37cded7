"""Bystanders who do not see the robot: they make no room for it, in both simulators alike."""

import gymnasium as gym
import numpy as np
import pytest
from tagalong.envs.people.movement.social_force import SocialForceConfig
from tagalong.envs.people.movement.things import things_around
from tagalong.envs.people.movement.walking import advance_bodies
from tagalong.slam import InputError

QUIET = {"slam": None, "people": "truth", "beams": 61, "ends_on_contact": False}


def walked(heedless):
    """Where somebody was (200, 2) who walked east for 5 s, towards a robot that stands 2 m before them [m]."""
    position, velocity, heading = np.array([[0.0, 0.1]]), np.zeros((1, 2)), np.zeros(1)
    robot, nothing = (
        np.array([2.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.35, 0.26]),
        things_around(np.zeros((0, 6)), np.zeros((0, 3)), 1.0),
    )
    force, direction = SocialForceConfig().as_array(), np.array([[1.0, 0.0]])
    places = []
    for _ in range(200):
        advance_bodies(0.025, position, velocity, heading, direction, np.ones(1), np.full(1, 0.23),
                       np.array([heedless]), robot, nothing, force, np.empty((1, 2)))  # fmt: skip
        places.append(position[0].copy())
    return np.array(places)


def test_who_does_not_see_the_robot_comes_up_to_it_and_then_steps_aside():
    seen, unseen = walked(False), walked(True)
    assert min(np.hypot(*(seen - (2.0, 0.0)).T)) > min(np.hypot(*(unseen - (2.0, 0.0)).T)) + 0.1
    beyond = np.abs(unseen - (2.0, 0.0)) - (0.35, 0.26)
    assert np.hypot(*np.maximum(beyond, 0.0).T).min() > 0.23  # nobody walks into who stands


def bystanders(share, seed=5):
    """How many people there are, which of them are heedless, and where they begin."""
    env = gym.make("tagalong/Office-v0", people_count=9, heedless=share, **QUIET)
    env.reset(seed=seed)
    people = env.unwrapped.world._plan.casting.people
    return np.array([person.heedless for person in people]), [person.start for person in people]


def test_a_share_of_the_bystanders_is_heedless_and_all_else_is_as_without():
    none, few, all_ = (bystanders(share) for share in (0.0, 0.5, 1.0))
    assert none[1] == few[1] == all_[1]
    assert not none[0].any()
    assert not all_[0][0]  # the leader sees who follows
    assert 0 < few[0].sum() < all_[0].sum()
    assert not (few[0] & ~all_[0]).any()


def test_heedless_people_walk_alike_in_both_simulators():
    fields = {**QUIET, "people_count": 7, "heedless": 1.0, "odometry": "perfect", "lost_limit_s": 1e6}
    many = gym.make_vec("tagalong/Office-v0", 1, "vector_entry_point", simulator="compiled", workers=1,
                        episodes_ahead=4, own_start=True, **fields)  # fmt: skip
    one = gym.make("tagalong/Office-v0", disable_env_checker=True, **fields)
    got, _ = many.reset(seed=3)
    wanted, _ = one.reset(seed=3)
    for _ in range(40):
        assert got["people"][0] == pytest.approx(wanted["people"], abs=1e-3)
        got, *_ = many.step(np.zeros((1, 2), dtype=np.float32))
        wanted, *_ = one.step(np.zeros(2, dtype=np.float32))
    many.close()


@pytest.mark.parametrize("share", [-0.1, 1.5, np.nan, "all"])
def test_a_share_that_is_none_is_refused(share):
    with pytest.raises(InputError, match="heedless"):
        gym.make("tagalong/Office-v0", heedless=share, **QUIET)
    with pytest.raises(InputError, match="heedless"):
        gym.make("tagalong/Office-v0", **QUIET).reset(seed=0, options={"heedless": share})
