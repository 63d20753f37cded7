"""A SLAM engine of one's own in the environment: this one believes the wheels, and draws what it sees."""

import gymnasium as gym
import numpy as np
import tagalong  # noqa: F401 (registers the environments)
from tagalong.slam import OccupancyMap, SlamUpdate


class DeadReckoning:
    """Poses by odometry; the map is the last return in each cell of 10 cm."""

    def __init__(self):
        self.poses, self.cells = [], np.full((400, 400), np.nan, dtype=np.float32)

    def update(self, odometry, scan):
        """Take one scan and its odometry pose."""
        pose = np.asarray(odometry, dtype=np.float64)
        self.poses.append(pose)
        x, y = scan.points_robot.T
        c, s = np.cos(pose[2]), np.sin(pose[2])
        col, row = (np.stack((pose[0] + c * x - s * y, pose[1] + s * x + c * y)) / 0.1 + 200).astype(int)
        inside = (col >= 0) & (col < 400) & (row >= 0) & (row < 400)
        self.cells[row[inside], col[inside]] = 1.0
        return SlamUpdate(pose, True, {})

    @property
    def pose(self):
        """Where the robot is."""
        return self.poses[-1] if self.poses else np.zeros(3)

    def trajectory(self):
        """Return where it has been."""
        return np.array(self.poses)

    def map(self):
        """Return the map."""
        return OccupancyMap(self.cells.copy(), 0.1, (-20.0, -20.0))

    live_map = map

    def finish(self):
        """Do nothing more."""


env = gym.make("tagalong/Corridor-v0", slam=lambda seed: DeadReckoning(), beams=181)
env.reset(seed=0)
for _ in range(20):
    *_, info = env.step([0.5, 0.1])
print(f"it believes to be at {info['map_pose'].round(2)}; {int(env.unwrapped.own_map().map.occupied.sum())} cells")
env.close()
