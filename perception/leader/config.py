"""Numbers of the choice of the leader."""

from dataclasses import dataclass

from ...slam.bounds import check_numbers, check_positive


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
    """

    onset_s: float = 1.0
    onset_near: float = 2.2
    onset_far: float = 4.0
    patience_s: float = 1.0
    search_sigmas: float = 2.0
    search_distance: float = 8.0
    search_overlap_s: float = 3.0

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "onset_near", "onset_far", "search_sigmas", "search_distance")
