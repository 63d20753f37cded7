"""What happened in an episode, recorded: histories, rollouts and reference drives; for viewers, and to learn from.

    EpisodeRecording        writes episodes for viewers: MCAP of ROS 2 messages, or rerun's own; into a recording of
                            `tagalong.slam.logs.open_recording`
    demonstrate(env, ...)   drives an episode and returns it as a Demonstration: observations, actions, rewards
    write_minari(...)       demonstrations as a dataset of Minari (extra `datasets`)
    write_lerobot(...)      the same as a dataset of LeRobot v3 (extra `datasets`)

All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .demonstration import Demonstration, demonstrate
    from .episode_recording import EpisodeRecording
    from .lerobot_dataset import write_lerobot
    from .minari_dataset import write_minari

__all__ = ["Demonstration", "EpisodeRecording", "demonstrate", "write_lerobot", "write_minari"]

_HOME = {
    "Demonstration": "demonstration",
    "EpisodeRecording": "episode_recording",
    "demonstrate": "demonstration",
    "write_lerobot": "lerobot_dataset",
    "write_minari": "minari_dataset",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
