"""Cells that map a drive and judge the map."""

from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from ....envs.world.world import World, WorldConfig
from ....slam.engine import SlamEngine, make_slam
from ....slam.geometry import inverse, transform_points
from ....slam.graph.loops.global_config import GlobalSlamConfig
from ....slam.local.local_slam import LocalSlamConfig
from ....slam.occupancy_map import OccupancyMap
from ....slam.quality.adnn import adnn
from ....slam.quality.registration import register
from ....slam.quality.score import score_map
from ....slam.quality.trajectory import absolute_error
from ....slam.runner import run_slam
from ....slam.scan import LaserScan
from ....slam.scan_to_grid.voxel_filter import AdaptiveVoxelConfig
from ...lab.cells import TIMING
from ...lab.drive_files import MappingInput, load_input, load_truth
from .drives import RESOLUTION
from .map_files import load_map, save_map

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

ENGINES = ("gmapping", "cartographer")
VARIANTS = {
    "gmapping": "GMapping",
    "cartographer": "Cartographer's kind",
    "gmapping-often": "GMapping, update every 0.2 m",
    "cartographer-no-voxel": "Cartographer's kind, every point matched",
}
"""What maps: names of engines, and engines with other settings."""
BESIDE_TABLE_M = 0.5
"""Wall cells within this distance of the table's top count as its edges: legs and chairs [m]."""
TWIN_M = 0.06
"""An occupied cell farther from any true surface than this belongs to a second wall or a ghost [m]."""


def make_variant(variant: str, seed: int) -> SlamEngine:
    """Return the engine called `variant`; it uses one thread, since cells run side by side."""
    if variant == "gmapping":
        return make_slam("gmapping", seed=seed, threads=1)
    if variant == "gmapping-often":
        return make_slam("gmapping", seed=seed, threads=1, linear_update=0.2, angular_update=0.2, srr=0.3, srt=0.2)
    graph = GlobalSlamConfig(threads=1)
    if variant == "cartographer":
        return make_slam("cartographer", seed=seed, global_=graph)
    if variant == "cartographer-no-voxel":
        every = AdaptiveVoxelConfig(min_points=100_000)
        return make_slam("cartographer", seed=seed, global_=graph, local=LocalSlamConfig(voxel_filter=every))
    return make_slam(variant, seed=seed)


def map_reference(variant: str, seed: int, inputs: list[Path], files: Path) -> dict[str, Any]:
    """Map the slow drive of the empty building (`inputs[0]`); keep the map in `files`."""
    slow = load_input(inputs[0] / "drive.npz")
    grid, trajectory, seconds = _mapped(variant, seed, slow, slow.drive.recording.scans)
    save_map(files / "map.npz", grid, trajectory)
    truth, _ = load_map(inputs[0] / "truth.npz")
    error = absolute_error(trajectory, slow.drive.truth).translation
    return {"ate_rmse_m": error.rmse, **_against_truth(grid, truth.occupied_points), TIMING: {"mapping_s": seconds}}


def map_tour(
    scene: str, variant: str, scans: str, usable_range: float, seed: int, inputs: list[Path], files: Path | None = None
) -> dict[str, Any]:
    """Map a tour from its "raw" or "filtered" `scans` and judge the map.

    Args:
        scene: Name of the building.
        variant: What maps.
        scans: "raw" or "filtered".
        usable_range: Nothing is seen beyond this [m].
        seed: Of the engine and the building.
        inputs: Files of the tour, of the slow drive, and of the reference map.
        files: Where the map is kept; None: nowhere.
    """
    tour, slow_truth = load_input(inputs[0] / "drive.npz"), load_truth(inputs[1] / "drive.npz")
    truth, _ = load_map(inputs[1] / "truth.npz")
    reference, reference_trajectory = load_map(inputs[2] / "map.npz")
    grid, trajectory, seconds = _mapped(variant, seed, tour, tour.scans(scans, usable_range))
    if files is not None:
        save_map(files / "map.npz", grid, trajectory)
    feet = tour.drive.feet[np.isfinite(tour.drive.feet).all(axis=-1)]
    T_world_reference = absolute_error(reference_trajectory, slow_truth).T_ref_est
    score = score_map(grid, reference, transform_points(inverse(T_world_reference), feet))
    error = absolute_error(trajectory, tour.drive.truth).translation
    true_points = truth.occupied_points
    edges = _near_table(scene, seed, transform_points(slow_truth[0], true_points))
    return {
        "ate_rmse_m": error.rmse,
        "ate_max_m": error.max,
        **score.to_dict(),
        **_against_truth(grid, true_points, edges),
        TIMING: {"mapping_s": seconds},
    }


def _mapped(variant: str, seed: int, tour: MappingInput, scans: list[LaserScan]) -> tuple[OccupancyMap, Array, float]:
    start = perf_counter()
    run = run_slam(make_variant(variant, seed), replace(tour.drive.recording, scans=scans))
    return run.map(RESOLUTION), run.trajectory, perf_counter() - start


def _against_truth(grid: OccupancyMap, truth: Array, edges: Mask | None = None) -> dict[str, float]:
    """Compare with the true surfaces, after registration.

    Args:
        grid: A map.
        truth: (n, 2) centres of the truly occupied cells [m].
        edges: (n,) which of them lie around a table; None: there is none.

    Returns:
        Both directions of ADNN, the share of the map's cells that are no true surface (second walls, ghosts), and the
        share of the table's surroundings that the map shows.
    """
    occupied = grid.occupied_points
    points = transform_points(register(occupied, truth).T_ref_est, occupied)
    off, _ = KDTree(truth).query(points)
    figures = {
        "truth_to_map_m": adnn(points, truth).mean_m,
        "map_to_truth_m": adnn(truth, points).mean_m,
        "twin_cells": float(np.mean(np.asarray(off) > TWIN_M)),
    }
    if edges is not None:
        missed, _ = KDTree(points).query(truth[edges])
        figures["table_edges_found"] = float(np.mean(np.asarray(missed) <= 2.0 * grid.resolution))
    return figures


def _near_table(scene_name: str, seed: int, points_world: Array) -> Mask | None:
    """Return which of `points_world` (n, 2) lie around the table of the building; None where it has none."""
    scene = World(WorldConfig(scene=scene_name, people=0, leader=False), np.random.default_rng(seed)).scene
    tables = [solid for solid in scene.solids if solid.kind == "table"]
    if not tables:
        return None
    return np.min([solid.distance(points_world) for solid in tables], axis=0) <= BESIDE_TABLE_M
