"""The figures that Follow-Bench reports, by its definitions, from the recorded history.

After MedlarTea/follow-bench (`env_eval.py`) and its second version: distances are between surfaces; losses count as
recovered within 5 s. Theirs are discs in the plane; ours are the bodies' circles, and the target is seen when the
robot's own tracker sees it.
"""

import numpy as np

from .history import SAME_TIME_S, History, run_lengths

PERSONAL_M, PRIVATE_M = 1.2, 0.45
"""Hall's personal and intimate distance [m]."""
RECOVERED_S = 5.0
"""A loss counts as recovered when it lasts no longer [s]."""


def follow_bench_metrics(history: History) -> dict[str, float]:
    """Return Follow-Bench's figures; what is about the target is NaN where there is none.

    - `fb_success`: 1 if the tour was done, nothing was touched and every loss (of more than 1 s) recovered within 5 s.
    - `fb_path_m`, `fb_search_path_m`, `fb_search_s`: way of the robot, the part of it without the target in sight, and
      the time of that.
    - `fb_speed_mps`, `fb_acceleration_mps2`, `fb_jerk_mps3`: means of the norms of the velocity in the plane and of its
      first and second difference over the step.
    - `fb_personal_s`: time in which the target's surface is 0.45 to 1.2 m away (more is better).
    - `fb_private_s`: time in which anybody's is nearer than 0.45 m (less is better).
    """
    step, after_start = history.step_s, slice(1, None)  # row 0 is before the first step: no time has passed
    heading = history.robot_pose[:, 2]
    forward, left = history.robot_velocity[:, 0], history.robot_velocity[:, 1]
    velocity = np.stack(
        (np.cos(heading) * forward - np.sin(heading) * left, np.sin(heading) * forward + np.cos(heading) * left), axis=1
    )
    ways = np.linalg.norm(np.diff(history.robot_pose[:, :2], axis=0), axis=1)
    seen = np.flatnonzero(history.leader_visible)
    lost = ~history.leader_visible & (np.arange(len(history)) >= (seen[0] if len(seen) else 0))
    gaps = [(end - start) * step for start, end in run_lengths(lost)]
    touched = bool(history.contact_person.any() or history.contact_static.any())
    recovered = all(gap <= RECOVERED_S + SAME_TIME_S for gap in gaps)
    led, nan = history.leader_index >= 0, float("nan")
    surface = history.surface_distance
    target = surface[:, history.leader_index] if led else np.full(len(history), nan)
    personal, private = (target >= PRIVATE_M) & (target <= PERSONAL_M), surface.min(axis=1, initial=np.inf) < PRIVATE_M
    return {
        "fb_success": float(bool(history.tour_done[-1]) and not touched and recovered) if led else nan,
        "fb_path_m": float(ways.sum()),
        "fb_search_path_m": float(ways[lost[after_start]].sum()) if led else nan,
        "fb_search_s": float(lost[after_start].sum() * step) if led else nan,
        "fb_speed_mps": float(np.mean(np.linalg.norm(velocity, axis=1))),
        "fb_acceleration_mps2": _mean_norm(np.diff(velocity, axis=0) / step),
        "fb_jerk_mps3": _mean_norm(np.diff(velocity, n=2, axis=0) / step**2),
        "fb_personal_s": float(np.sum(personal[after_start]) * step) if led else nan,
        "fb_private_s": float(np.sum(private[after_start]) * step),
    }


def _mean_norm(rows: np.ndarray) -> float:
    return float(np.mean(np.linalg.norm(rows, axis=1))) if len(rows) else float("nan")
