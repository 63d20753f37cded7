"""Explorers in a simulated building."""

import gymnasium as gym
from tagalong.agents import make_follower


def test_a_random_walk_does_not_swing_its_tail_into_what_it_passed():
    env = gym.make("tagalong/Office-v0", leader=False, people="truth", slam=None, disable_env_checker=True)
    walk = make_follower("random", env.unwrapped.interface)  # pyright: ignore[reportAttributeAccessIssue]
    observation, _ = env.reset(seed=505)
    for _ in range(300):
        observation, _, terminated, _, info = env.step(walk.act(observation))
        assert not terminated, info["ending"]
