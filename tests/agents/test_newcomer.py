"""Followers that were told nothing of their environment."""

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import FOLLOWERS, make_follower
from tagalong.agents.scripted.pid import PIDFollower
from tagalong.envs import rollout
from tagalong.slam import InputError


@pytest.mark.parametrize("name", [*sorted(FOLLOWERS), "random"])
def test_a_follower_without_an_interface_learns_it_from_the_environment(name):
    env = gym.make("tagalong/Corridor-v0", slam=None, people="truth", beams=360, drive="holonomic")
    told = rollout(env, make_follower(name, env.unwrapped.interface), seed=1, steps=6)
    learned = rollout(env, make_follower(name), seed=1, steps=6)
    assert (told.history.robot_pose == learned.history.robot_pose).all()


def test_one_follower_serves_environments_with_other_lasers_one_after_the_other():
    follower = make_follower("pid")
    for beams in (360, 1081, 360):
        env = gym.make("tagalong/Corridor-v0", slam=None, people="truth", beams=beams)
        told = rollout(env, make_follower("pid", env.unwrapped.interface), seed=1, steps=6)
        assert (rollout(env, follower, seed=1, steps=6).history.robot_pose == told.history.robot_pose).all()


def observation(beams, axes=2):
    return {
        "scan": np.full(beams, 0.1, dtype=np.float32),
        "leader": np.array((1.5, 0.2, 0.6, 0.0, 0.9, 1.0), dtype=np.float32),
        "people": np.zeros((6, 6), dtype=np.float32),
        "velocity": np.zeros(axes, dtype=np.float32),
    }


@pytest.mark.parametrize("name", sorted(FOLLOWERS))
def test_who_steps_without_rollout_need_not_tell_the_number_of_beams(name):
    follower = make_follower(name)
    for beams, axes in ((1081, 2), (360, 2), (360, 3)):
        follower.reset()
        assert follower.act(observation(beams, axes)).shape == (axes,)


def test_a_follower_that_was_made_for_another_laser_says_so_in_one_line():
    with pytest.raises(InputError, match="360 beams, this follower was made for 1081: make it with the interface"):
        PIDFollower().act(observation(360))


def test_an_environment_as_it_is_by_default_changes_nothing():
    env = gym.make("tagalong/Corridor-v0", slam=None, people="truth")
    follower = make_follower("pid")
    before = follower.follower
    follower.learn_interface(env.unwrapped.interface)
    assert follower.follower is before
