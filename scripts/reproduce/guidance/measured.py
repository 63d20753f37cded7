"""The results of all drives, as arrays for comparison."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .drives import GUIDES
from .rule import METHODS, Comparisons, compare

Array = NDArray[np.float64]

FIGURES: dict[str, tuple[str, str, int]] = {
    "duration_s": ("duration", "s", 1),
    "active_s": ("operator active", "s", 1),
    "commands": ("operator's commands", "", 0),
    "time_to_90_s": ("time to 90 %", "s", 1),
    "time_to_95_s": ("time to 95 %", "s", 1),
    "time_to_99_s": ("time to 99 %", "s", 1),
    "coverage": ("floor seen", "%", 1),
    "jerk_rms_mps3": ("jerk RMS", "m/s3", 2),
    "sparc": ("SPARC", "", 2),
    "ldlj": ("LDLJ", "", 2),
    "contacts_people": ("contacts with people", "", 2),
    "contacts_static": ("contacts with things", "", 2),
    "near_misses": ("near misses", "", 2),
    "min_distance_bystander_m": ("nearest bystander", "m", 2),
    "personal_space_compliance": ("personal space kept", "%", 1),
    "min_ttc_s": ("least time to collision", "s", 2),
    "band_1_2_m_share": ("leader in 1 .. 2 m", "%", 1),
    "losses": ("leader lost", "", 2),
    "reacquired": ("found again", "", 2),
    "path_length_m": ("path", "m", 1),
    "map/truth_to_map_m": ("ADNN, truth to map", "cm", 2),
    "map/map_to_truth_m": ("ADNN, map to truth", "cm", 2),
    "map/coverage": ("floor free in the map", "%", 1),
    "map/residue": ("cells left by people", "", 1),
    "map/ate_m": ("pose error (ATE)", "cm", 2),
}
"""Name -> title, unit and digits."""
SCALES = {"%": 100.0, "cm": 100.0}
_HIGHER_IS_BETTER = ("sparc", "ldlj", "personal_space_compliance", "min_distance_bystander_m")


@dataclass(frozen=True, eq=False)
class Measured:
    """All drives.

    Attributes:
        results: What the cells returned, by name.
        scenes: Buildings.
        seeds: Seeds of each.
        limit_s: Most simulated time of a drive [s].
        guides: Who drove.
    """

    results: Mapping[str, Any]
    scenes: Sequence[str]
    seeds: Sequence[int]
    limit_s: float
    guides: Sequence[str] = GUIDES

    def row(self, guide: str, scene: str, seed: int) -> Mapping[str, Any]:
        """Return the result of one drive."""
        return self.results[cell_name(guide, scene, seed)]

    def values(self, guide: str, figure: str, scene: str | None = None) -> Array:
        """Return (n,) of one guide, one for each drive, scene by scene; NaN where there is none."""
        scenes = self.scenes if scene is None else (scene,)
        return np.array([_value(self.row(guide, name, seed), figure) for name in scenes for seed in self.seeds])

    def burden(self, guide: str, criterion: str, scene: str | None = None) -> Array:
        """Return (n,) the figure that decides a criterion, lower is better; see `DECIDES`."""
        get = {name: self.values(guide, name, scene) for name in DECIDES[criterion]}
        if criterion == "convenience":
            return get["commands"] * 1e4 + get["active_s"]
        if criterion == "time saving":
            return np.where(np.isnan(get["time_to_90_s"]), self.limit_s, get["time_to_90_s"])
        return np.sum(list(get.values()), axis=0)

    def comparisons(self, criterion: str, scene: str | None = None) -> Comparisons:
        """Return the paired comparisons of the paper's three methods by a criterion."""
        return compare({guide: self.burden(guide, criterion, scene) for guide in METHODS})

    def comparisons_by(self, figure: str) -> Comparisons:
        """Return the same by another figure."""
        sign = -1.0 if figure in _HIGHER_IS_BETTER else 1.0
        values = {guide: self.values(guide, figure) for guide in METHODS}
        if figure.startswith("time_to"):
            values = {guide: np.where(np.isnan(v), self.limit_s, v) for guide, v in values.items()}
        return compare({guide: sign * v for guide, v in values.items()})


DECIDES = {
    "convenience": ("commands", "active_s"),
    "time saving": ("time_to_90_s",),
    "motion smoothness": ("jerk_rms_mps3",),
    "safety": ("contacts_people", "contacts_static", "near_misses"),
}
"""Criterion -> the figures that decide it."""
OTHERS = {
    "convenience": ("active_s",),
    "time saving": ("time_to_95_s", "duration_s"),
    "motion smoothness": ("sparc", "ldlj"),
    "safety": ("personal_space_compliance", "min_distance_bystander_m"),
}
"""Criterion -> figures by which it could have been decided as well."""


def cell_name(guide: str, scene: str, seed: int) -> str:
    """Return the name of the cell of one drive."""
    return f"{scene}/{guide}/s{seed}"


def _value(row: Mapping[str, Any], figure: str) -> float:
    if figure in ("commands", "active_s"):
        return float(row["operator"][figure])
    part: Any = row
    for key in figure.split("/"):
        part = None if part is None else part[key]
    return np.nan if part is None else float(part)
