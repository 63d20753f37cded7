"""The cells behind the results table of the README: one drive, one map, one log each."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from ...agents import make_follower
from ...agents.tour import SCENES, TourConfig, following_tour
from ...envs.recording.rollout import rollout
from ...envs.recording.slow_tour import slow_tour
from ...envs.world.world import WorldConfig
from ...slam.engine import make_slam
from ...slam.logs.carmen import read_carmen
from ...slam.logs.relations import read_readings, read_relations
from ...slam.logs.tum import Trajectory
from ...slam.quality.relations import score_relations
from ...slam.quality.trajectory import absolute_error
from ...slam.runner import run_slam
from ..lab.cells import Cell
from ..lab.map_comparison import MapComparisonConfig, judge_map, map_reference
from ..runs.slam_run import usable_times
from .people import DriveConfig, judged_drive

LOGS = {
    "intel": "intel_every5th.log.gz",
    "belgioioso": "belgioioso_with_odometry.log.gz",
    "aces": "aces_with_odometry.log.gz",
}
"""Recorded drives by name, in the folder slam_logs of the data."""


@dataclass(frozen=True, kw_only=True)
class AcceptanceExtent:
    """How much is measured.

    Attributes:
        tours: Seeds of each scene for following.
        maps: Seeds of each scene for maps.
        crowds: Seeds for tracking.
        log_seeds: Seeds for each recorded log.
    """

    tours: int = 30
    maps: int = 5
    crowds: int = 10
    log_seeds: int = 5


FULL = AcceptanceExtent()
QUICK = AcceptanceExtent(tours=3, maps=1, crowds=1, log_seeds=1)


def acceptance_cells(extent: AcceptanceExtent, data: Path | None) -> list[Cell]:
    """Return every cell; those of recorded logs only where `data` is given."""
    cells = []
    for scene in SCENES:
        for seed in range(extent.tours):
            arguments = {"scene": scene, "people": 2, "seed": seed}
            cells.append(Cell(name=f"following/{scene}/{seed}", function=follow_once, arguments=arguments))
        for standing in (0, 1):
            for seed in range(extent.maps):
                arguments = {"scene": scene, "people": 2, "standing": standing, "seed": seed}
                cells.append(Cell(name=f"maps/{scene}/{standing}/{seed}", function=map_once, arguments=arguments))
        for seed in range(extent.crowds):
            arguments = {"scene": scene, "people": 4, "seed": seed}
            cells.append(Cell(name=f"tracking/{scene}/{seed}", function=track_once, arguments=arguments))
    for log in LOGS if data is not None else ():
        for seed in range(extent.log_seeds):
            arguments = {"data": str(data), "log": log, "seed": seed}
            cells.append(Cell(name=f"logs/{log}/{seed}", function=map_log_once, arguments=arguments))
        arguments = {"data": str(data), "log": log, "seed": 0, "method": "cartographer"}  # nothing random in it
        cells.append(Cell(name=f"graph/{log}/0", function=map_log_once, arguments=arguments))
    return cells


def follow_once(scene: str, people: int, seed: int) -> dict[str, Any]:
    """Follow a leader on perceived people and typical odometry; return the episode's metrics."""
    env = gym.make(SCENES[scene], slam=None, people_count=people)
    episode = rollout(env, make_follower("pid", env.get_wrapper_attr("interface")), seed=seed)
    env.close()
    return {"ending": episode.ending, **episode.metrics}


def map_once(scene: str, people: int, standing: int, seed: int, method: str = "gmapping") -> dict[str, Any]:
    """Follow, then map raw and filtered scans against the slow drive of the empty building."""
    tour = following_tour(TourConfig(scene=scene, people=people, standing=standing, seed=seed))
    reference_drive, mapping = slow_tour(WorldConfig(scene=scene), seed), MapComparisonConfig(method=method, seed=seed)
    reference = map_reference(reference_drive, mapping)
    judged = {
        name: judge_map(tour.drive, scans, reference_drive, reference, mapping).to_dict()
        for name, scans in (("raw", tour.drive.recording.scans), ("filtered", tour.filtered))
    }
    return {"ending": tour.episode.ending, **judged}


def track_once(scene: str, people: int, seed: int) -> dict[str, Any]:
    """Track everybody in one drive; return counts and shares."""
    return judged_drive(DriveConfig(scene=scene, people=people), seed)


def map_log_once(data: str, log: str, seed: int, method: str = "gmapping") -> dict[str, Any]:
    """Map a recorded log with the defaults; return its error [m] and the time of a processed scan [s]."""
    folder = Path(data) / "slam_logs"
    drive = read_carmen(folder / LOGS[log])
    start = time.perf_counter()
    done = run_slam(make_slam(method, seed=seed), drive)
    scans = int(done.integrated.sum())
    row = {"scans": len(drive), "processed": scans, "wall_s": time.perf_counter() - start}
    if drive.reference is not None:
        return {**row, "ate_rmse_m": absolute_error(done.trajectory, drive.reference).translation.rmse}
    trajectory = Trajectory(usable_times(drive), done.trajectory)
    relations = read_relations(folder / "intel_relations_by_reading.txt.gz")
    readings = read_readings(folder / "intel_readings_odometry.txt.gz")
    error = score_relations(trajectory, relations, readings)
    return {**row, "relation_m": error.translation.mean, "relation_deg": error.rotation.mean}


def mean_of(rows: Sequence[dict[str, Any]], *keys: str) -> np.ndarray:
    """Return (n,) the values under the nested `keys` of each row."""
    values = []
    for row in rows:
        value: Any = row
        for key in keys:
            value = value[key]
        values.append(np.nan if value is None else value)
    return np.array(values, dtype=np.float64)
