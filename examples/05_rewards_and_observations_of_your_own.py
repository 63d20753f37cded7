"""Weights of the reward, a term of one's own, and an entry of the observation of one's own."""

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)
from gymnasium import spaces


def calm_near_people(facts):
    """A term: what truly happened in the step is in `facts`, which the robot never sees."""
    return -0.1 * facts.action_change if facts.bystander_space < 1.0 else 0.0


def nearest_return(belief):
    """An entry: what the robot believes, made of its sensors only."""
    return np.array([np.nanmin(belief.scan.ranges)], dtype=np.float32)


env = gym.make(
    "tagalong/Corridor-v0",
    slam=None,
    beams=181,
    entries={"nearest": (spaces.Box(0.0, 30.0, (1,), np.float32), nearest_return)},
    **{"reward.personal_space": 3.0, "reward.terms": {"calm_near_people": calm_near_people}},
)
observation, info = env.reset(seed=0)
observation, reward, *_, info = env.step([0.5, 0.0])
print(f"nearest return {observation['nearest'][0]:.2f} m, reward {reward:.3f} of {info['reward_terms']}")
env.close()
