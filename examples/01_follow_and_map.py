"""A robot follows a person and maps the corridor on the way; the map is written as ROS reads it."""

import tempfile
from pathlib import Path

import gymnasium as gym
import tagalong  # noqa: F401 (registers the environments)
from tagalong.agents import make_follower
from tagalong.envs import rollout
from tagalong.slam import write_ros_map

env = gym.make("tagalong/Corridor-v0", people_count=2, slam="gmapping", beams=361)
episode = rollout(env, make_follower("pid"), seed=0, steps=80)
own = env.unwrapped.own_map()
folder = Path(tempfile.mkdtemp())
write_ros_map(folder / "map.yaml", own.map)
print(f"{len(episode.history)} rows of history, reward {episode.total_reward:.1f}")
print(f"{int(own.map.occupied.sum())} occupied cells in {folder / 'map.yaml'}; the robot is at {own.pose.round(2)}")
env.close()
