"""Hundreds of worlds in one compiled call: a policy of arrays follows its leaders, and what it earns is counted."""

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)

WORLDS = 64


def towards_the_leader(leader):
    """Return actions (n, 2): 1.3 m behind each leader (n, 6), turning to it; still where it is not seen."""
    x, y, visible = leader[:, 0], leader[:, 1], leader[:, 5:]
    return visible * np.stack((np.clip(x - 1.3, 0.0, 1.0), np.clip(2.0 * np.arctan2(y, x), -1.0, 1.0)), axis=1)


env = gym.make_vec(
    "tagalong/Corridor-v0",
    num_envs=WORLDS,
    vectorization_mode="vector_entry_point",
    simulator="compiled",
    beams=181,
    episodes_ahead=8,
)
observation, info = env.reset(seed=0)
total = np.zeros(WORLDS)
for _ in range(100):
    observation, reward, terminated, truncated, info = env.step(towards_the_leader(observation["leader"]))
    total += reward
print(f"{WORLDS} worlds, 10 s: {total.mean():.1f} earned on average, {np.mean(info['leader_distance']):.2f} m behind")
env.close()
