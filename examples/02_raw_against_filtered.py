"""The ablation of the paper in one loop: the same drive, mapped from filtered and from raw scans."""

import gymnasium as gym
import tagalong  # noqa: F401 (registers the environments)
from tagalong.agents import make_follower
from tagalong.slam import GMappingConfig

drives = {}
for filtered in (True, False):
    engine = GMappingConfig(particles=5, linear_update=0.1)
    env = gym.make("tagalong/Corridor-v0", people_count=2, beams=361, slam=engine, filter_people=filtered)
    follower = make_follower("pid", env.unwrapped.interface)
    observation, info = env.reset(seed=1)
    for _ in range(60):
        observation, *_, info = env.step(follower.act(observation))
    drives[filtered] = info["robot_pose"], env.unwrapped.own_map().map
    env.close()
(pose, clean), (same, raw) = drives[True], drives[False]
print(f"the same drive: {(pose == same).all()}")  # who follows does not look at the map
walls = [int((grid.probability > 0.1).sum()) for grid in (clean, raw)]
print(f"cells with any evidence of a wall: {walls[0]} filtered, {walls[1]} raw")
