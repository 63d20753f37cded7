"""What the robot understands of its camera's frames, once it has been worked out."""

from collections import deque
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...perception.immobile.view import CameraView, CameraViewMaker
from ...perception.rgbd.frame import RgbdFrame
from ...perception.tracking.camera import SeenPeople
from ...slam.immobile.grid import PoseHistory

Array = NDArray[np.float64]

SIGHT_DELAY_S = 0.3
"""What a frame shows is known this long after its exposure [s]."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """What one frame showed.

    Attributes:
        view: Points, planes and people, for a map.
        people: The people where they were at the exposure, odometry frame, for a tracker.
    """

    view: CameraView
    people: SeenPeople


class CameraPipeline(Protocol):
    """Understands frames."""

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Take the camera's frames, oldest first."""
        ...

    def update(self, time_s: float, odometry: Array) -> tuple[Sighting, ...]:
        """Take where the robot is at `time_s` by odometry (3,); return what has become known since, oldest first."""
        ...


class NoCamera:
    """There is no camera, or nobody who asks what it sees."""

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Ignore the frames."""

    def update(self, time_s: float, odometry: Array) -> tuple[Sighting, ...]:
        """Return nothing."""
        return ()


class RgbdPipeline:
    """Makes a view of each frame; it is ready `SIGHT_DELAY_S` after the exposure and placed where the robot was then.

    Args:
        views: Makes views of frames.
    """

    def __init__(self, views: CameraViewMaker) -> None:
        self._views = views
        self._odometry = PoseHistory()
        self._waiting: deque[CameraView] = deque()
        self._seen_s = -np.inf

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Understand the latest frame, if it is new."""
        for frame in frames[-1:]:
            if frame.time_s > self._seen_s:
                self._seen_s = frame.time_s
                self._waiting.append(self._views.make(frame))

    def update(self, time_s: float, odometry: Array) -> tuple[Sighting, ...]:
        """Take where the robot is at `time_s` by odometry (3,); return what has become known since, oldest first."""
        self._odometry.add(time_s, odometry)
        ready = []
        while self._waiting and self._waiting[0].time_s + SIGHT_DELAY_S <= time_s + 1e-9:
            view = self._waiting.popleft()
            there = self._odometry.at(view.time_s)
            ready.append(Sighting(view, SeenPeople.at_exposure(view.people, view.time_s, there)))
        return tuple(ready)
