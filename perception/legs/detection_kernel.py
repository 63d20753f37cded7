"""From the ranges of a scan to its clusters, and how much each looks like a leg, as one kernel."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.rigid_kernel import moved_points
from ...slam.scan_kernel import returns
from ...slam.view_kernel import kernel
from .centres_kernel import leg_centres_of
from .clusters import split_by_distance
from .forest_kernel import vote
from .shape_kernels import SHAPE_COUNT, describe_shapes
from .surroundings_kernels import SURROUNDINGS_COUNT, describe_surroundings

WIDEST_LEG = 0.8
"""A cluster whose ends are farther apart is no leg and is not described [m]."""


class Beams(NamedTuple):
    """What all sweeps of a laser have in common.

    Attributes:
        bearings: (N,) [rad].
        directions: (N, 2) unit vectors along them, laser frame.
        range_min: Shortest valid range [m].
        range_max: Longest valid range [m].
        mount: (3,) T_robot_lidar.
        spacing: Mean angle between neighbouring beams [rad].
    """

    bearings: NDArray[np.float64]
    directions: NDArray[np.float64]
    range_min: float
    range_max: float
    mount: NDArray[np.float64]
    spacing: float


class Splitting(NamedTuple):
    """Numbers of `LegDetectorConfig`, with `beams_at_1m` of `split_by_distance` in place of `far_width`."""

    alpha: float
    beta: int
    gamma: float
    beams_at_1m: float


class Found(NamedTuple):
    """All clusters of a scan, as in `Detections`.

    Attributes:
        points: (k, 2) returns, laser frame [m].
        numbers: (k,) the beam of each.
        start: (m,) first return of each cluster.
        end: (m,) one past the last.
        positions: (m, 2) centre of the leg that would show such an arc, robot frame [m].
        confidence: (m,) in [0, 1].
        human: (m,) whether each looks like a leg.
    """

    points: NDArray[np.float64]
    numbers: NDArray[np.int64]
    start: NDArray[np.int64]
    end: NDArray[np.int64]
    positions: NDArray[np.float64]
    confidence: NDArray[np.float64]
    human: NDArray[np.bool_]


@kernel
def find_legs(ranges, beams, splitting, forest) -> Found:
    """Return the clusters in `ranges` (N,) along `beams`, split by `splitting` and judged by `forest`."""
    points, numbers = returns(ranges, beams.directions, beams.range_min, beams.range_max)
    start, end = split_by_distance(points, splitting.alpha, splitting.beta, splitting.beams_at_1m)
    confidence = leg_confidence(points, ranges[numbers], beams.bearings[numbers], start, end, beams.spacing, forest)
    positions = moved_points(beams.mount, leg_centres_of(points, start, end))
    return Found(points, numbers, start, end, positions, confidence, confidence >= splitting.gamma)


@kernel
def leg_confidence(points, ranges, bearings, start, end, spacing, forest):
    """Return (m,) in [0, 1] how much each cluster looks like a leg; 0 for clusters too wide for one.

    Args:
        points: (k, 2) returns of a scan, laser frame.
        ranges: (k,) of them.
        bearings: (k,) of them.
        start: (m,) first return of each cluster.
        end: (m,) one past the last.
        spacing: Mean angle between neighbouring beams [rad].
        forest: Of legs.
    """
    narrow = np.flatnonzero(~are_wide(points, start, end))
    features = described(points, ranges, bearings, start, end, spacing)[narrow]
    share, confidence, odds = np.empty(len(narrow)), np.zeros(len(start)), forest.odds
    vote(forest, features, share)
    for k in range(len(narrow)):
        confidence[narrow[k]] = odds * share[k] / (odds * share[k] + 1.0 - share[k])
    return confidence


@kernel
def are_wide(points, start, end):
    """Return (m,) whether the ends of a cluster are farther apart than `WIDEST_LEG`: walls, nobody classifies them."""
    wide = np.empty(len(start), np.bool_)
    for m in range(len(start)):
        a, b = start[m], end[m] - 1
        wide[m] = np.hypot(points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]) > WIDEST_LEG
    return wide


@kernel
def described(points, ranges, bearings, start, end, spacing):
    """Return (m, F) features of the clusters, as `leg_confidence` takes them; NaN where they are wide."""
    features = np.full((len(start), SHAPE_COUNT + SURROUNDINGS_COUNT), np.nan, np.float32)
    describe_shapes(points, ranges, bearings, start, end, spacing, WIDEST_LEG, features)
    describe_surroundings(points, ranges, bearings, start, end, spacing, WIDEST_LEG, features)
    return features
