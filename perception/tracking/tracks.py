"""All tracks of one tracker: those of legs, and those of the people whom the legs belong to."""

import numpy as np
from numpy.typing import NDArray

from . import leg_kernels, person_tracks
from .config import TrackerConfig
from .leg_tracks import LegTracks
from .people import People

Array = NDArray[np.float64]
Rows = NDArray[np.intp]


class Tracks:
    """Tracks of legs and of people, in the odometry frame.

    Rows 2 i and 2 i + 1 of the leg tracks are the legs of person i; the rows after them are tentative, nobody's legs
    yet.

    Attributes:
        legs: Tracks of legs.
        people: (n,) of `PERSON`, confirmed people.
    """

    def __init__(self, config: TrackerConfig) -> None:
        self._config = config
        self.legs = LegTracks(config)
        self.people = np.zeros(0, dtype=person_tracks.PERSON)

    @property
    def owned(self) -> int:
        """How many leg tracks are legs of people: so many come first."""
        return 2 * len(self.people)

    @property
    def tentative(self) -> Rows:
        """(k,) rows of the leg tracks that are nobody's yet."""
        return np.arange(self.owned, len(self.legs))

    @property
    def centres(self) -> Array:
        """(n, 2) where the people are [m]."""
        return self.people["x"][:, :2]

    def since_leg_s(self) -> Array:
        """Return (n,) the time since a leg of each person was seen apart from the other [s]."""
        return leg_kernels.since_leg(self.legs.rows, len(self.people))

    def predict(self, dt: float) -> None:
        """Move all tracks `dt` seconds ahead (eq. 4a, 4b)."""
        self.legs.predict(dt)
        person_tracks.predict(self.people, dt, self._config)

    def carry_hidden_legs(self, match: Rows) -> None:
        """Let a person's unseen leg walk with the person, where its offset is believed to be."""
        leg_kernels.carry_hidden(self.legs.rows, self.people, match)

    def count_owned(self, dt: float) -> None:
        """Add `dt` seconds to the time that each leg has been its person's; tentative tracks have none."""
        owned = self.legs.rows["owned_s"]
        owned[: self.owned] += dt
        owned[self.owned :] = 0.0

    def begin(self, match: Rows, z: Array, d: Array) -> None:
        """Begin a tentative track at each of the detections `z` (m, 2), of confidence `d` (m,), that match no track."""
        fresh = leg_kernels.unmatched(match, len(z))
        self.legs.begin(z[fresh], d[fresh])

    def confirm(self, pairs: Rows, people: NDArray[np.void]) -> None:
        """Add `people` (k,), whose legs are the tentative tracks `pairs` (k, 2)."""
        owned = self.owned
        self.people = np.concatenate((self.people, people))
        rest = np.setdiff1d(np.arange(owned, len(self.legs)), pairs)
        self.legs.take(np.concatenate((np.arange(owned), pairs.ravel(), rest)))

    def as_people(self, time_s: float) -> People:
        """Return copies of what is known of the people at `time_s`."""
        people = self.people
        return People(
            time_s=time_s,
            ids=people["id"].copy(),
            positions=people["x"][:, :2].copy(),
            velocities=people["x"][:, 2:].copy(),
            confidence=people["confidence"].copy(),
            legs=self.legs.positions[: self.owned].reshape(-1, 2, 2).copy(),
            variance=people["p"][:, 0].copy(),
            unseen_s=people["unseen_s"].copy(),
            age_s=people["age_s"].copy(),
            seen_legs=self.legs.seen_now(len(people)),
        )
