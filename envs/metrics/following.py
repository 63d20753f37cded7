"""How well the leader was followed."""

import numpy as np
from numpy.typing import NDArray

from ...slam.geometry import wrap_angle
from .history import SAME_TIME_S, History, run_lengths

FOLLOWING_DISTANCE = 1.3
"""Distance that the follower keeps from the leader, centre to centre [m]."""
SETTLING_S = 3.0
"""Time after the leader's first step that the follower is given to get under way [s]."""
LOST_AFTER_S = 1.0
"""The leader counts as lost when it was not seen for longer than this [s]."""
SAME_PERSON_M = 0.75
"""An estimated leader within this distance of the true one is the right person, unless a bystander is nearer [m]."""

CHOICE_SETTLES_S = 1.0
"""A person counts as chosen when taken for the leader for longer than this [s]."""


def following_metrics(history: History) -> dict[str, float]:
    """Return the figures of following.

    - `distance_error_rms_m`, `distance_error_mean_m`, `distance_error_max_m`: centre distance minus 1.3 m, over the
      steps in which the leader walks, from 3 s after it first walked ("steady steps"). `bearing_error_rms_rad`: of the
      leader's bearing, over the same steps.
    - `band_1_2_m_share`: share of steady steps with centre distance in [1, 2] m (Habitat's band);
      `band_personal_share`: with surface distance in [0.45, 1.2] m (Follow-Bench's).
    - `leader_visible_share`: share of all steps since the leader was first seen in which it is seen.
    - `losses`: times it was unseen for more than 1 s after it had been seen; `reacquired`: those that ended;
      `reacquire_s`: median time of those until it was seen again [s].
    - `leader_choices`, `leader_choices_right`: how often a new identity was taken for the leader for more than a second
      (the time in which the first choice may still be revised), and how often that was then the true one;
      `leader_right_share`: share of the steps with a visible leader in which it is the true one.
    """
    steady = steady_steps(history)
    offset = history.leader_position - history.robot_pose[:, :2]
    distance = np.linalg.norm(offset, axis=-1)
    error = (distance - FOLLOWING_DISTANCE)[steady]
    bearing = wrap_angle(np.arctan2(offset[:, 1], offset[:, 0]) - history.robot_pose[:, 2])[steady]
    surface = history.surface_distance[steady, history.leader_index]
    centre = distance[steady]
    return {
        "distance_error_rms_m": _rms(error),
        "distance_error_mean_m": _mean(error),
        "distance_error_max_m": float(np.max(np.abs(error), initial=0.0)) if len(error) else float("nan"),
        "bearing_error_rms_rad": _rms(bearing),
        "band_1_2_m_share": _mean((centre >= 1.0) & (centre <= 2.0)),
        "band_personal_share": _mean((surface >= 0.45) & (surface <= 1.2)),
        **_losses(history),
        **_choices(history),
    }


def steady_steps(history: History) -> NDArray[np.bool_]:
    """Return (n,) whether the leader walks and first did so at least 3 s ago."""
    walking = np.flatnonzero(history.leader_walking)
    if len(walking) == 0:
        return np.zeros(len(history), dtype=bool)
    return history.leader_walking & (history.time_s - history.time_s[walking[0]] >= SETTLING_S - SAME_TIME_S)


def leader_is_right(history: History) -> NDArray[np.bool_]:
    """Return (n,) whether the person taken for the leader is the true one: the nearest, and within 0.75 m."""
    gap = np.linalg.norm(history.person_position - history.leader_estimate[:, None], axis=-1)
    gap = np.where(np.isnan(gap), np.inf, gap)
    return (np.argmin(gap, axis=1) == history.leader_index) & (gap[:, history.leader_index] <= SAME_PERSON_M)


def _losses(history: History) -> dict[str, float]:
    seen = np.flatnonzero(history.leader_visible)
    if len(seen) == 0:
        return {"leader_visible_share": 0.0, "losses": 0.0, "reacquired": 0.0, "reacquire_s": float("nan")}
    visible = history.leader_visible[seen[0] :]
    gaps = [gap for gap in run_lengths(~visible) if (gap[1] - gap[0]) * history.step_s > LOST_AFTER_S + SAME_TIME_S]
    closed = [(end - start) * history.step_s for start, end in gaps if end < len(visible)]
    return {
        "leader_visible_share": _mean(visible),
        "losses": float(len(gaps)),
        "reacquired": float(len(closed)),
        "reacquire_s": float(np.median(closed)) if closed else float("nan"),
    }


def _choices(history: History) -> dict[str, float]:
    right = leader_is_right(history)
    made, made_right = 0, 0
    for number in np.unique(history.leader_id[history.leader_id >= 0]):
        for start, end in run_lengths(history.leader_id == number):
            settled = (history.time_s[start:end] - history.time_s[start]) > CHOICE_SETTLES_S + SAME_TIME_S
            settled &= history.leader_visible[start:end]
            if settled.any():
                made += 1
                made_right += int(right[start + int(np.argmax(settled))])
    return {
        "leader_choices": float(made),
        "leader_choices_right": float(made_right),
        "leader_right_share": _mean(right[history.leader_visible]),
    }


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def _mean(values: NDArray[np.float64] | NDArray[np.bool_]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")
