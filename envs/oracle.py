"""Where the truth gets in: the switches `people="truth"`, "modelled" and `slam="truth"`, and the facts of rewards.

No other module of the robot's onboard stack reads the true state.
"""

import numpy as np
from numpy.typing import NDArray

from ..perception.legs.detector import no_detections
from ..perception.people_filter import FilteredScan, RemovalConfig
from ..perception.rgbd.frame import RgbdFrame
from ..perception.rgbd.people import RgbdPeople
from ..perception.rgbd.planes import Planes
from ..perception.rgbd.reduction import middle_pixels
from ..perception.tracking.camera import SeenPeople
from ..perception.tracking.people import People
from ..slam.geometry import between, compose, inverse, transform_points
from ..slam.growing_map import GrowingMap
from ..slam.occupancy_map import OccupancyMap
from ..slam.scan import LaserScan
from .onboard.stack import Belief
from .task.rewards import StepFacts
from .tracker_errors import kernel
from .tracker_errors.errors import TrackerErrors
from .world.truth import TrueState
from .world.world import World, true_robot_pose

Array = NDArray[np.float64]

FARTHEST_M = 10.0
"""People beyond this are not known even by `people="truth"` [m]."""
SAME_PERSON_M = 0.75
"""A perceived leader within this distance of the true one is the right person [m]."""
MAP_STEP_M = 0.25
"""The map of known poses takes a scan each time the robot has moved this far, or turned by as many radians."""


class TruePeopleSource:
    """Everybody within 10 m, without error or delay, as a perfect tracker would report them.

    Args:
        world: The simulator.
        removal: How near to people returns are dropped.
    """

    def __init__(self, world: World, removal: RemovalConfig) -> None:
        self._world, self._removal = world, removal

    def update(self, scan: LaserScan, odometry: Array, seen: SeenPeople | None) -> FilteredScan:
        """Return the scan with the people, whose ids are their true numbers, and without them."""
        return FilteredScan(scan, odometry, self._people(scan.time_s), no_detections(), self._removal)

    def _people(self, time_s: float) -> People:
        truth = self._world.truth
        T_odom_world = compose(self._world.odometry, inverse(truth.robot_pose))
        turn = np.array([0.0, 0.0, T_odom_world[2]])
        offset = truth.people.positions - truth.robot_pose[:2]
        near = np.flatnonzero(np.hypot(offset[:, 0], offset[:, 1]) < FARTHEST_M)
        legs = truth.people.legs[near]
        return People(
            time_s=time_s,
            ids=near.astype(np.int64),
            positions=transform_points(T_odom_world, truth.people.positions[near]),
            velocities=transform_points(turn, truth.people.velocities[near]),
            confidence=np.ones(len(near)),
            legs=transform_points(T_odom_world, legs.reshape(-1, 2)).reshape(-1, 2, 2),
            variance=np.zeros(len(near)),
            unseen_s=np.zeros(len(near)),
            age_s=np.full(len(near), truth.time_s),
        )


class ModelledPeopleSource:
    """Everybody as a tracker would report them that errs as the real one does: a model of its errors, on the truth.

    People keep their numbers, where in the real stack those of tracks change now and then: that somebody else is taken
    for the leader is among the errors.

    Args:
        world: The simulator.
        removal: How near to people returns are dropped.
        errors: What the tracker gets wrong.
        rng: Of all draws.
    """

    def __init__(self, world: World, removal: RemovalConfig, errors: TrackerErrors, rng: np.random.Generator) -> None:
        self._world, self._removal, self._errors = world, removal, errors
        self._random = rng.integers(2**64, size=1, dtype=np.uint64)
        self._tracks = np.zeros((kernel.rows_for(len(world.truth.people)), kernel.COLUMNS))
        kernel.forget(self._tracks)
        self._time_s: float | None = None

    def update(self, scan: LaserScan, odometry: Array, seen: SeenPeople | None) -> FilteredScan:
        """Return the scan with the people, each with a number for ever, and without them."""
        truth, (x, y, turn), bearings = self._world.truth, scan.T_robot_lidar, scan.bearings
        dt = 0.0 if self._time_s is None else scan.time_s - self._time_s
        self._time_s = scan.time_s
        laser = float(x), float(y), float(bearings[0] + turn), float(bearings[1] - bearings[0])
        people = truth.people.positions, truth.people.velocities
        kernel.track_people(dt, truth.robot_pose, *people, scan.ranges, laser, self._errors, self._random, self._tracks)
        return FilteredScan(scan, odometry, self._people(scan.time_s, truth), no_detections(), self._removal)

    def _people(self, time_s: float, truth: TrueState) -> People:
        numbers = np.flatnonzero(self._tracks[:, kernel.PHASE] != kernel.UNKNOWN)
        rows = self._tracks[numbers]
        T_odom_world = compose(self._world.odometry, inverse(truth.robot_pose))
        places = transform_points(T_odom_world, rows[:, kernel.X : kernel.Y + 1])
        return People(
            time_s=time_s,
            ids=numbers.astype(np.int64),
            positions=places,
            velocities=transform_points(np.array([0.0, 0.0, T_odom_world[2]]), rows[:, kernel.VX : kernel.VY + 1]),
            confidence=rows[:, kernel.TRUST].copy(),
            legs=np.repeat(places[:, None], 2, axis=1),
            variance=np.zeros(len(rows)),
            unseen_s=rows[:, kernel.UNSEEN_S].copy(),
            age_s=np.full(len(rows), np.inf),  # nobody is new: who was lost comes back by the number they had
        )


