"""Labelled scans of the environment's own buildings, with people in them who walk and stand, from drives among them."""

from dataclasses import replace

import numpy as np
from numpy.random import Generator

from ...envs.sensors.lidar import LidarConfig
from ...envs.world.world import World, WorldConfig
from ...slam.geometry import between, wrap_angle
from ...slam.scan import LaserScan
from .leg_scans import LabelledScan

SCENES = ("corridor", "meeting_room", "plain_corridor")
BEAMS = (360, 541, 721, 1081)
PAUSE_S = 0.7  # between two scans that are kept, so that they differ [s]
DRIVE_S = 30.0  # length of a drive [s]


def draw_drive(rng: Generator) -> list[LabelledScan]:
    """Draw a building, its people and a laser, drive behind the leader, and return scans taken on the way.

    The buildings come from `rng`, so that they are others than those of any episode with a small seed.
    """
    lidar = LidarConfig(beams=int(rng.choice(BEAMS)), rate_hz=10.0)
    config = WorldConfig(
        scene=str(rng.choice(SCENES)),
        people=int(rng.integers(1, 7)),
        standing=int(rng.integers(0, 3)),
        lidar=lidar,
    )
    world = World(config, rng)
    distance, scans = rng.uniform(0.8, 4.0), []
    while world.time_s < DRIVE_S:
        for _ in range(round(PAUSE_S * config.control_hz)):
            world.step(_command(world, distance) + rng.normal(0.0, (0.05, 0.3)))
        scans.append(LabelledScan(_unmounted(world.scan()), world.scan_labels() >= 0))
    return scans


def _command(world: World, distance: float) -> np.ndarray:
    """Return speeds [m/s, rad/s] that keep about `distance` [m] behind the true leader."""
    truth = world.truth
    ahead = between(truth.robot_pose, np.array([*truth.people.positions[truth.leader_index], 0.0]))
    bearing = float(wrap_angle(np.arctan2(ahead[1], ahead[0])))
    speed = 1.5 * (float(np.hypot(ahead[0], ahead[1])) - distance) * max(0.0, np.cos(bearing))
    return np.array([np.clip(speed, 0.0, 1.3), np.clip(2.5 * bearing, -1.5, 1.5)])


def _unmounted(scan: LaserScan) -> LaserScan:
    return replace(scan, T_robot_lidar=(0.0, 0.0, 0.0))
