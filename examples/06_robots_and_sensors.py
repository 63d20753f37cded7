"""Other robots, lasers and numbers of the tracker; every setting has a path."""

import gymnasium as gym
import tagalong  # noqa: F401 (registers the environments)
from tagalong.envs import RobotConfig

SETTINGS = {
    "the paper's robot": {"robot": "dingo-o"},
    "the second paper's": {"robot": "pioneer"},
    "one of your own": {"robot": RobotConfig(chassis=(0.9, 0.6, 0.15), max_speed=1.0)},
    "a cheap laser": {"beams": 240, "lidar.range_max": 8.0, "lidar.sigma_near": 0.03},
    "a laser at 0.3 m, 20 Hz": {"lidar.height": 0.3, "lidar.rate_hz": 20.0},
    "numbers of Table II": {"perception.removal.zeta": 0.5, "perception.tracker.evidence.least_way": 0.3},
}
for name, settings in SETTINGS.items():
    env = gym.make("tagalong/Corridor-v0", slam=None, **settings)
    env.reset(seed=0)
    still = [0.0] * env.action_space.shape[0]
    *_, info = env.step([0.5, *still[1:]])
    robot = env.unwrapped.config.robot
    print(f"{name}: {robot.size[0]:.2f} x {robot.size[1]:.2f} m, leader at {info['leader_distance']:.2f} m")
    env.close()
