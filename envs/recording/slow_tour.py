"""The careful drive of an empty building that makes a reference map (Ye et al. 2021, III.A: "no-people").

The driver is part of the experiment, not of the robot: it steers by the true pose along the scene's route, slowly and
smoothly, as a careful operator would. The recorded odometry and scans are as noisy as in any other drive.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import wrap_angle
from ...slam.logs.drive import RecordedDrive
from ...slam.logs.drive_folder import SimulatedDrive
from ..world.world import World, WorldConfig

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class SlowTourConfig:
    """How the reference drive is driven.

    Attributes:
        speed: Forward speed [m/s].
        turn_rate: Highest turn rate [rad/s].
        lookahead: Distance along the route of the point steered for [m].
        turn_gain: Turn rate per heading error [1/s].
    """

    speed: float = 0.3
    turn_rate: float = 0.5
    lookahead: float = 0.5
    turn_gain: float = 1.5


class RouteDriver:
    """Steers along a polyline: turns towards the point ahead on it, and slows down while it turns.

    Args:
        route: (n, 2) way points, world frame [m].
        config: How to drive.
    """

    def __init__(self, route: Array, config: SlowTourConfig) -> None:
        lengths = np.hypot(*np.diff(route, axis=0).T)
        self._arcs = np.concatenate(([0.0], np.cumsum(lengths)))
        self._route, self._config = route, config

    def act(self, pose: Array, progress: float) -> Array:
        """Return the command (forward [m/s], turn [rad/s]) at `pose` (3,), `progress` metres along the route."""
        ahead = progress + self._config.lookahead
        target = np.array([np.interp(ahead, self._arcs, axis) for axis in self._route.T])
        error = float(wrap_angle(np.arctan2(*(target - pose[:2])[::-1]) - pose[2]))
        turn = np.clip(self._config.turn_gain * error, -self._config.turn_rate, self._config.turn_rate)
        return np.array([self._config.speed * max(0.0, np.cos(error)) ** 3, turn])


def slow_tour(world_config: WorldConfig, seed: int, config: SlowTourConfig | None = None) -> SimulatedDrive:
    """Drive the tour of `world_config` without anybody in the building and return what was recorded.

    Args:
        world_config: The building; its people are left out.
        seed: The seed whose building it is: equal to that of `World` with people.
        config: How to drive.

    Raises:
        RuntimeError: If the tour's end was not reached in twice the expected time.
    """
    config = config or SlowTourConfig()
    world = World(replace(world_config, people=0, leader=False, standing=0), np.random.default_rng(seed))
    driver = RouteDriver(world.scene.route, config)
    limit = int(2.0 * world.scene.tour_length / config.speed * world_config.control_hz) + 100
    odometry, scans, truth = [world.odometry], [world.scan()], [world.truth.robot_pose]
    for _ in range(limit):
        state = world.truth
        if state.tour_done:
            recording = RecordedDrive(np.array(odometry), scans, np.array(truth), f"{world_config.scene}-0p-s{seed}")
            return SimulatedDrive(recording, np.array(truth), np.empty((len(scans), 0, 2)))
        world.step(driver.act(state.robot_pose, state.robot_progress))
        odometry.append(world.odometry)
        scans.append(world.scan())
        truth.append(world.truth.robot_pose)
    raise RuntimeError(f"the slow tour of {world_config.scene}, seed {seed}, did not end within {limit} steps")
