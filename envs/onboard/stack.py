"""What the robot believes: from its scans and its odometry alone, unless a switch lets truth in (truth.py)."""

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.estimate import LeaderEstimate
from ...perception.legs.detector import no_detections
from ...perception.people_filter import FilteredScan
from ...perception.rgbd.frame import RgbdFrame
from ...perception.tracking.camera import SeenPeople
from ...perception.tracking.people import People, nobody_tracked
from ...slam.geometry import between, inverse, transform_points
from ...slam.occupancy_map import OccupancyMap
from ...slam.processes.stages import Stages, completed
from ...slam.scan import LaserScan
from .camera_pipeline import CameraPipeline
from .immobile_map import Drawing
from .mappers import Mapper

Array = NDArray[np.float64]


class PeopleSource(Protocol):
    """Where the robot's knowledge of people comes from: `PeopleFilter`, or the truth."""

    def update(self, scan: LaserScan, odometry: Array, seen: SeenPeople | None) -> FilteredScan:
        """Take one scan with its odometry pose (3,), and whom a camera saw, if it did.

        Returns:
            The scan with the people in it, and without them.
        """
        ...


class Selector(Protocol):
    """Chooses and keeps the leader."""

    def update(self, people: People, robot_pose: Array) -> LeaderEstimate | None:
        """Return the leader among `people` (odometry frame), seen from the robot's pose (3,); None for none."""
        ...


class NobodyLeads:
    """There is no leader to choose."""

    def update(self, people: People, robot_pose: Array) -> None:
        """Choose nobody."""


@dataclass(frozen=True, eq=False)
class Belief:
    """What the robot believes after a step.

    Attributes:
        filtered_scan: The latest scan, with and without people.
        odometry: (3,) T_odom_robot.
        velocity: (3,) of the robot by odometry: forward, left, turn [m/s, m/s, rad/s].
        people: People in the odometry frame.
        people_robot: The same people in the robot frame.
        leader: The leader in the robot frame; None until one was chosen.
        map: The map so far.
        map_pose: (3,) T_map_robot; NaN without a map.
    """

    filtered_scan: FilteredScan
    odometry: Array
    velocity: Array
    people: People
    people_robot: People
    leader: LeaderEstimate | None
    map: OccupancyMap
    map_pose: Array

    @property
    def scan(self) -> LaserScan:
        """The latest scan as measured."""
        return self.filtered_scan.scan

    @property
    def filtered(self) -> LaserScan:
        """The same without people."""
        return self.filtered_scan.without_people

    @property
    def leader_id(self) -> int:
        """Identity of the track that carries the leader now; -1 for none."""
        return -1 if self.leader is None else self.leader.track_id

    @property
    def sees_leader(self) -> bool:
        """Whether the leader is seen now."""
        return self.leader is not None and self.leader.visible


def unfiltered(filtered: FilteredScan) -> FilteredScan:
    """Return the scan as one in which nobody was seen, so that nothing is taken out of it."""
    nobody = nobody_tracked(filtered.scan.time_s)
    return replace(filtered, people=nobody, detections=no_detections())


class OnboardStack:
    """People, leader, people-free scans and map, from one scan to the next.

    Args:
        people: Where the knowledge of people comes from.
        selector: Chooses and keeps the leader.
        mapper: Builds the map from the scans.
        drawing: The map on the mapper's poses.
        sight: Understands what the camera sees.
        filter_people: Whether people are taken out of the scans before they are mapped.
    """

    def __init__(
        self,
        people: PeopleSource,
        selector: Selector,
        mapper: Mapper,
        drawing: Drawing,
        sight: CameraPipeline,
        filter_people: bool = True,
    ) -> None:
        self._people, self._selector, self._mapper = people, selector, mapper
        self._drawing, self._sight, self._filters = drawing, sight, filter_people
        self._last: tuple[float, Array] | None = None
        self._velocity = np.zeros(3)

    def update(self, scan: LaserScan, odometry: Array) -> Belief:
        """Take one scan and the odometry pose (3,) at its time; return what is believed now."""
        return completed(self.update_in_stages(scan, odometry))

    def update_in_stages(self, scan: LaserScan, odometry: Array) -> Stages[Belief]:
        """Do as `update`, with pauses."""
        self._measure_velocity(scan.time_s, odometry)
        sightings = self._sight.update(scan.time_s, odometry)
        seen = sightings[-1].people if sightings else None
        filtered_scan = self._people.update(scan, odometry, seen)
        yield
        leader = self._selector.update(filtered_scan.people, odometry)
        yield
        mapped = filtered_scan if self._filters else unfiltered(filtered_scan)
        self._mapper.update(odometry, mapped)
        grid = self._drawing.update(self._mapper, mapped, [sighting.view for sighting in sightings])
        return Belief(
            filtered_scan=filtered_scan,
            odometry=odometry,
            velocity=self._velocity,
            people=filtered_scan.people,
            people_robot=filtered_scan.people.in_frame_of(odometry),
            leader=None if leader is None else _in_robot_frame(leader, odometry),
            map=grid,
            map_pose=self._mapper.pose,
        )

    def look(self, frames: tuple[RgbdFrame, ...]) -> None:
        """Take the camera's frames, oldest first; what they say is believed with later scans."""
        self._sight.look(frames)

    def _measure_velocity(self, time_s: float, odometry: Array) -> None:
        if self._last is not None:
            before_s, before = self._last
            self._velocity = between(before, odometry) / (time_s - before_s)
        self._last = (time_s, odometry)


def _in_robot_frame(leader: LeaderEstimate, odometry: Array) -> LeaderEstimate:
    T_robot_odom = inverse(odometry)
    turn = np.array([0.0, 0.0, T_robot_odom[2]])
    return replace(
        leader,
        position=transform_points(T_robot_odom, leader.position[None])[0],
        velocity=transform_points(turn, leader.velocity[None])[0],
    )
