"""The choice of the leader, when a drive begins."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers, check_positive
from ..tracking.people import People
from .estimate import LeaderEstimate, as_leader

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LeaderConfig:
    """How a leader is chosen and looked for.

    Attributes:
        onset_s: The choice may still change for this long after the first one, if somebody else is nearer [s].
        onset_near: Somebody this near the robot is chosen at once [m].
        onset_far: Nobody farther from the robot than this is ever chosen [m].
        patience_s: Somebody between the two only when nobody came nearer for this long after the first was seen [s].
        search_sigmas: A lost leader is looked for within this many standard deviations of its prediction.
        search_distance: And never farther from it than this [m].
        search_overlap_s: How long somebody may have been tracked before the leader was last seen and still be it: the
            old track may have slid off to something else [s].
        duplicate_distance: Somebody tracked nearer to the leader than this is a duplicate track of the leader: no two
            bodies are that near [m]. A duplicate takes over when the leader's own track is unseen.
        duplicate_patience_s: For how long it must be unseen [s].
    """

    onset_s: float = 1.0
    onset_near: float = 2.2
    onset_far: float = 4.0
    patience_s: float = 1.0
    search_sigmas: float = 2.0
    search_distance: float = 8.0
    search_overlap_s: float = 3.0
    duplicate_distance: float = 0.4
    duplicate_patience_s: float = 0.3

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "onset_near", "onset_far", "search_sigmas", "search_distance")


class LeaderOnset:
    """Chooses the person closest to the robot, and may change its mind for a moment.

    Args:
        config: How near, and for how long.
    """

    def __init__(self, config: LeaderConfig) -> None:
        self._config = config
        self._chosen_s, self._waiting_since = 0.0, np.inf

    def choose(self, people: People, robot: Array, leader: LeaderEstimate | None) -> LeaderEstimate | None:
        """Return the leader chosen in this scan among `people`; None: nobody, or the time to choose is over.

        Args:
            people: In the odometry frame.
            robot: (2,) place of the robot in it [m].
            leader: Who was chosen before; None: nobody yet.
        """
        config = self._config
        if leader is not None and people.time_s - self._chosen_s >= config.onset_s:
            return None
        if len(people) == 0:
            return None
        apart = np.hypot(*(people.positions - robot).T)
        self._waiting_since = min(self._waiting_since, people.time_s)
        patient = leader is None and people.time_s - self._waiting_since < config.patience_s
        if apart.min() > (config.onset_near if patient else config.onset_far):
            return None
        if leader is None:
            self._chosen_s = people.time_s
        nearest = int(apart.argmin())
        return as_leader(people, nearest, int(people.ids[nearest]))
