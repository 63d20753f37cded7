"""How safe the robot was for the people and the building around it."""

import numpy as np
from numpy.typing import NDArray

from .history import History, run_lengths

Array = NDArray[np.float64]

NEAR_MISS_M = 0.25
"""Free space to a bystander below which an encounter is a near miss [m]."""
PERSONAL_SPACE_M = 0.45
"""Hall's intimate distance, kept free of robots [m]."""
NEAR_PEOPLE_M = 1.2
"""Hall's personal distance, within which the robot's speed is reported [m]."""
TTC_LIMITS_S = (1.0, 2.0, 3.0)
"""Times to collision of which the share of time below is reported [s]."""


def safety_metrics(history: History) -> dict[str, float]:
    """Return the figures of safety. Distances are between surfaces of enclosing circles, unless said otherwise.

    - `contacts_people`, `contacts_static`: maximal intervals with a contact of the simulated bodies;
      `collision_free`: 1 if there was none of either.
    - `min_distance_bystander_m`, `min_distance_leader_m`; `min_distance_static_m` from the robot's enclosing circle,
      which reaches beyond its corners, to the nearest edge of a static thing.
    - `near_misses`: intervals with less than 0.25 m to a bystander and no overlap.
    - `personal_space_compliance`: share of steps with at least 0.45 m to every bystander; `_leader`: to the leader.
    - `speed_near_people_mps`: mean speed while a bystander is nearer than 1.2 m.
    - `min_ttc_s`: least time to collision with a bystander at constant velocities; `ttc_below_1s_share` (2, 3): share
      of steps below.
    """
    surface = history.surface_distance
    to_bystander = surface[:, history.bystanders].min(axis=1, initial=np.inf)
    nobody = np.full(len(history), np.nan)
    to_leader = surface[:, history.leader_index] if history.leader_index >= 0 else nobody
    speed = np.linalg.norm(history.robot_velocity[:, :2], axis=1)
    near = to_bystander < NEAR_PEOPLE_M
    people, static = run_lengths(history.contact_person), run_lengths(history.contact_static)
    alone = len(history.bystanders) == 0
    return {
        "contacts_people": float(len(people)),
        "contacts_static": float(len(static)),
        "collision_free": float(not people and not static),
        "min_distance_bystander_m": float("nan") if alone else float(to_bystander.min()),
        "min_distance_leader_m": float(to_leader.min()),
        "min_distance_static_m": float(history.static_clearance.min() - history.robot_radius),
        "near_misses": float(len(run_lengths((to_bystander > 0.0) & (to_bystander < NEAR_MISS_M)))),
        "personal_space_compliance": float("nan") if alone else float(np.mean(to_bystander >= PERSONAL_SPACE_M)),
        "personal_space_compliance_leader": float(
            np.mean(np.where(np.isnan(to_leader), np.nan, to_leader >= PERSONAL_SPACE_M))
        ),
        "speed_near_people_mps": float(np.mean(speed[near])) if near.any() else float("nan"),
        **_ttc_figures(history),
    }


def time_to_collision(offset: Array, velocity: Array, radius: Array) -> Array:
    """Return (...) time until two circles touch at constant velocities [s]; 0 if they do, inf if they never will.

    Args:
        offset: (..., 2) centre of the other circle minus ours [m].
        velocity: (..., 2) velocity of the other circle minus ours [m/s].
        radius: (...) sum of the radii [m].
    """
    a = np.sum(velocity**2, axis=-1)
    b = np.sum(offset * velocity, axis=-1)
    c = np.sum(offset**2, axis=-1) - np.square(radius)
    root = b**2 - a * c
    meets = (c > 0.0) & (b < 0.0) & (root >= 0.0)
    time = (-b - np.sqrt(np.where(meets, root, 0.0))) / np.where(meets, a, 1.0)
    return np.where(c <= 0.0, 0.0, np.where(meets, time, np.inf))


def _ttc_figures(history: History) -> dict[str, float]:
    names = [f"ttc_below_{limit:.0f}s_share" for limit in TTC_LIMITS_S]
    if len(history.bystanders) == 0:
        return dict.fromkeys(["min_ttc_s", *names], float("nan"))
    heading = history.robot_pose[:, 2]
    forward, left = history.robot_velocity[:, 0], history.robot_velocity[:, 1]
    robot = np.stack(
        (np.cos(heading) * forward - np.sin(heading) * left, np.sin(heading) * forward + np.cos(heading) * left), axis=1
    )
    others = history.bystanders
    ttc = time_to_collision(
        history.person_position[:, others] - history.robot_pose[:, None, :2],
        history.person_velocity[:, others] - robot[:, None],
        history.person_radius[others] + history.robot_radius,
    ).min(axis=1)
    shares = {name: float(np.mean(ttc < limit)) for name, limit in zip(names, TTC_LIMITS_S, strict=True)}
    return {"min_ttc_s": float(ttc.min()), **shares}
