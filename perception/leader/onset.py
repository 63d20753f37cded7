"""The choice of the leader, when a drive begins."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers, check_positive
from ...slam.view_kernel import kernel
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
        self._chosen_s, self._waiting_s = 0.0, np.inf

    def choose(self, people: People, robot: Array, leader: LeaderEstimate | None) -> LeaderEstimate | None:
        """Return the leader chosen in this scan among `people`; None: nobody, or the time to choose is over.

        Args:
            people: In the odometry frame.
            robot: (2,) place of the robot in it [m].
            leader: Who was chosen before; None: nobody yet.
        """
        c, apart = self._config, np.hypot(*(people.positions - robot).T)
        nearest, self._chosen_s, self._waiting_s = choice(
            apart, float(people.time_s), leader is not None, float(self._chosen_s), self._waiting_s, float(c.onset_s),
            float(c.onset_near), float(c.onset_far), float(c.patience_s),
        )  # fmt: skip
        return None if nearest < 0 else as_leader(people, nearest, int(people.ids[nearest]))


@kernel
def choice(apart, time_s, chosen, chosen_s, waiting_s, onset_s, near, far, patience_s):
    """Return who of people at distances `apart` (n,) is chosen in a scan at `time_s`, and the next two as they are now.

    Args:
        apart: Of the people from the robot [m].
        time_s: Of the scan [s].
        chosen: Whether somebody was chosen before.
        chosen_s: When that was [s].
        waiting_s: Since when there are people [s]; inf: never.
        onset_s: See `LeaderConfig`, as the next ones.
        near: See there, `onset_near`.
        far: See there, `onset_far`.
        patience_s: See there.
    """
    if (chosen and time_s - chosen_s >= onset_s) or len(apart) == 0:
        return -1, chosen_s, waiting_s
    waiting_s, nearest = min(waiting_s, time_s), apart.argmin()
    patient = not chosen and time_s - waiting_s < patience_s
    if apart[nearest] > (near if patient else far):
        return -1, chosen_s, waiting_s
    return nearest, chosen_s if chosen else time_s, waiting_s
