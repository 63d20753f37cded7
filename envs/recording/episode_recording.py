"""Writes episodes into a recording for viewers: what the robot measured, believed and did, and the truth."""

import numpy as np

from ...slam.geometry import compose, inverse
from ...slam.logs.recording import AnyRecording
from ...slam.logs.viewer_recording import MAP, ODOM
from ..follow_env import FollowEnv
from .rollout import Episode

WORLD = "world"
"""Frame of the truth: the simulator's. Nothing ties it to the others but `/truth/pose`, as nothing ties the robot's
mind to the truth."""
_MAP_EVERY_S = 1.0
_BETWEEN_EPISODES_S = 1.0


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
        self._recording = recording
        self._began_s = self._last_s = self._frame_s = self._map_s = -np.inf
        self._offset_s = 0.0
        self._path: list[np.ndarray] = []

    def take(self, env: FollowEnv) -> None:
        """Write the present moment of an episode; called after `reset` and after each step."""
        time_s = env.truth.time_s
        if not self._last_s < self._offset_s + time_s:
            self._offset_s = self._last_s + _BETWEEN_EPISODES_S
        if not np.isfinite(self._last_s) or self._offset_s + time_s - self._last_s > 0.5 * _BETWEEN_EPISODES_S:
            self._path, self._map_s, self._frame_s = [], -np.inf, -np.inf
        self._last_s = now = self._offset_s + time_s
        self._take_measured(env, now)
        self._take_believed(env, now)
        self._recording.pose(now, env.truth.robot_pose, "/truth/pose", WORLD)
        self._recording.people(now, env.truth.people.positions, topic="/truth/people", frame=WORLD,
                               leader=env.truth.leader_index)  # fmt: skip

    def finish(self, episode: Episode) -> None:
        """Write what is known of an episode once it is over: actions and rewards, at the times of its steps."""
        history = episode.history
        robot, top_turn_rate = episode.config.robot, episode.config.task.top_turn_rate
        for time_s, action, reward in zip(history.time_s, history.action, history.reward, strict=True):
            now = self._offset_s + float(time_s)
            sideways = action[1] * robot.max_speed if len(action) == 3 else 0.0
            self._recording.command(now, (action[0] * robot.max_speed, sideways, action[-1] * top_turn_rate))
            self._recording.number(now, float(reward), "/reward")

    def _take_measured(self, env: FollowEnv, now: float) -> None:
        belief = env.belief
        self._recording.scan(belief.scan, time_s=now)
        self._recording.scan(belief.filtered, "/scan_filtered", time_s=now)
        self._recording.odometry(now, belief.odometry, belief.velocity)
        for frame in env.world.frames:
            if frame.time_s > self._frame_s:
                self._frame_s = frame.time_s
                self._recording.picture(now, frame.colour, "/camera/image")
                self._recording.picture(now, frame.depth, "/camera/depth")

    def _take_believed(self, env: FollowEnv, now: float) -> None:
        belief = env.belief
        people = belief.people
        self._recording.people(now, people.positions, people.ids.tolist(), belief.leader_id)
        if not np.isfinite(belief.map_pose).all():
            return
        self._path.append(belief.map_pose)
        self._recording.transform(now, compose(belief.map_pose, inverse(belief.odometry)), MAP, ODOM)
        if now >= self._map_s + _MAP_EVERY_S:
            self._map_s = now
            self._recording.map(now, belief.map)
            self._recording.way(now, np.array(self._path))
