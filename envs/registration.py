"""The environments that `import tagalong` makes known to Gymnasium; their code loads when one is made."""

import gymnasium as gym

IDS = {
    "tagalong/Corridor-v0": "corridor",
    "tagalong/Lab-v0": "lab",
    "tagalong/MeetingRoom-v0": "meeting_room",
    "tagalong/PlainCorridor-v0": "plain_corridor",
}
"""Id -> scene."""
MAX_EPISODE_STEPS = 3000
"""Steps after which an episode is truncated: five minutes at 10 Hz, longer than any tour."""


def register_environments() -> None:
    """Register every id that is not registered yet."""
    for name, scene in IDS.items():
        if name not in gym.registry:
            gym.register(
                id=name,
                entry_point="tagalong.envs.follow_env:FollowEnv",
                max_episode_steps=MAX_EPISODE_STEPS,
                kwargs={"scene": scene},
            )
