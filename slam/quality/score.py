"""The whole judgement of an estimated map against a reference map."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..geometry import transform_points
from ..occupancy_map import OccupancyMap
from .adnn import NearestDistances, adnn
from .cells import CellScore, DynamicResidue, common_cells, dynamic_residue, score_cells
from .registration import Registration, RegistrationConfig, register


@dataclass(frozen=True, eq=False)
class MapScore:
    """How good an estimated map is.

    Attributes:
        registration: How the estimate was laid on the reference before anything was measured.
        adnn: Equation 7 of Ye et al. 2021, reference to estimate: missing or displaced walls.
        ghosts: The reverse direction, estimate to reference: what only the estimate has.
        cells: Agreement of occupied and free cells.
        residue: What people left in the estimate; None if no places of people were given.
    """

    registration: Registration
    adnn: NearestDistances
    ghosts: NearestDistances
    cells: CellScore
    residue: DynamicResidue | None

    def to_dict(self) -> dict[str, Any]:
        """Return plain numbers by name, as they go into metrics.json."""
        fit = self.registration
        return {
            "adnn": asdict(self.adnn),
            "ghosts": asdict(self.ghosts),
            "cells": asdict(self.cells),
            "dynamic_residue": None if self.residue is None else asdict(self.residue),
            "registration": {
                "T_ref_est": [float(value) for value in fit.T_ref_est],
                "residual_m": fit.residual_m,
                "iterations": fit.iterations,
                "converged": fit.converged,
            },
        }


def score_map(
    estimate: OccupancyMap,
    reference: OccupancyMap,
    people: ArrayLike | None = None,
    registration: RegistrationConfig | None = None,
) -> MapScore:
    """Register `estimate` to `reference` and measure how well it agrees.

    Args:
        estimate: The map to judge.
        reference: The map that counts as the truth, made without people.
        people: (..., 2) places where people's feet were, in the frame of the *reference* [m]; None: no residue.
        registration: How the maps are registered.

    Raises:
        InputError: If a map has fewer than three occupied cells.
    """
    est_points, ref_points = estimate.occupied_points, reference.occupied_points
    fit = register(est_points, ref_points, registration)
    points = transform_points(fit.T_ref_est, est_points)
    cells = common_cells(estimate, reference, fit.T_ref_est)
    return MapScore(
        registration=fit,
        adnn=adnn(points, ref_points),
        ghosts=adnn(ref_points, points),
        cells=score_cells(cells),
        residue=None if people is None else dynamic_residue(cells, np.asarray(people)),
    )
