"""The experiment of Ye et al. 2021: one drive mapped from raw and from filtered scans, against a reference map."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.engine import make_slam
from ...slam.geometry import inverse, transform_points
from ...slam.logs.drive_folder import SimulatedDrive
from ...slam.occupancy_map import OccupancyMap
from ...slam.quality.score import MapScore, score_map
from ...slam.quality.trajectory import AbsoluteError, absolute_error
from ...slam.runner import run_slam
from ...slam.scan import LaserScan


@dataclass(frozen=True, kw_only=True)
class MapComparisonConfig:
    """Which engine draws the maps.

    Attributes:
        method: Name of the SLAM engine.
        resolution: Side of a map's cell [m]; the paper's.
        seed: Seed of the engine.
    """

    method: str = "gmapping"
    resolution: float = 0.02
    seed: int = 0


@dataclass(frozen=True, eq=False)
class MappedDrive:
    """What an engine made of a drive.

    Attributes:
        map: The map.
        trajectory: (n, 3) T_map_robot of every scan, final.
    """

    map: OccupancyMap
    trajectory: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JudgedMap:
    """A map with what it is worth.

    Attributes:
        drive: The map and the trajectory.
        score: Against the reference map.
        ate: Of the trajectory against the true poses.
    """

    drive: MappedDrive
    score: MapScore
    ate: AbsoluteError

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers by name."""
        return {
            **self.score.to_dict(),
            "ate_rmse_m": self.ate.translation.rmse,
            "ate_max_m": self.ate.translation.max,
            "occupied_cells": len(self.drive.map.occupied_points),
        }


def map_reference(drive: SimulatedDrive, config: MapComparisonConfig) -> MappedDrive:
    """Return the map of the slow drive without people."""
    return _mapped(drive, drive.recording.scans, config)


def judge_map(
    drive: SimulatedDrive,
    scans: list[LaserScan],
    reference_drive: SimulatedDrive,
    reference: MappedDrive,
    config: MapComparisonConfig,
) -> JudgedMap:
    """Map `drive` from `scans` (raw or filtered, one for each recorded one) and judge the map and the trajectory."""
    mapped = _mapped(drive, scans, config)
    feet = drive.feet[np.isfinite(drive.feet).all(axis=-1)]
    return JudgedMap(
        mapped,
        score_map(mapped.map, reference.map, _in_map_of(reference_drive, reference, feet)),
        absolute_error(mapped.trajectory, drive.truth),
    )


def _mapped(drive: SimulatedDrive, scans: list[LaserScan], config: MapComparisonConfig) -> MappedDrive:
    run = run_slam(make_slam(config.method, seed=config.seed), replace(drive.recording, scans=scans))
    return MappedDrive(run.map(config.resolution), run.trajectory)


def _in_map_of(drive: SimulatedDrive, mapped: MappedDrive, points_world: NDArray[np.float64]) -> NDArray[np.float64]:
    """Carry true places (n, 2) into the frame of a map, through the best fit of its trajectory to the true poses."""
    T_world_map = absolute_error(mapped.trajectory, drive.truth).T_ref_est
    return transform_points(inverse(T_world_map), points_world)
