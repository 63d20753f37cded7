"""When and why an episode ends by itself; the limit of time belongs to Gymnasium's wrapper."""

from dataclasses import dataclass

from ..world.truth import TrueState
from .config import TaskConfig
from .rewards import StepFacts


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
        reasons = {
            "collision_person": truth.contact_person and config.ends_on_contact,
            "collision_static": truth.contact_static and config.ends_on_contact,
            "tour_done": truth.tour_done and config.leader,
            "covered": not config.leader and facts.coverage >= config.coverage_goal,
            "leader_lost": self._lost_s > config.lost_limit_s,
        }
        return Ending(next((reason for reason, holds in reasons.items() if holds), ""), self._lost_s)
