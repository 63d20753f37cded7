"""Cells that drive: behind a leader, alone, and slowly for the reference map."""

from pathlib import Path
from typing import Any

import numpy as np

from ....agents.tour import TourConfig, following_tour
from ....envs.onboard.config import PERCEPTION
from ....envs.recording.slow_tour import SlowTourConfig, slow_tour
from ....envs.scenes.occupancy import true_map
from ....envs.world.world import World, WorldConfig
from ....perception.hindsight import filtered_scans
from ....slam.scan import LaserScan
from ...lab.drive_files import MappingInput, save_input
from .map_files import save_map

RESOLUTION = 0.02
"""Side of a map's cell, the paper's [m]."""
ALONE = SlowTourConfig(speed=0.8, turn_rate=1.0)
"""A drive without people, as fast as one behind a leader."""


def record_tour(scene: str, people: int, odometry: str, seed: int, files: Path) -> dict[str, Any]:
    """Follow a leader (people >= 1) or drive alone (0); keep the scans, raw and filtered, in `files`."""
    if people == 0:
        drive = slow_tour(WorldConfig(scene=scene, odometry=odometry), seed, ALONE)
        filtered = [scan.without_people for scan in filtered_scans(drive.recording, PERCEPTION, lag_s=0.0)]
        save_input(files / "drive.npz", MappingInput(drive, filtered))
        return {"ending": "tour_done", "scans": len(filtered), "removed": _removed(drive.recording.scans, filtered)}
    tour = following_tour(TourConfig(scene=scene, people=people, odometry=odometry, seed=seed))
    save_input(files / "drive.npz", MappingInput(tour.drive, tour.filtered))
    raw = tour.drive.recording.scans
    return {
        "ending": tour.episode.ending,
        "scans": len(raw),
        "removed": _removed(raw, tour.filtered),
        "following": dict(tour.episode.metrics),
    }


def record_reference(scene: str, seed: int, files: Path) -> dict[str, Any]:
    """Drive slowly through the empty building; keep the scans and the true map, in the frame of the robot's start."""
    drive = slow_tour(WorldConfig(scene=scene), seed)
    save_input(files / "drive.npz", MappingInput(drive, drive.recording.scans))
    building = World(WorldConfig(scene=scene, people=0, leader=False), np.random.default_rng(seed)).scene
    save_map(files / "truth.npz", true_map(building, RESOLUTION, T_world_map=drive.truth[0]))
    return {"scans": len(drive.recording.scans)}


def _removed(raw: list[LaserScan], filtered: list[LaserScan]) -> float:
    """Return the share of returns that the filter removed."""
    before = sum(int(scan.is_return.sum()) for scan in raw)
    return 1.0 - sum(int(scan.is_return.sum()) for scan in filtered) / before
