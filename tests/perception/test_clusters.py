"""Clusters of scans with known answers."""

import numpy as np
import pytest
from clusters_reference import split_by_distance_reference
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tagalong.perception.legs.clusters import cluster_scan, split_by_distance
from tagalong.slam import InputError, LaserScan

BEARINGS = np.radians(np.arange(-90.0, 91.0, 1.0))


def scan_of(ranges):
    return LaserScan(np.asarray(ranges, float), BEARINGS[: len(ranges)], 0.1, 10.0)


def test_a_leg_before_a_wall_is_a_cluster_of_its_own():
    ranges = np.full(181, 3.0)
    ranges[88:93] = 2.0
    clusters = cluster_scan(scan_of(ranges))
    np.testing.assert_array_equal(clusters.start, [0, 88, 93])
    np.testing.assert_array_equal(clusters.end, [88, 93, 181])
    np.testing.assert_allclose(clusters.centres[1], clusters.points[88:93].mean(axis=0))


def test_two_points_are_too_few_and_three_are_enough():
    ranges = np.full(20, np.inf)
    ranges[2:4] = 1.0
    ranges[14:17] = 1.0
    clusters = cluster_scan(scan_of(ranges))
    np.testing.assert_array_equal(clusters.beams[clusters.start], [14])
    np.testing.assert_array_equal(clusters.sizes, [3])


def test_a_lost_beam_does_not_split_a_cluster_but_distance_does():
    ranges = np.full(9, 1.0)
    ranges[4] = np.nan
    assert len(cluster_scan(scan_of(ranges))) == 1
    ranges[5:] = 1.2
    assert len(cluster_scan(scan_of(ranges))) == 2


@pytest.mark.parametrize("ranges", [[], [np.nan] * 5, [np.inf] * 5, [0.0] * 5, [1.0]])
def test_a_scan_without_enough_returns_has_no_clusters(ranges):
    clusters = cluster_scan(scan_of(ranges))
    assert len(clusters) == 0
    assert clusters.centres.shape == (0, 2)


def test_a_distance_or_a_count_that_is_not_positive_is_refused():
    with pytest.raises(InputError, match="alpha"):
        cluster_scan(scan_of([1.0]), alpha=0.0)
    with pytest.raises(InputError, match="beta"):
        cluster_scan(scan_of([1.0]), beta=0)


def test_far_away_as_many_points_are_enough_as_a_leg_gets_beams():
    """At 1 degree a leg of 12 cm gets 3 beams up to 2.3 m, and 2 beyond."""
    for distance, beta_3, by_spacing in ((1.5, 0, 0), (2.6, 0, 1), (8.0, 0, 1)):
        ranges = np.full(20, np.inf)
        ranges[5:7] = distance
        wide = scan_of(ranges)
        assert len(cluster_scan(wide, alpha=0.3)) == beta_3
        assert len(cluster_scan(wide, alpha=0.3, far_width=0.12)) == by_spacing
    ranges[6] = np.inf
    assert len(cluster_scan(scan_of(ranges), alpha=0.3, far_width=0.12)) == 0
    with pytest.raises(InputError, match="far_width"):
        cluster_scan(scan_of([1.0]), far_width=-0.1)


@settings(deadline=None)  # the kernel may have to be compiled first
@given(
    arrays(float, st.tuples(st.integers(0, 40), st.just(2)), elements=st.floats(-1.0, 1.0)),
    st.integers(1, 4),
    st.sampled_from([0.0, 1.5, 2.5]),
)
def test_the_kernel_splits_as_the_reference_does(points, beta, beams_at_1m):
    points = np.ascontiguousarray(np.round(points, 2))
    arguments = (points, 0.3, beta, beams_at_1m)
    for found, expected in zip(split_by_distance(*arguments), split_by_distance_reference(*arguments), strict=True):
        np.testing.assert_array_equal(found, expected)
