"""What was written into an immobile-area map, kept relative to the robot, so that the map can be drawn anew.

When SLAM closes a loop, it believes that the robot was elsewhere all the while. What was recognised then stays what it
was; only where it stands changes. So the observations are kept with their lambdas, and written again at the new poses.
"""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import compose, transform_points
from ...slam.immobile.layers import ImmobileLayers
from ...slam.revisits import RevisitConfig, superseded
from ...slam.scan import LaserScan
from .view import CameraView

Array = NDArray[np.float64]

_SCANS = RevisitConfig()
_VIEWS = RevisitConfig(views=4)  # what the camera recognised saturates after two looks; a view is forty times a scan
_FEWEST, _GROWTH = 512, 1.25  # observations before the first look at what is superseded, and growth until the next


class Observation(Protocol):
    """Something that was written."""

    @property
    def time_s(self) -> float:
        """When it was taken [s]."""
        ...

    def write(self, grid: ImmobileLayers, T_map_robot: Array) -> None:
        """Write it into a grid, taken from the pose (3,)."""
        ...


@dataclass(frozen=True, eq=False)
class WrittenScan:
    """A scan.

    Attributes:
        scan: The scan.
        lambdas: (N,) lambda of each beam.
    """

    scan: LaserScan
    lambdas: Array

    @property
    def time_s(self) -> float:
        """When it was taken [s]."""
        return self.scan.time_s

    def write(self, grid: ImmobileLayers, T_map_robot: Array) -> None:
        """Write it into a grid, taken from the pose (3,)."""
        grid.write(T_map_robot, self.scan, self.lambdas)


@dataclass(frozen=True, eq=False)
class WrittenView:
    """A view of the camera, and the people in it.

    Attributes:
        view: The view.
        lambdas: (n,) lambda of each of its points.
        level: (n,) which of them are level tops.
        people: (p, 2) who was recognised, robot frame [m].
        people_lambdas: (p,) lambda of each of them.
        body_radius: Their bodies reach this far [m].
    """

    view: CameraView
    lambdas: Array
    level: NDArray[np.bool_]
    people: Array
    people_lambdas: Array
    body_radius: float

    @property
    def time_s(self) -> float:
        """When it was exposed [s]."""
        return self.view.time_s

    def write(self, grid: ImmobileLayers, T_map_robot: Array) -> None:
        """Write it into a grid, exposed from the robot's pose (3,)."""
        view = self.view
        T_map_camera = compose(T_map_robot, view.T_robot_camera)
        grid.write_view(T_map_camera, view.camera_height, view.points, self.lambdas, view.above, self.level)
        for place, lam in zip(transform_points(T_map_robot, self.people), self.people_lambdas, strict=True):
            grid.write_mobile(place, self.body_radius, float(lam))


class WrittenObservations:
    """All that was written, in its order, but for what newer observations from the same place have superseded."""

    def __init__(self) -> None:
        self._kept: list[tuple[Observation, Array]] = []
        self._due = _FEWEST

    def __len__(self) -> int:
        return len(self._kept)

    def add(self, observation: Observation, T_map_robot: Array) -> None:
        """Keep an observation that was written at the pose (3,)."""
        if isinstance(observation, WrittenScan):  # without what was computed from it
            observation = replace(observation, scan=replace(observation.scan))
        self._kept.append((observation, T_map_robot))
        if len(self._kept) >= self._due:
            self._thin()

    def draw(self, grid: ImmobileLayers, times_s: Array, poses: Array) -> None:
        """Write everything into `grid`, from where the robot is now believed to have been.

        Args:
            grid: An empty grid.
            times_s: (n,) rising times [s] ...
            poses: (n, 3) ... at which the robot was at these poses T_map_robot; between two it moved evenly.
        """
        moments = np.array([observation.time_s for observation, _ in self._kept])
        x, y = (np.interp(moments, times_s, column) for column in poses[:, :2].T)
        places = np.stack((x, y, np.interp(moments, times_s, np.unwrap(poses[:, 2]))), axis=-1)
        self._kept = [(observation, place) for (observation, _), place in zip(self._kept, places, strict=True)]
        for observation, place in self._kept:
            observation.write(grid, compose(place, np.zeros(3)))

    def _thin(self) -> None:
        poses = np.array([pose for _, pose in self._kept])
        scans = np.array([isinstance(observation, WrittenScan) for observation, _ in self._kept])
        stays = np.ones(len(self._kept), dtype=np.bool_)
        for of, config in ((scans, _SCANS), (~scans, _VIEWS)):
            stays[of] = ~superseded(poses[of], config) if of.any() else True
        self._kept = [kept for kept, stay in zip(self._kept, stays.tolist(), strict=True) if stay]
        self._due = max(_FEWEST, int(_GROWTH * len(self._kept)))
