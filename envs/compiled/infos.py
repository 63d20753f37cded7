"""What compiled worlds tell beside their observations, as Gymnasium batches it."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..task.endings import REASONS
from ..task.rewards import FOLLOWING_TERMS
from .state import Array, Flags, Told

_REASONS = np.array(REASONS, dtype=object)
SUCCESSES = np.array([reason in ("tour_done", "covered") for reason in REASONS])
"""Which of `REASONS` are successes."""


def observations(told: Told) -> dict[str, NDArray[Any]]:
    """Return the observations of all worlds; the arrays are those that are written to."""
    return {"scan": told.scan, "people": told.people, "velocity": told.velocity, "leader": told.leader}


def infos(told: Told, own: Mapping[str, Array], mask: Flags) -> dict[str, Any]:
    """Return the infos of the worlds of `mask` (w,), with `own` terms of the reward; new arrays, 0 for the others."""
    kept = bool(mask.all())
    table = {**table_of(told), "ending": _REASONS[told.ending], "is_success": SUCCESSES[told.ending]}
    told_of: dict[str, Any] = {name: _only(values, mask, kept) for name, values in table.items()}
    terms = {name: _only(values, mask, kept) for name, values in {**terms_of(told.terms), **own}.items()}
    return masked({**told_of, "reward_terms": masked(terms, mask)}, mask)


def table_of(told: Told) -> dict[str, Any]:
    """Return what infos tell of all worlds; the arrays are those that are written to, `ending` a number."""
    return {
        "time_s": told.time_s,
        "ending": told.ending,
        "tracked_people": told.tracked,
        "odometry": told.odometry,
        "robot_pose": told.robot_pose,
        "leader_distance": told.facts[:, 0],
        "following_leader": told.following,
        "lost_s": told.lost_s,
        "leader_id": told.track,
    }


def terms_of(terms: Any) -> dict[str, Any]:
    """Return the terms of the reward (w, 7) by name."""
    return {name: terms[:, k] for k, name in enumerate(FOLLOWING_TERMS)}


def masked(table: dict[str, Any], mask: Flags) -> dict[str, Any]:
    """Return a table with the masks that Gymnasium puts beside each entry."""
    return {**table, **{f"_{name}": mask.copy() for name in table}}


def _only(values: NDArray[Any], mask: Flags, kept: bool) -> NDArray[Any]:
    if kept:
        return values.copy()
    empty = np.zeros_like(values) if values.dtype != object else np.full(values.shape, None, dtype=object)
    empty[mask] = values[mask]
    return empty
