"""The environments that `import tagalong` makes known to Gymnasium; their code loads when one is made."""

import math
from typing import Any

import gymnasium as gym

IDS: dict[str, dict[str, Any]] = {
    "tagalong/Corridor-v0": {"scene": "corridor"},
    "tagalong/FloorPlan-v0": {"scene": "floor_plan", "people_count": None},
    "tagalong/Lab-v0": {"scene": "lab"},
    "tagalong/Landmarks-v0": {
        "scene": "landmarks",
        "slam": "ekf",
        "beams": 181,
        "field_of_view": math.pi,
        "lidar.range_max": 8.0,
    },
    "tagalong/MeetingRoom-v0": {"scene": "meeting_room"},
    "tagalong/Office-v0": {"scene": "office", "people_count": None},
    "tagalong/PlainCorridor-v0": {"scene": "plain_corridor"},
}
"""Id -> the keyword arguments of `FollowEnv` that make it."""
MAX_EPISODE_STEPS = 3000
"""Steps after which an episode is truncated: five minutes at 10 Hz, longer than any tour."""


def register_environments() -> None:
    """Register every id that is not registered yet."""
    for name, arguments in IDS.items():
        if name not in gym.registry:
            gym.register(
                id=name,
                entry_point="tagalong.envs.follow_env:FollowEnv",
                vector_entry_point="tagalong.envs.simulators.make_vector_env:make_vector_env",
                max_episode_steps=MAX_EPISODE_STEPS,
                kwargs=arguments,
            )
