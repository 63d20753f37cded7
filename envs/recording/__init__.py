"""What happened in an episode, recorded: histories, rollouts and reference drives.

`EpisodeRecording` writes episodes into a recording for viewers (MCAP of ROS 2 messages, or rerun's own): it is handed
one, of `tagalong.slam.logs.open_recording`. All other names are private.
"""

from typing import TYPE_CHECKING

from ...slam.door import lends

if TYPE_CHECKING:
    from .episode_recording import EpisodeRecording

__all__ = ["EpisodeRecording"]

_HOME = {"EpisodeRecording": "episode_recording"}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
