"""What a cluster and its surroundings look like, in numbers that do not depend on the left and right of the scan.

The shape of a cluster after Arras, Mozos, Burgard, "Using boosted features for the detection of people in 2D range
data", ICRA 2007, and Leigh, Pineau, Olmedo, Zhang, "Person tracking and following with 2D laser scanners", ICRA 2015;
its surroundings (range jumps, what stands beside and behind, the cluster that could be the other leg) are our own.
Lengths are in metres and counts are turned into lengths where that is possible, so that scanners with other beam
spacings give like numbers.
"""

import numpy as np
from numpy.typing import NDArray

from ...slam.scan import LaserScan
from .clusters import Clusters
from .detection_kernel import are_wide, described

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

SHAPE_NAMES = (
    "points",  # number of returns
    "range",  # distance of the mean point from the laser
    "expected_points",  # returns that a leg 0.12 m wide would give at this range
    "span",  # angle covered times range
    "width",  # first to last point
    "depth",  # extent along the line of sight
    "fill",  # share of the beams between the ends that gave a return
    "deviation",  # root mean square distance from the mean point
    "middle_deviation",  # mean distance from the middle point of the cluster
    "line_residual",  # root mean square distance from the best line
    "elongation",  # short over long principal axis
    "radius",  # of the best circle (Kasa), at most 0.5 m
    "circle_residual",  # root mean square distance from that circle
    "bulge",  # mean distance of inner points from the chord, positive towards the laser
    "bulge_ratio",  # bulge over width
    "boundary",  # length of the outline walked in steps of about 3 cm
    "boundary_regularity",  # standard deviation of these steps
    "turning",  # mean absolute angle between successive steps
    "curvature",  # mean signed angle between successive steps over the step, positive when convex to the laser
    "inscribed_angle",  # mean angle under which inner points see the two ends
    "inscribed_angle_deviation",  # its standard deviation
    "tilt",  # |cosine| of the angle between the long axis and the line of sight
    "largest_step",  # largest range difference between successive points
    "roughness",  # root mean square second difference of the ranges
    "valley",  # how much farther the middle reaches than the nearest points on both sides: two legs in one cluster
)
SURROUNDINGS_NAMES = (
    "jump_low",  # range jump just beyond the ends, positive where the neighbour is farther: the smaller of both ends
    "jump_high",  # the larger one
    "gap_low",  # distance from an end to the next return beyond it: the smaller
    "gap_high",  # the larger
    "occluded_ends",  # number of ends beside something nearer
    "beside_mean_low",  # mean clipped range difference over 0.3 m beside an end: the smaller
    "beside_mean_high",  # the larger
    "beside_min_low",  # smallest clipped range difference over 0.3 m beside an end: the smaller
    "beside_min_high",  # the larger
    "far_beside_low",  # mean clipped range difference 0.3 to 0.8 m beside an end: the smaller
    "far_beside_high",  # the larger
    "surface_030",  # length of other surface within 0.3 m of the mean point
    "surface_060",  # between 0.3 and 0.6 m
    "surface_120",  # between 0.6 and 1.2 m
    "in_line",  # length of other surface within 1.2 m that the cluster's line passes at less than 5 cm
    "before_wall",  # distance before (+) or behind (-) the line through the surfaces on both sides; 1 without them
    "mate_distance",  # centre distance of the cluster that could be the other leg; 1 without one
    "mate_gap",  # distance between the nearest ends
    "mate_width_ratio",  # narrower over wider
    "mate_range_difference",  # |range difference| of the mean points
    "mate_width",
    "mate_bulge",
    "mate_line_residual",
    "mate_jump_low",
    "mate_beside_high",  # its `beside_mean_high`
    "clusters_050",  # number of other clusters within 0.5 m
    "clusters_100",  # within 1 m
    "second_distance",  # distance of the second nearest cluster, at most 2 m
)
FEATURE_NAMES = SHAPE_NAMES + SURROUNDINGS_NAMES


def cluster_features(scan: LaserScan, clusters: Clusters) -> NDArray[np.float32]:
    """Return (m, len(FEATURE_NAMES)) features of the clusters of `scan`; a row of NaN where `is_wide`."""
    return described(*described_by(scan, clusters))


def described_by(scan: LaserScan, clusters: Clusters) -> tuple[Array, Array, Array, Rows, Rows, float]:
    """Return what kernels describe the clusters of `scan` by: the first arguments of `leg_confidence`."""
    ranges, bearings = scan.ranges[clusters.beams], scan.bearings[clusters.beams]
    return clusters.points, ranges, bearings, clusters.start, clusters.end, beam_spacing(scan)


def is_wide(clusters: Clusters) -> NDArray[np.bool_]:
    """(m,) whether the ends of a cluster are farther apart than `WIDEST_LEG`: walls, which nobody has to classify."""
    return are_wide(clusters.points, clusters.start, clusters.end)


def beam_spacing(scan: LaserScan) -> float:
    """Return the mean angle between neighbouring beams [rad]."""
    if len(scan) == 0:
        return 1e-3
    return float((scan.bearings[-1] - scan.bearings[0]) / max(len(scan) - 1, 1)) or 1e-3
