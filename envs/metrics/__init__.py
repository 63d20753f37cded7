"""Figures of an episode, computed from its recorded history alone: following, safety, smoothness."""

from ..history import History
from .following import following_metrics
from .safety import safety_metrics
from .smoothness import smoothness_metrics


def episode_metrics(history: History) -> dict[str, float]:
    """Return every figure of an episode by name; the three modules say what each one means.

    A figure that the episode cannot give (no bystander, leader never walked) is NaN.
    """
    return {
        "duration_s": float(history.time_s[-1] - history.time_s[0]),
        "tour_done": float(history.tour_done[-1]),
        **following_metrics(history),
        **safety_metrics(history),
        **smoothness_metrics(history),
    }
