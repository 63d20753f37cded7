"""Track confirmation: which tentative leg tracks are people (Ye 2021, section II.A)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import leg_kernels
from .config import TrackerConfig
from .data_association import distances
from .identities import Identities
from .local_grid import LocalGrid
from .origins import OriginCheck
from .pairing import mutual_pairs
from .reidentification import Reidentification
from .track_kernels import any_moved, any_sure_walker, spread_among
from .tracks import Rows, Tracks

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class _Candidates:
    """Tentative leg tracks that may be legs of somebody.

    Attributes:
        rows: (k,) of the leg tracks.
        moved: (k,) how far each has moved [m].
        known: (k,) whether it may be a leg of somebody to be re-identified, who has moved before.
        sure: (k,) whether its confidence is high.
    """

    rows: Rows
    moved: Array
    known: Mask
    sure: Mask


class TrackConfirmation:
    """Makes people of tentative leg tracks that moved as people do: of pairs of legs, and of single legs that are sure.

    Args:
        config: Of the tracker.
        grid: Where things stand that are not human.
        reidentification: People whose tracks have ended.
        identities: Who numbers the people.
    """

    def __init__(
        self, config: TrackerConfig, grid: LocalGrid, reidentification: Reidentification, identities: Identities
    ) -> None:
        self._config, self._grid, self._pairing = config.confirmation, grid, config.pairing
        self._c_min, self._one_leg_age_s = config.termination.c_min, config.reidentification.one_leg_age_s
        self._reidentification, self._identities = reidentification, identities
        self._origins = OriginCheck(config.confirmation.origin_radius, grid)

    def confirm(self, tracks: Tracks, points: Array, time_s: float) -> None:
        """Confirm people among the tentative `tracks`; the scan at `time_s` shows `points` (n, 2), odometry frame."""
        config, legs = self._config, tracks.legs
        bounds = config.delta / 2.0, self._c_min, config.unseen_s
        if len(self._reidentification) == 0 and not any_moved(legs.rows, tracks.owned, *bounds):
            return
        rows = leg_kernels.promising(legs.rows, tracks.owned, self._c_min, config.unseen_s)
        moved, known = legs.moved[rows], self._reidentification.may_be_legs(legs, rows)
        if not (known | (moved >= config.delta / 2.0)).any():
            return
        sure = legs.rows["confidence"][rows] >= config.sure_confidence
        self._confirm_pairs(tracks, _Candidates(rows, moved, known, sure), points, time_s)
        self._confirm_one_leg(tracks, points, time_s)

    def _confirm_pairs(self, tracks: Tracks, among: _Candidates, points: Array, time_s: float) -> None:
        """Confirm each pair that is leg-like (gamma) in the mean over time, stands on free cells, and belongs together.

        Two legs belong together if each is the other's nearest in the mean over a stride.
        """
        legs, rows = tracks.legs, among.rows
        spread = spread_among(legs.apart, legs.rows["x"], rows, self._pairing.distance)
        pairs = mutual_pairs(spread, self._pairing.width)
        pairs = pairs[legs.rows["confidence"][rows][pairs].min(axis=1) >= self._config.gamma]
        if len(pairs):
            pairs = pairs[self._moved_together(tracks, among, pairs, points, time_s)]
            free = self._grid.is_free(legs.positions[rows[pairs.ravel()]], time_s).reshape(-1, 2)
            self._identities.confirm(tracks, rows[pairs[free.all(axis=1)]])

    def _moved_together(self, tracks: Tracks, among: _Candidates, pairs: Rows, points: Array, time_s: float) -> Mask:
        """Return (k,) whether both legs of each of `pairs` (k, 2) of the candidates moved `delta` in the mean.

        So the longer way of one leg makes up for the other, whose track was renewed on the way. Two sure legs need
        half as much, and one of them may stand while the other swings past it. Who is known has moved before.
        """
        config, moved, known = self._config, among.moved, among.known
        moves = moved > config.origin_radius
        ways = np.where(known, np.maximum(moved, config.delta), moved)[pairs].sum(axis=1)
        both_sure = among.sure[pairs].all(axis=1)
        enough = ways >= np.where(both_sure, config.delta, 2.0 * config.delta)
        asked = np.zeros(len(moved), dtype=bool)
        asked[pairs[enough]] = True
        asked &= moves & ~known
        left = np.ones(len(moved), dtype=bool)
        left[asked] = self._origins.check(tracks, among.rows[asked], points, time_s)
        went = known | (moves & left)
        return enough & left[pairs].all(axis=1) & (both_sure | went[pairs].all(axis=1))

    def _confirm_one_leg(self, tracks: Tracks, points: Array, time_s: float) -> None:
        """Re-identify somebody of whom one leg is seen, or confirm a sure leg that moved for both.

        It stands on a free cell; the other leg counts as hidden by it, or by what stands before it.
        """
        config, legs, ended = self._config, tracks.legs, self._reidentification
        bounds = 2.0 * config.delta, config.sure_confidence, self._one_leg_age_s
        if len(ended) == 0 and not any_sure_walker(legs.rows, tracks.owned, *bounds):
            return
        rows = tracks.tentative
        rows = rows[(legs.rows["unseen_s"][rows] == 0.0) & (legs.rows["age_s"][rows] >= self._one_leg_age_s)]
        known = ended.may_be_legs(legs, rows)
        walked = ~known & (legs.moved[rows] >= 2.0 * config.delta)
        walked &= legs.rows["confidence"][rows] >= config.sure_confidence
        walked[walked] = self._origins.check(tracks, rows[walked], points, time_s)
        rows = rows[known | walked]
        rows = rows[self._grid.is_free(legs.positions[rows], time_s)]
        if len(rows):
            apart = distances(legs.positions[rows], ended.positions).min(axis=1, initial=np.inf)
            chosen = rows[apart.argmin()]
            legs.take(np.append(np.arange(len(legs)), chosen))
            self._identities.confirm(tracks, np.array([[chosen, len(legs) - 1]]))
