"""How surely what is seen is a person: what clusters show, where they are, and for how long (`EvidenceConfig`)."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.rigid_kernel import moved_points
from ...slam.view_kernel import inner_kernel, kernel
from ..legs.recent_views import shares_empty, shares_empty_now
from .local_grid import stood_for
from .still_frame import judge_frame, points_of_walls, stillness

SUREST = 0.99
"""A forest of some ten trees, or a camera, is no surer than this."""


class ScanEvidence(NamedTuple):
    """What the clusters of one scan show.

    Attributes:
        z: (m, 2) where they are, odometry frame [m].
        first: (m,) evidence of each as the better leg.
        second: (m,) as the other one.
        affinity: (m,) what each says to association.
        stood: (m,) for how long something has stood there [s].
        came: (m,) whether nothing at all was there a moment ago.
        still: How far the frame stands still, in [0, 1].
    """

    z: NDArray[np.float64]
    first: NDArray[np.float64]
    second: NDArray[np.float64]
    affinity: NDArray[np.float64]
    stood: NDArray[np.float64]
    came: NDArray[np.bool_]
    still: float


@kernel
def log_odds_of(likelihood):
    """Return the log odds of a likelihood that is no surer than `SUREST`."""
    value = min(max(likelihood, 1.0 - SUREST), SUREST)
    return np.log(value / (1.0 - value))


@kernel
def probability(log_odds):
    """Return the probability of `log_odds`."""
    return 1.0 / (1.0 + np.exp(-log_odds))


@inner_kernel
def look(tracks, found, view, pose, time_s, dt, c):
    """Return what the clusters `found` in a scan with this `view` show, with the robot at `pose` (3,), T_odom_robot."""
    z, count, legs = moved_points(pose, found.positions), len(found.positions), np.flatnonzero(found.confidence > 0.0)
    walls = moved_points(view.laser, points_of_walls(found.points, found.start, found.end, c.frame_points))
    seen = shares_empty(tracks.views, view, np.concatenate((z[legs], walls)), c.views_radius, c.views_margin)
    judge_frame(tracks.frame[0], seen[len(legs) :], dt, c.frame_memory_s)
    shares = np.zeros((count, 2))
    for k in range(len(legs)):
        shares[legs[k], 0], shares[legs[k], 1] = seen[k, 0], seen[k, 1]
    still = stillness(tracks.frame[0], c.frame_doubt)
    stood = np.zeros(count)
    stood[legs] = stood_for(tracks.cells, z[legs], c.things_resolution, time_s, c.things_forget_s)
    first, second, affinity = np.empty(count), np.empty(count), np.empty(count)
    came = np.empty(count, np.bool_)
    for j in range(count):
        vote = log_odds_of(found.confidence[j])
        empty = shares[j, 0] / (shares[j, 0] + shares[j, 1] + c.evidence_unknown)
        first[j] = c.evidence_base + c.evidence_vote * vote + c.evidence_empty * still * empty
        second[j] = max(0.0, c.evidence_second * (vote - c.evidence_second_from))
        apart = np.hypot(z[j, 0] - view.laser[0], z[j, 1] - view.laser[1])
        affinity[j] = -np.inf
        if found.confidence[j] > 0.0 and apart >= c.association_near:
            affinity[j] = min(max(first[j] - c.association_indifferent, c.association_least), c.association_most)
        came[j] = empty >= c.evidence_came
    return ScanEvidence(z, first, second, affinity, stood, came, still)


@inner_kernel
def weigh_looks(rows, sight, view, dt, c):
    """Take the evidence of one scan into the hypotheses `rows` (n,)."""
    places = rows["x"][:, :2].copy()
    empty = shares_empty_now(view, places, c.evidence_body, c.views_margin)
    weigh(
        rows, sight.first, sight.second, empty, seen_from(view.laser, places), sight.still, dt, c.evidence_look,
        c.evidence_jitter, c.evidence_most_looks, c.evidence_hidden_rate, c.evidence_missing_rate,
    )  # fmt: skip


@kernel
def seen_from(pose, points):
    """Return `points` (n, 2) in the frame at `pose` (3,)."""
    cos, sin, seen = np.cos(pose[2]), np.sin(pose[2]), np.empty(points.shape)
    for i in range(len(points)):
        dx, dy = points[i, 0] - pose[0], points[i, 1] - pose[1]
        seen[i, 0], seen[i, 1] = cos * dx + sin * dy, cos * dy - sin * dx
    return seen


@kernel
def weigh(
    rows: Any,
    first: Any,
    second: Any,
    empty: Any,
    viewed: Any,
    known: float,
    dt: float,
    look: float,
    jitter: float,
    most: float,
    hidden: float,
    missing: float,
) -> None:
    """Take the evidence of one scan into the hypotheses.

    Args:
        rows: (n,) hypotheses.
        first: (m,) evidence of each cluster as the better leg.
        second: (m,) as the other one.
        empty: (n, 2) whether the laser sees that nothing is where each hypothesis is.
        viewed: (n, 2) where they are in the laser's frame [m].
        known: How far the odometry frame stands still: only then is motion in it a new look.
        dt: Since the last scan [s].
        look: Motion relative to the laser, or in the odometry frame, that counts as one look [m].
        jitter: Less than this is none [m].
        most: Looks that are remembered.
        hidden: Log odds lost a second while unseen [1/s].
        missing: The same where nothing hides it [1/s].
    """
    for i in range(len(rows)):
        a, b = rows["clusters"][i, 0], rows["clusters"][i, 1]
        if a < 0 and b < 0:
            rows["missing"][i] -= dt * (hidden + (missing - hidden) * empty[i, 0])
            continue
        rows["missing"][i] = 0.0
        dx, dy = viewed[i, 0] - rows["viewed"][i, 0], viewed[i, 1] - rows["viewed"][i, 1]
        way = np.sqrt(dx * dx + dy * dy)
        dx, dy = rows["x"][i, 0] - rows["stood"][i, 0], rows["x"][i, 1] - rows["stood"][i, 1]
        way = max(way, known * np.sqrt(dx * dx + dy * dy))
        if way < jitter or rows["swing"][i] < jitter:  # the second may be a part of the robot
            continue
        value = max(first[a], first[b]) + min(second[a], second[b]) if a >= 0 and b >= 0 else first[max(a, b)]
        weight = min(way / look, 1.0)
        looks = rows["looks"][i] + weight
        rows["evidence"][i] += weight / looks * (value - rows["evidence"][i])
        rows["looks"][i] = min(looks, most)
        rows["viewed"][i, 0], rows["viewed"][i, 1] = viewed[i, 0], viewed[i, 1]
        rows["stood"][i, 0], rows["stood"][i, 1] = rows["x"][i, 0], rows["x"][i, 1]


@kernel
def log_odds(rows: Any, prior: float, alike: float, moved: float, stride: float) -> Any:
    """Return (n,) the log odds that each is a person.

    Looks at one thing are `alike` (intraclass correlation); what has `moved` is likelier a person by as much.
    """
    out = np.empty(len(rows))
    for i in range(len(rows)):
        n = rows["looks"][i]
        out[i] = prior + n / (1.0 + alike * max(n - 1.0, 0.0)) * rows["evidence"][i]
        n = rows["moved"][i] / stride
        out[i] += n / (1.0 + alike * max(n - 1.0, 0.0)) * moved + rows["missing"][i]
    return out


@kernel
def remembered(confidence, sight, memory, still_s):
    """Return (m,) `confidence` of legs, less where something has stood for `still_s`, and more where nothing has."""
    told = np.zeros(len(confidence))
    for j in range(len(confidence)):
        if confidence[j] > 0.0:
            sure = min(max(confidence[j], 1e-6), 1.0 - 1e-6)
            odds = sure / (1.0 - sure) * np.exp((memory if sight.stood[j] < still_s else -memory) * sight.still)
            told[j] = odds / (1.0 + odds)
    return told
