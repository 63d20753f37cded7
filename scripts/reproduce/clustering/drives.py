"""The drives: two laps among posts, one robot with two odometries, without error and with the usual one."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....envs.recording.operator import Operator
from ....envs.scenes.polyline import arc_lengths
from ....envs.sensors.lidar import LidarConfig
from ....envs.world.world import World, WorldConfig
from ....slam.geometry import between
from ....slam.scan import LaserScan

Array = NDArray[np.float64]

LASER = LidarConfig(beams=181, field_of_view=float(np.pi), range_max=8.0)
"""The paper's laser: 180 degrees, 8 m; a beam a degree, 1 cm of noise."""
ROBOTS = {"perfect": "robot 1, without odometry error", "typical": "robot 2, with odometry error"}
KEY_WAY, KEY_TURN = 0.4, 0.2
"""Scans are used after this way [m] or turn [rad], the same ones by all methods."""


@dataclass(frozen=True, eq=False)
class LandmarkDrive:
    """One drive.

    Attributes:
        truth: (n, 3) T_world_robot, every 0.1 s.
        odometry: By robot ("perfect", "typical"): (n, 3) T_odom_robot.
        scans: n scans.
        posts: (k, 2) centres of the posts, world frame [m].
        lap: Length of a lap [m]; two are driven.
        keys: Numbers of the scans that are used.
        arcs: (n,) way driven [m].
    """

    truth: Array
    odometry: dict[str, Array]
    scans: tuple[LaserScan, ...]
    posts: Array
    lap: float
    keys: NDArray[np.int64]
    arcs: Array

    @property
    def path(self) -> Array:
        """(n, 3) the truth in the frame of the first pose, in which filters estimate."""
        return between(self.truth[0], self.truth)


def simulate(seed: int) -> LandmarkDrive:
    """Return the drive of world `seed`: posts, path, odometry error and noise are drawn from it."""
    world = World(WorldConfig(scene="landmarks", leader=False, people=0, lidar=LASER), np.random.default_rng(seed))
    operator = Operator(world.scene)
    truth, odometry, scans = [world.truth.robot_pose], [world.odometry], [world.scan()]
    while not operator.done(world.truth):
        world.step(operator.command(world.truth))
        truth.append(world.truth.robot_pose)
        odometry.append(world.odometry)
        scans.append(world.scan())
    poses = np.array(truth)
    return LandmarkDrive(
        truth=poses,
        odometry={"perfect": between(poses[0], poses), "typical": np.array(odometry)},
        scans=tuple(scans),
        posts=np.array([(solid.x, solid.y) for solid in world.scene.solids]),
        lap=world.scene.lap,
        keys=_keys(poses),
        arcs=arc_lengths(poses[:, :2]),
    )


def shortened(scan: LaserScan, reach: float) -> LaserScan:
    """Return the scan as a laser of range `reach` [m] would give it; with 0, one that sees nothing at all."""
    ranges = np.where(scan.ranges > reach, np.inf, scan.ranges)
    return LaserScan(
        ranges, scan.bearings, scan.range_min, max(reach, scan.range_min + 0.1), scan.time_s, scan.T_robot_lidar
    )


def blinded(drive: LandmarkDrive, start: float, way: float) -> tuple[LaserScan, ...]:
    """Return the drive's scans, the laser covered on `way` metres from `start` on [m]."""
    covered = (drive.arcs >= start) & (drive.arcs < start + way)
    return tuple(_empty(scan) if hidden else scan for scan, hidden in zip(drive.scans, covered, strict=True))


def _empty(scan: LaserScan) -> LaserScan:
    nothing = np.full(len(scan), np.inf)
    return LaserScan(nothing, scan.bearings, scan.range_min, scan.range_max, scan.time_s, scan.T_robot_lidar)


def _keys(poses: Array) -> NDArray[np.int64]:
    keys = [0]
    for i in range(1, len(poses)):
        moved = between(poses[keys[-1]], poses[i])
        if np.hypot(moved[0], moved[1]) >= KEY_WAY or abs(moved[2]) >= KEY_TURN:
            keys.append(i)
    return np.array(keys)
