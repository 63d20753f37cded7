"""Figures of an episode, computed from its recorded history alone: following, exploration, safety, smoothness."""

from .exploration import exploration_metrics
from .following import following_metrics
from .history import History
from .safety import safety_metrics
from .smoothness import smoothness_metrics


def episode_metrics(history: History) -> dict[str, float]:
    """Return every figure of an episode by name; the four modules say what each one means.

    A figure that the episode cannot give (no bystander, leader never walked) is NaN; those of following are left out
    where nobody leads.
    """
    return {
        "duration_s": float(history.time_s[-1] - history.time_s[0]),
        "tour_done": float(history.tour_done[-1]),
        **(following_metrics(history) if history.leader_index >= 0 else {}),
        **exploration_metrics(history),
        **safety_metrics(history),
        **smoothness_metrics(history),
    }