class TrueRgbdPeopleFinder:
    """Everybody of whom a pixel is seen in the latest frame: an upper bound for whoever finds people in frames.

    Args:
        world: The simulator that took the frame.
    """

    def __init__(self, world: World) -> None:
        self._world = world

    def find(self, frame: RgbdFrame, planes: Planes) -> RgbdPeople:
        """Return the people in `frame`, which must be the world's latest; they stand where they are now."""
        geoms = middle_pixels(self._world.frame_geoms(), planes.step, planes.frame.depth.shape)
        label = self._world.people_of(geoms)
        seen = np.unique(label[label >= 0])
        rows = np.full(len(self._world.truth.people) + 1, -1, dtype=np.int32)
        rows[seen] = np.arange(len(seen))
        truth = self._world.truth
        positions = transform_points(inverse(truth.robot_pose), truth.people.positions[seen])
        return RgbdPeople(positions, np.ones(len(seen)), rows[label])


class TrueMapper:
    """Mapping with known poses: what any SLAM engine could draw at best. The map frame is the robot's first pose."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._start = world.start.copy()
        self._growing = GrowingMap()
        self._drawn_at: Array | None = None

    def update(self, odometry: Array, filtered_scan: FilteredScan) -> None:
        """Draw the scan where it was truly taken: an earlier one of this control period by the odometry since then."""
        now, pose = self._world.odometry, self.pose
        if not np.array_equal(odometry, now):
            pose = compose(pose, between(now, odometry))
        if self._drawn_at is not None:
            moved = between(self._drawn_at, pose)
            if np.hypot(moved[0], moved[1]) < MAP_STEP_M and abs(moved[2]) < MAP_STEP_M:
                return
        self._drawn_at = pose
        self._growing.write(filtered_scan.without_people, pose)

    @property
    def map(self) -> OccupancyMap:
        """The map so far; not to be written to."""
        return self._growing.map

    @property
    def pose(self) -> Array:
        """(3,) the true T_map_robot."""
        return between(self._start, true_robot_pose(self._world))

    def revised(self) -> None:
        """Return None: the truth is never revised."""


def leader_gap(truth: TrueState, belief: Belief) -> float:
    """Return how far the perceived leader is from the true one [m]; inf where it is not seen or someone else."""
    if belief.leader is None or not belief.leader.visible:
        return float("inf")
    believed = transform_points(truth.robot_pose, belief.leader.position[None])[0]
    gap = np.hypot(*(truth.people.positions - believed).T)
    return float(gap[truth.leader_index]) if int(gap.argmin()) == truth.leader_index else float("inf")


def step_facts(
    truth: TrueState,
    belief: Belief,
    robot_radius: float,
    action_change: float,
    step_s: float,
    coverage: tuple[float, float],
) -> StepFacts:
    """Return what truly happened in the step that led to `truth`, for the rewards.

    Args:
        truth: The present state.
        belief: What the robot believes of it.
        robot_radius: Of the robot's enclosing circle [m].
        action_change: Norm of the change of the action.
        step_s: Length of the step [s].
        coverage: Share of the floor seen before the step and after it; NaN where it is not measured.
    """
    x, y, theta = truth.robot_pose.tolist()
    offset = truth.people.positions - (x, y)
    centre = np.hypot(offset[:, 0], offset[:, 1])
    space = centre - truth.people.radii - robot_radius
    distance = bearing = float("nan")
    if truth.leader_index >= 0:
        space[truth.leader_index] = np.inf
        dx, dy = offset[truth.leader_index]
        distance = float(centre[truth.leader_index])
        bearing = float((np.arctan2(dy, dx) - theta + np.pi) % (2.0 * np.pi) - np.pi)
    return StepFacts(
        distance=distance,
        bearing=bearing,
        bystander_space=float(space.min(initial=np.inf)),
        action_change=action_change,
        following_leader=leader_gap(truth, belief) <= SAME_PERSON_M,
        collided=truth.contact_person or truth.contact_static,
        tour_done=truth.tour_done,
        step_s=step_s,
        coverage=coverage[1],
        newly_covered=coverage[1] - coverage[0],
    )
