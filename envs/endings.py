"""When and why an episode ends by itself; the limit of time belongs to Gymnasium's wrapper."""

from dataclasses import dataclass

from .rewards import StepFacts
from .truth import TrueState


@dataclass(frozen=True)
class Ending:
    """Whether and why an episode ended.

    Attributes:
        reason: "collision_person", "collision_static", "leader_lost", "tour_done", or "" while it goes on.
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
        lost_limit_s: The leader may be lost for this long [s].
    """

    def __init__(self, lost_limit_s: float) -> None:
        self._limit_s = lost_limit_s
        self._lost_s = 0.0

    def update(self, truth: TrueState, facts: StepFacts) -> Ending:
        """Return whether the episode ends with this step; the first reason that holds counts."""
        self._lost_s = 0.0 if facts.following_leader else self._lost_s + facts.step_s
        reasons = {
            "collision_person": truth.contact_person,
            "collision_static": truth.contact_static,
            "tour_done": truth.tour_done,
            "leader_lost": self._lost_s > self._limit_s,
        }
        return Ending(next((reason for reason, holds in reasons.items() if holds), ""), self._lost_s)
