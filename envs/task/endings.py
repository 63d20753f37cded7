"""When and why an episode ends by itself; the limit of time belongs to Gymnasium's wrapper."""

from dataclasses import dataclass

from ...slam.view_kernel import kernel
from ..world.truth import TrueState
from .config import TaskConfig
from .rewards import StepFacts

REASONS = ("", "collision_person", "collision_static", "tour_done", "covered", "leader_lost")
"""Why an episode ended; the first one that holds counts."""


@dataclass(frozen=True)
class Ending:
    """Whether and why an episode ended.

    Attributes:
        reason: "collision_person", "collision_static", "leader_lost", "tour_done", "covered", or "" while it goes on.
        lost_s: For how long the leader has not been followed [s].
    """

    reason: str = ""
    lost_s: float = 0.0

    @property
    def terminated(self) -> bool:
        """Whether the episode is over."""
        return bool(self.reason)


class EndingRule:
    """Watches one episode.

    Args:
        config: Whether there is a leader, for how long it may be lost, what share of the floor is to be seen without
            one, and whether a contact ends it all.
    """

    def __init__(self, config: TaskConfig) -> None:
        self._config = config
        self._lost_s = 0.0

    def update(self, truth: TrueState, facts: StepFacts) -> Ending:
        """Return whether the episode ends with this step; the first reason that holds counts."""
        config = self._config
        looks_for_leader = config.leader and not facts.following_leader
        self._lost_s = self._lost_s + facts.step_s if looks_for_leader else 0.0
        ends = config.ends_on_contact
        code = ending_code(
            truth.contact_person and ends,
            truth.contact_static and ends,
            truth.tour_done and config.leader,
            not config.leader and facts.coverage >= config.coverage_goal,
            self._lost_s > config.lost_limit_s,
        )
        return Ending(REASONS[code], self._lost_s)


@kernel
def ending_code(person: bool, static: bool, tour: bool, covered: bool, lost: bool) -> int:
    """Return the number in `REASONS` of the first reason that holds, 0 for none."""
    return 1 if person else 2 if static else 3 if tour else 4 if covered else 5 if lost else 0
