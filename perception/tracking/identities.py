"""Numbers of people: old ones for those who are re-identified, new ones for the others."""

import numpy as np
from numpy.typing import NDArray

from . import person_tracks
from .config import ReidentificationConfig
from .reidentification import Reidentification
from .tracks import Rows, Tracks


class Identities:
    """Makes people of pairs of tentative leg tracks, each with a number of its own.

    Args:
        config: Of the re-identification.
        reidentification: People whose tracks have ended.
    """

    def __init__(self, config: ReidentificationConfig, reidentification: Reidentification) -> None:
        self._config, self._reidentification = config, reidentification
        self._next_id = 0

    def confirm(self, tracks: Tracks, pairs: Rows) -> None:
        """Make people of the pairs of tentative tracks `pairs` (k, 2), under their old number where they have one."""
        if len(pairs) == 0:
            return
        people = person_tracks.new_people(tracks.legs.rows[pairs])
        unsure = np.minimum(tracks.since_leg_s(), tracks.people["camera_s"]) > self._config.unseen_s
        people["id"] = self._reidentification.identify(people["x"][:, :2], people["age_s"], tracks.people[unsure])
        duplicate = self._end_duplicates(tracks, people["id"])
        fresh = np.concatenate((duplicate, people["id"] < 0))
        numbers = np.concatenate((tracks.people["id"], people["id"]))
        numbers[fresh] = self._next_id + np.arange(np.count_nonzero(fresh))
        self._next_id += np.count_nonzero(fresh)
        tracks.people["id"], people["id"] = np.split(numbers, [len(tracks.people)])
        tracks.confirm(pairs, people)

    @staticmethod
    def _end_duplicates(tracks: Tracks, numbers: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return (n,) which people have a number that somebody new has now.

        Their tracks have slid off to something else: they end with the next scan, and are not to be re-identified.
        """
        duplicate = np.isin(tracks.people["id"], numbers)
        tracks.people["confidence"][duplicate] = tracks.people["age_s"][duplicate] = 0.0
        return duplicate
