"""Episodes of a command recorded for viewers, where that was asked for."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from ...envs.follow_env import FollowEnv
from ...envs.recording.episode_recording import EpisodeRecording
from ...envs.recording.rollout import Episode
from ...envs.viewing.live import LiveRecording
from ...slam.logs.recording import open_recording


class Recording(Protocol):
    """Takes episodes, moment by moment: `EpisodeRecording`, or nobody."""

    def take(self, env: FollowEnv) -> None:
        """Write the present moment of an episode."""
        ...

    def finish(self, episode: Episode) -> None:
        """Write what is known of an episode once it is over."""
        ...


class NoRecording:
    """Takes nothing."""

    def take(self, env: FollowEnv) -> None:
        """Do nothing."""

    def finish(self, episode: Episode) -> None:
        """Do nothing."""


@contextmanager
def recorded_episodes(path: Path | None) -> Iterator[Recording]:
    """Yield what takes episodes into a file (.mcap, .rrd); None: what takes them nowhere."""
    if path is None:
        yield NoRecording()
        return
    with open_recording(path) as recording:
        yield EpisodeRecording(recording)


@contextmanager
def shown_episodes(live: bool) -> Iterator[Recording]:
    """Yield what shows episodes in rerun's viewer while they are driven; what shows them nowhere, if not `live`."""
    if not live:
        yield NoRecording()
        return
    with LiveRecording() as recording:
        yield EpisodeRecording(recording)
