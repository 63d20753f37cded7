"""People with a behaviour of one's own: somebody who comes to look at the robot, and then loses interest."""

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)
from tagalong.envs import Behaviour, Wish


class Curious(Behaviour):
    """Walks up to the robot, looks at it from 1.5 m for a while, and goes on along the corridor."""

    start = (8.0, 0.0, np.pi)  # begins 8 m down the corridor; without this, at a place of the route that is drawn

    def __init__(self, patience_s):
        self.interest_s = patience_s

    def wish(self, view, dt):
        """Return what to do now; called ten times a second."""
        if self.interest_s <= 0.0:
            return Wish(speed=1.0, offset=view.way.within_free(-0.6))
        if view.robot_distance > 1.5:
            return Wish(speed=0.9, goal=tuple(view.robot_position))
        self.interest_s -= dt
        return Wish(speed=0.0, face=view.robot_direction)


env = gym.make("tagalong/Corridor-v0", behaviours=[Curious(3.0)], people_count=0, leader=False, slam=None)
env.reset(seed=0, options={"route": "forward"})
for step in range(150):
    env.step([0.0, 0.0])
    if step % 25 == 0:
        truth = env.unwrapped.truth
        distance = np.hypot(*(truth.people.positions[-1] - truth.robot_pose[:2]))
        print(f"{truth.time_s:4.1f} s: the curious person is {distance:.1f} m from the robot")
env.close()
