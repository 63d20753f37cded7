"""Writes moments of episodes for viewers: what the robot measured, believed, and what is truly so."""

import numpy as np

from ...slam.geometry import compose, inverse
from ...slam.logs.recording import AnyRecording
from ...slam.logs.viewer_recording import MAP, ODOM
from ..onboard.stack import Belief
from ..world.truth import TrueState
from ..world.world import World

WORLD = "world"
"""Frame of the truth: the simulator's. Nothing ties it to the others but `/truth/pose`, as nothing ties the robot's
mind to the truth."""
_MAP_EVERY_S = 1.0
_BETWEEN_EPISODES_S = 1.0


class Moments:
    """Takes moment after moment of one episode after the other; each begins a second after the one before has ended.

    Topics: those of `EpisodeRecording`, but for what is only known of finished episodes.

    Args:
        recording: Where to. It is closed by who opened it.
    """

    def __init__(self, recording: AnyRecording) -> None:
        self._recording = recording
        self._last_s = self._frame_s = self._map_s = -np.inf
        self.offset_s = 0.0
        """Time in the recording at which the present episode begins [s]."""
        self._path: list[np.ndarray] = []

    def take(self, world: World, truth: TrueState, belief: Belief) -> None:
        """Write the present moment of an episode."""
        time_s = truth.time_s
        if not self._last_s < self.offset_s + time_s:
            self.offset_s = self._last_s + _BETWEEN_EPISODES_S
        if not np.isfinite(self._last_s) or self.offset_s + time_s - self._last_s > 0.5 * _BETWEEN_EPISODES_S:
            self._path, self._map_s, self._frame_s = [], -np.inf, -np.inf
        self._last_s = now = self.offset_s + time_s
        self._take_measured(world, belief, now)
        self._take_believed(belief, now)
        self._recording.pose(now, truth.robot_pose, "/truth/pose", WORLD)
        people = truth.people.positions
        self._recording.people(now, people, topic="/truth/people", frame=WORLD, leader=truth.leader_index)

    def _take_measured(self, world: World, belief: Belief, now: float) -> None:
        self._recording.scan(belief.scan, time_s=now)
        self._recording.scan(belief.filtered, "/scan_filtered", time_s=now)
        self._recording.odometry(now, belief.odometry, belief.velocity)
        for frame in world.frames:
            if frame.time_s > self._frame_s:
                self._frame_s = frame.time_s
                self._recording.picture(now, frame.colour, "/camera/image")
                self._recording.picture(now, frame.depth, "/camera/depth")

    def _take_believed(self, belief: Belief, now: float) -> None:
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
