"""Counting of tracked people against true ones, scan by scan (CLEAR MOT, Bernardin and Stiefelhagen 2008)."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..tracking.data_association import assign, distances

Array = NDArray[np.float64]


@dataclass(eq=False)
class ClearMot:
    """Running counts; a true person and a track match within `radius` [m].

    A match lasts as long as it is within `radius`; the rest is matched at least total distance. True people who do not
    count (hidden, of the other kind) take part in the matching, so that a track on them is no false one.
    """

    radius: float = 0.5
    truths: int = 0
    misses: int = 0
    false: int = 0
    switches: int = 0
    error_sum: float = 0.0
    partner: dict[int, int] = field(default_factory=dict)

    def add(
        self,
        truth: Array,
        counts: NDArray[np.bool_],
        tracks: Array,
        ids: NDArray[np.int64],
        false_counts: NDArray[np.bool_],
    ) -> NDArray[np.intp]:
        """Take one scan.

        Args:
            truth: (n, 2) positions of all true people, the same person in the same row in every scan [m].
            counts: (n,) whether missing them is an error.
            tracks: (m, 2) positions of the tracks [m].
            ids: (m,) their numbers.
            false_counts: (m,) whether being false is an error, e.g. near enough to the robot.

        Returns:
            (n,) the row of the track matched to each true person, or -1.
        """
        apart = distances(truth, tracks)
        matched = np.full(len(truth), -1, dtype=np.intp)
        for person, number in self.partner.items():
            rows = np.flatnonzero(ids == number)
            if len(rows) and apart[person, rows[0]] <= self.radius and rows[0] not in matched:
                matched[person] = rows[0]
        people, free = np.flatnonzero(matched < 0), np.setdiff1d(np.arange(len(tracks)), matched)
        rest = apart[np.ix_(people, free)] + 10.0 * self.radius * ~counts[people][:, None]
        rest[apart[np.ix_(people, free)] > self.radius] = np.inf
        rows, columns = assign(rest, 20.0 * self.radius)
        matched[people[rows]] = free[columns]
        hit = counts & (matched >= 0)
        for person in np.flatnonzero(matched >= 0):
            number = int(ids[matched[person]])
            self.switches += int(bool(hit[person]) and self.partner.get(int(person), number) != number)
            self.partner[int(person)] = number
        stray = false_counts & (apart.min(axis=0, initial=np.inf) > self.radius)
        self.truths += int(counts.sum())
        self.misses += int((counts & (matched < 0)).sum())
        self.false += int(stray.sum())
        self.error_sum += float(apart[hit, matched[hit]].sum())
        return matched

    @property
    def mota(self) -> float:
        """1 - (misses + false + switches) / truths; NaN without any truth."""
        return 1.0 - (self.misses + self.false + self.switches) / self.truths if self.truths else float("nan")

    @property
    def motp(self) -> float:
        """Mean distance of the matches [m]."""
        hits = self.truths - self.misses
        return self.error_sum / hits if hits else float("nan")
