"""Writes episodes into a recording for viewers: what the robot measured, believed and did, and the truth."""

from ...slam.logs.recording import AnyRecording
from ..follow_env import FollowEnv
from ..viewing.moments import Moments
from .rollout import Episode


class EpisodeRecording:
    """Takes episodes into a recording, one after the other; each begins a second after the one before has ended.

    Topics: `/scan`, `/scan_filtered`, `/odom`, `/people` (as tracked; the leader in another colour), `/map`, `/path`,
    and the tree of frames map, odom, base_link, laser; `/camera/image` and `/camera/depth`, where there is a camera;
    `/truth/pose` and `/truth/people` in the frame `world`. `finish` adds `/cmd_vel` and `/reward`.

    Example: `episode = rollout(env, follower, after_step=recording.take)`, then `recording.finish(episode)`.

    Args:
        recording: Where to. It is closed by who opened it.
    """

    def __init__(self, recording: AnyRecording) -> None:
        self._recording, self._moments = recording, Moments(recording)

    def take(self, env: FollowEnv) -> None:
        """Write the present moment of an episode; called after `reset` and after each step."""
        self._moments.take(env.world, env.truth, env.belief)

    def finish(self, episode: Episode) -> None:
        """Write what is known of an episode once it is over: actions and rewards, at the times of its steps."""
        history = episode.history
        robot, top_turn_rate = episode.config.robot, episode.config.task.top_turn_rate
        for time_s, action, reward in zip(history.time_s, history.action, history.reward, strict=True):
            now = self._moments.offset_s + float(time_s)
            sideways = action[1] * robot.max_speed if len(action) == 3 else 0.0
            self._recording.command(now, (action[0] * robot.max_speed, sideways, action[-1] * top_turn_rate))
            self._recording.number(now, float(reward), "/reward")
