"""The counts of all drives, added up, and what they say about the claims."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...lab.statistics import Estimate, ratio, upper_bound
from .measures import HIDDEN
from .plan import CLEAN, cell_name

BOUNDS = {
    "people cells left": 0.03,
    "door cells not cleared in 2 s": 0.0,
    "desk top cells missing": 0.10,
    "seat cells missing": 0.20,
    "static cells lost": 0.01,
}
"""Error -> the most that is asked of it, as a share; `GAIN` is the known area that is asked for."""
GAIN = 1.3
UNKNOWN = {mark: f"unknown cells in {mark}" for mark in HIDDEN}
"""Mark -> the error of the known area in it."""


@dataclass(frozen=True)
class CountedShare:
    """A part of a whole.

    Attributes:
        part: Cells of one kind.
        whole: Of these.
    """

    part: int
    whole: int

    @property
    def value(self) -> float:
        """The part over the whole; NaN of nothing."""
        return self.part / self.whole if self.whole else float("nan")

    @property
    def bound(self) -> float:
        """The most that is believable (`upper_bound`); NaN of nothing."""
        return upper_bound(self.part, self.whole) if self.whole else float("nan")

    def __str__(self) -> str:
        return f"{100.0 * self.value:.1f} % ({self.part} of {self.whole})" if self.whole else "none"


@dataclass(frozen=True)
class Counted:
    """All drives.

    Attributes:
        results: What the cells returned, by name.
        seeds: Buildings.
    """

    results: Mapping[str, Any]
    seeds: Sequence[int]

    def errors(self, mapper: str, disturbance: str = CLEAN, seed: int | None = None) -> dict[str, CountedShare]:
        """Return the shares that should be small, of one seed or of all together."""
        return {
            "people cells left": CountedShare(
                self._sum(disturbance, seed, mapper, "people_cells"),
                self._sum(disturbance, seed, "conventional", "people_cells"),
            ),
            "door cells not cleared in 2 s": self._door(disturbance, seed, mapper),
            "desk top cells missing": self._missing(disturbance, seed, mapper, "table"),
            "seat cells missing": self._missing(disturbance, seed, mapper, "chair"),
            "static cells lost": CountedShare(
                self._sum(disturbance, seed, mapper, "static_lost"),
                sum(row["static_cells"] for row in self._rows(disturbance, seed)),
            ),
            **{UNKNOWN[mark]: self._unknown(disturbance, seed, mapper, mark) for mark in HIDDEN},
        }

    def known(self, mapper: str, mark: str, disturbance: str = CLEAN, seed: int | None = None) -> CountedShare:
        """Return the known cells of a mark, over those that the laser alone knows, which nothing disturbs."""
        return CountedShare(
            sum(row["maps"][mapper]["known"][mark] for row in self._rows(disturbance, seed)),
            sum(row["maps"]["laser"]["known"][mark] for row in self._rows(CLEAN, seed)),
        )

    def share(self, mapper: str, disturbance: str, name: str) -> Estimate:
        """Return an error's share with its interval over the drives (Fieller), since cells of one are dependent."""
        each = [self.errors(mapper, disturbance, seed)[name] for seed in self.seeds]
        return ratio([one.part for one in each], [one.whole for one in each])

    def gain(self, mapper: str, disturbance: str, mark: str) -> Estimate:
        """Return the known area of a mark over the undisturbed laser's, with its interval over the drives."""
        each = [self.known(mapper, mark, disturbance, seed) for seed in self.seeds]
        return ratio([one.part for one in each], [one.whole for one in each])

    def ratio(self, mapper: str, disturbance: str, name: str) -> Estimate:
        """Return the disturbed error over the undisturbed one; its interval is over the drives.

        Cells of one drive are not independent.
        """
        parts = []
        for each in (disturbance, CLEAN):
            whole = self.errors(mapper, each)[name].whole
            parts.append([self.errors(mapper, each, seed)[name].part / max(whole, 1) for seed in self.seeds])
        return ratio(*parts)

    def wrongly_free(self, mapper: str) -> CountedShare:
        """Return the cells of boxes, behind the screens, that count as free, of those that are known."""
        pairs = [row["maps"][mapper]["wrongly_free"][mark] for row in self._rows(CLEAN, None) for mark in HIDDEN]
        return CountedShare(sum(free for _, free in pairs), sum(known for known, _ in pairs))

    def door(self, mapper: str, seed: int) -> dict[str, Any]:
        """Return what was measured at the door of one drive."""
        return self._rows(CLEAN, seed)[0]["door"][mapper]

    def row(self, seed: int, disturbance: str = CLEAN) -> Mapping[str, Any]:
        """Return everything of one drive."""
        return self._rows(disturbance, seed)[0]

    def pose_error(self, disturbance: str = CLEAN) -> float:
        """Return the error of the poses, the root mean square over the drives [m]."""
        return float(np.sqrt(np.mean([row["pose_error_m"] ** 2 for row in self._rows(disturbance, None)])))

    def _rows(self, disturbance: str, seed: int | None) -> list[Mapping[str, Any]]:
        return [self.results[cell_name(disturbance, s)] for s in (self.seeds if seed is None else [seed])]

    def _sum(self, disturbance: str, seed: int | None, mapper: str, what: str) -> int:
        return sum(row["maps"][mapper][what] for row in self._rows(disturbance, seed))

    def _missing(self, disturbance: str, seed: int | None, mapper: str, kind: str) -> CountedShare:
        pairs = [row["maps"][mapper][kind] for row in self._rows(disturbance, seed)]
        seen = sum(pair[0] for pair in pairs)
        return CountedShare(seen - sum(pair[1] for pair in pairs), seen)

    def _unknown(self, disturbance: str, seed: int | None, mapper: str, mark: str) -> CountedShare:
        rows = self._rows(disturbance, seed)
        whole = sum(row["hidden_cells"][mark] for row in rows)
        return CountedShare(whole - sum(row["maps"][mapper]["known"][mark] for row in rows), whole)

    def _door(self, disturbance: str, seed: int | None, mapper: str) -> CountedShare:
        found = [row["door"][mapper] for row in self._rows(disturbance, seed) if mapper in row["door"]]
        cells = sum(door["cells"] for door in found)
        return CountedShare(cells - sum(door["within_2_s"] for door in found), cells)
