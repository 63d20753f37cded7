"""How robots under a joystick accelerate, in recorded logs and under the operator model."""

import gzip
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...agents.teleop.operator_model import OperatorConfig, OperatorModel, OperatorView
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.world import World, WorldConfig
from ...slam.errors import InputError
from ...slam.geometry import between, compose

Array = NDArray[np.float64]

SAMPLE_S = 0.4
"""Velocities are taken over this time: the stamps of the logs are good to some 10 ms [s]."""
LOGS = ("intel_readings_odometry.txt.gz", "aces-corrected.log.gz")
"""Logs of real robots driven by joystick whose odometry has usable times."""
SLEWS, CORRECTIONS = (0.8, 1.2, 2.0, 3.0), (0.0, 0.3, 0.6, 1.0)


@dataclass(frozen=True)
class DrivingFigures:
    """How a robot was driven while it moved.

    Attributes:
        speed_95: 95 % quantile of the speed [m/s].
        turn_99: 99 % quantile of the turn rate [rad/s].
        acceleration_rms: Of the forward speed [m/s^2].
        turn_acceleration_rms: Of the turn rate [rad/s^2].
    """

    speed_95: float
    turn_99: float
    acceleration_rms: float
    turn_acceleration_rms: float

    def row(self, name: str) -> tuple[str, ...]:
        """Return words for a table."""
        return (name, *(f"{value:.2f}" for value in vars(self).values()))


def driving_figures(time_s: Array, poses: Array) -> DrivingFigures:
    """Return the figures of a drive: `time_s` (n,) ascending, `poses` (n, 3)."""
    grid = np.arange(time_s[0], time_s[-1], SAMPLE_S)
    fresh = np.concatenate(([True], np.diff(np.maximum.accumulate(time_s)) > 1e-3))
    x, y, theta = (np.interp(grid, time_s[fresh], axis[fresh]) for axis in (*poses.T[:2], np.unwrap(poses[:, 2])))
    forward = (np.diff(x) * np.cos(theta[:-1]) + np.diff(y) * np.sin(theta[:-1])) / SAMPLE_S
    turn = np.diff(theta) / SAMPLE_S
    moves = (np.abs(forward) > 0.05) | (np.abs(turn) > 0.05)
    pairs = moves[1:] | moves[:-1]
    return DrivingFigures(
        float(np.quantile(np.abs(forward[moves]), 0.95)),
        float(np.quantile(np.abs(turn[moves]), 0.99)),
        float(np.sqrt(np.mean((np.diff(forward)[pairs] / SAMPLE_S) ** 2))),
        float(np.sqrt(np.mean((np.diff(turn)[pairs] / SAMPLE_S) ** 2))),
    )


def log_figures(data: Path) -> dict[str, DrivingFigures]:
    """Return the figures of the real logs in the folder `data`.

    Raises:
        InputError: If a log is missing.
    """
    for name in LOGS:
        if not (data / "slam_logs" / name).is_file():
            raise InputError(f"the calibration needs {name} in {data / 'slam_logs'}")
    intel = np.loadtxt(data / "slam_logs" / LOGS[0])
    return {
        "Intel (real)": driving_figures(intel[:, 2], intel[:, 3:6]),
        "ACES (real)": driving_figures(*_odometry(data / "slam_logs" / LOGS[1])),
    }


def model_figures(config: OperatorConfig, seeds: int = 3) -> DrivingFigures:
    """Return the mean figures of the operator model in empty corridors."""
    rows = [list(vars(driving_figures(*_model_drive(config, seed))).values()) for seed in range(seeds)]
    return DrivingFigures(*np.mean(rows, axis=0).tolist())


def calibrate(targets: dict[str, DrivingFigures]) -> OperatorConfig:
    """Return the operator whose accelerations are nearest, as ratios, to the geometric mean of the logs'."""
    wanted = np.exp(np.mean([np.log(_accelerations(figures)) for figures in targets.values()], axis=0))
    best, error = OperatorConfig(), np.inf
    for slew in SLEWS:
        for correction in CORRECTIONS:
            config = replace(OperatorConfig(), slew=slew, over_correction=correction)
            miss = float(np.abs(np.log(_accelerations(model_figures(config)) / wanted)).sum())
            if miss < error:
                best, error = config, miss
    return best


def _accelerations(figures: DrivingFigures) -> Array:
    return np.array((figures.acceleration_rms, figures.turn_acceleration_rms))


def _model_drive(config: OperatorConfig, seed: int) -> tuple[Array, Array]:
    few = LidarConfig(beams=11)
    world = World(WorldConfig(scene="corridor", people=0, leader=False, lidar=few), np.random.default_rng(seed))
    operator = OperatorModel(world.scene.route, np.random.default_rng([seed, 1]), config)
    poses = []
    while not world.truth.tour_done and len(poses) < 3000:
        truth = world.truth
        poses.append(truth.robot_pose)
        world.step(operator.act(OperatorView(truth.robot_pose, truth.robot_progress, np.empty((0, 2)))))
    return np.arange(len(poses), dtype=np.float64) / world.config.control_hz, np.array(poses)


def _odometry(path: Path) -> tuple[Array, Array]:
    """Return times and poses of a corrected CARMEN log, composed anew from its ODOM lines.

    The ODOM line after a FLASER repeats the corrected pose: a reset, not a motion.
    """
    times, poses, last, pose, reset = [], [], None, np.zeros(3), False
    with gzip.open(path, "rt", encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            if words[0] == "FLASER":
                reset = True
            elif words[0] == "ODOM":
                here = np.array([float(word) for word in words[1:4]])
                if last is not None and not reset:
                    step = between(last, here)
                    pose = compose(pose, step) if np.hypot(step[0], step[1]) < 0.5 else pose
                    times.append(float(words[-1]))
                    poses.append(pose)
                last, reset = here, False
    return np.array(times), np.array(poses)
