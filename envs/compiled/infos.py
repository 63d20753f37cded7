"""What compiled worlds tell beside their observations, as Gymnasium batches it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..task.endings import REASONS
from ..task.rewards import FOLLOWING_TERMS
from .state import Flags, Told

_REASONS = np.array(REASONS, dtype=object)
_GOOD = np.array([reason in ("tour_done", "covered") for reason in REASONS])


def observations(told: Told) -> dict[str, NDArray[Any]]:
    """Return the observations of all worlds; the arrays are those that are written to."""
    return {"scan": told.scan, "people": told.people, "velocity": told.velocity, "leader": told.leader}


def infos(told: Told, mask: Flags) -> dict[str, Any]:
    """Return the infos of the worlds of `mask` (w,); new arrays, 0 for the others."""
    kept = bool(mask.all())
    table: dict[str, Any] = {
        "time_s": told.time_s,
        "ending": _REASONS[told.ending],
        "is_success": _GOOD[told.ending],
        "tracked_people": told.tracked,
        "odometry": told.odometry,
        "robot_pose": told.robot_pose,
        "leader_distance": told.distance,
        "following_leader": told.following,
        "lost_s": told.lost_s,
        "leader_id": told.track,
    }
    terms = {name: told.terms[:, k] for k, name in enumerate(FOLLOWING_TERMS)}
    told_of: dict[str, Any] = {name: _only(values, mask, kept) for name, values in table.items()}
    told_of["reward_terms"] = masked({name: _only(values, mask, kept) for name, values in terms.items()}, mask)
    return masked(told_of, mask)


def masked(table: dict[str, Any], mask: Flags) -> dict[str, Any]:
    """Return a table with the masks that Gymnasium puts beside each entry."""
    return {**table, **{f"_{name}": mask.copy() for name in table}}


def _only(values: NDArray[Any], mask: Flags, kept: bool) -> NDArray[Any]:
    if kept:
        return values.copy()
    empty = np.zeros_like(values) if values.dtype != object else np.full(values.shape, None, dtype=object)
    empty[mask] = values[mask]
    return empty
