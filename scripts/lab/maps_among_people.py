"""A trajectory through a building full of people judged: where the robot was, and what map its scans draw."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...perception.hindsight import filtered_scans
from ...perception.people_filter import PeopleFilterConfig, near_points, points_lidar
from ...slam.errors import InputError
from ...slam.geometry import between, compose
from ...slam.grid import GridConfig, render_map
from ...slam.logs.drive_folder import SimulatedDrive
from ...slam.occupancy_map import OccupancyMap
from ...slam.quality.adnn import adnn
from ...slam.quality.cells import common_cells, dynamic_residue
from ...slam.quality.relations import relation_error
from ...slam.quality.trajectory import absolute_error
from ...slam.scan import LaserScan

Array = NDArray[np.float64]

FILTERS = ("raw", "ours", "true")
"""What is mapped: the scans as measured, without whom our filter sees, without whom the simulator knows."""
RELATION_S = 10.0
"""Relations are between each pose and the one so much later [s]."""
GRID = GridConfig(resolution=0.05, max_range=20.0)
"""All maps are drawn alike, whoever made the trajectory."""


@dataclass(frozen=True, eq=False)
class DriveAmongPeople:
    """A drive with people in it, and what its scans look like without them.

    Attributes:
        drive: With truth.
        config: Of our people filter.
    """

    drive: SimulatedDrive
    config: PeopleFilterConfig

    @cached_property
    def scans(self) -> Mapping[str, list[LaserScan]]:
        """The scans by name of the filter, as of `FILTERS`."""
        recording = self.drive.recording
        ours = [filtered.without_people for filtered in filtered_scans(recording, self.config)]
        return {"raw": recording.scans, "ours": ours, "true": self._without_true_people()}

    def _without_true_people(self) -> list[LaserScan]:
        """Return the scans without all returns within zeta of a true foot: the best that a filter can do."""
        out = []
        for scan, pose, feet in zip(self.drive.recording.scans, self.drive.truth, self.drive.feet, strict=True):
            there = feet[np.isfinite(feet).all(axis=-1)]
            near = near_points(scan, points_lidar(scan, there, pose), self.config.removal.zeta)
            out.append(scan.without(near))
        return out

    @cached_property
    def true_map(self) -> OccupancyMap:
        """What the scans without people draw from the true poses, world frame."""
        return render_map(self.drive.truth, self.scans["true"], GRID)

    def mapped(self, scans: list[LaserScan], trajectory: Array) -> OccupancyMap:
        """Return what `scans` draw from `trajectory` (n, 3), laid on the true poses as well as it goes."""
        aligned = compose(absolute_error(trajectory, self.drive.truth).T_ref_est, trajectory)
        return render_map(aligned, scans, GRID)

    def judge(self, trajectory: Array, scans: list[LaserScan]) -> dict[str, float]:
        """Return figures of a trajectory (n, 3) T_map_robot, one pose a scan, and of the map that `scans` draw from it.

        `ate_cm`, `ate_max_cm`: absolute trajectory error, root mean square and largest. `relation_cm`,
        `relation_deg`: mean errors of relations 10 s apart. `ghost_cells`: cells that are free in truth, were crossed
        by people, and are occupied on the map. `missing_cm`: mean distance from a true wall to the nearest on the map;
        `false_cm`: the other way round.

        Raises:
            InputError: If there is not one pose a scan.
        """
        drive = self.drive
        if trajectory.shape != drive.truth.shape:
            raise InputError(f"one pose a scan needed, got {len(trajectory)} for {len(drive.truth)} scans")
        ate = absolute_error(trajectory, drive.truth).translation
        first, second = _pairs(drive.recording.times_s)
        relation = relation_error(
            between(drive.truth[first], drive.truth[second]), trajectory[first], trajectory[second]
        )
        own, true = self.mapped(scans, trajectory), self.true_map
        residue = dynamic_residue(common_cells(own, true), drive.feet)
        return {
            "ate_cm": 100.0 * ate.rmse,
            "ate_max_cm": 100.0 * ate.max,
            "relation_cm": 100.0 * relation.translation.mean,
            "relation_deg": relation.rotation.mean,
            "ghost_cells": residue.cells,
            "missing_cm": 100.0 * adnn(own.occupied_points, true.occupied_points).mean_m,
            "false_cm": 100.0 * adnn(true.occupied_points, own.occupied_points).mean_m,
        }


def without_reference(drive: SimulatedDrive) -> SimulatedDrive:
    """Return `drive` with nothing of the truth where a SLAM engine looks."""
    return replace(drive, recording=replace(drive.recording, reference=None))


def _pairs(times_s: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return indices (k,) of poses, and of those `RELATION_S` later; the last of all, where a drive is shorter."""
    later = np.minimum(np.searchsorted(times_s, times_s + RELATION_S), len(times_s) - 1)
    here = np.flatnonzero(times_s + RELATION_S <= times_s[-1])
    here = here if len(here) else np.zeros(1, dtype=np.intp)
    return here, later[here]
