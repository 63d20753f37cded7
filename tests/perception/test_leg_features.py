"""Features of clusters: known shapes, the reference, mirrored scans, other beam spacings."""

import numpy as np
import pytest
from legs_reference import cluster_features_reference
from tagalong.perception.legs.clusters import cluster_scan
from tagalong.perception.legs.features import FEATURE_NAMES, cluster_features, is_wide
from tagalong.slam import LaserScan


def scan_of(circles=(), walls=(), spacing_deg=0.25, reach=20.0):
    """Return what a laser at the origin sees of circles (x, y, radius) and of walls (x, y, x, y) from end to end."""
    bearings = np.radians(np.arange(-90.0, 90.0 + 1e-9, spacing_deg))
    beams = np.column_stack((np.cos(bearings), np.sin(bearings)))
    met = [np.full(len(bearings), np.inf)]
    for x, y, radius in circles:
        along = beams @ (x, y)
        depth = radius**2 - (x**2 + y**2 - along**2)
        met.append(np.where((depth > 0.0) & (along > 0.0), along - np.sqrt(np.maximum(depth, 0.0)), np.inf))
    for x, y, end_x, end_y in walls:
        dx, dy = end_x - x, end_y - y
        across = beams[:, 0] * dy - beams[:, 1] * dx
        with np.errstate(divide="ignore", invalid="ignore"):
            away, share = (x * dy - y * dx) / across, (x * beams[:, 1] - y * beams[:, 0]) / across
        met.append(np.where((away > 0.0) & (share >= 0.0) & (share <= 1.0), away, np.inf))
    ranges = np.min(met, axis=0)
    return LaserScan(np.where(ranges > reach, np.inf, ranges), bearings, 0.03, reach)


def features_of(scan):
    """Return the clusters of a scan and their features {name: (m,)}."""
    clusters = cluster_scan(scan)
    return clusters, dict(zip(FEATURE_NAMES, cluster_features(scan, clusters).T, strict=True))


def two_legs_before_a_wall(radius=0.06, apart=0.3, distance=2.0, wall=3.0, spacing_deg=0.25):
    legs = [(distance, side * apart, radius) for side in (-0.5, 0.5)]
    return scan_of(legs, [(wall, -8.0, wall, 8.0)], spacing_deg)


def crowded_room(seed):
    """Return a noisy scan of a room of people and furniture, in which some beams know nothing."""
    rng = np.random.default_rng(seed)
    places = rng.uniform((0.5, -4.0), (6.0, 4.0), (8, 2))
    apart = rng.uniform(0.05, 0.35, (8, 2))
    legs = [(*foot, rng.uniform(0.04, 0.09)) for foot in np.concatenate((places, places + apart))]
    boards = [(*start, *(start + rng.uniform(-0.5, 0.5, 2))) for start in rng.uniform((1.0, -4.0), (6.0, 4.0), (8, 2))]
    clean = scan_of(legs, [(7.0, -6.0, 7.0, 6.0), (0.0, -5.0, 7.0, -5.0), *boards], rng.choice([0.25, 0.36, 1.0]))
    ranges = clean.ranges + rng.normal(0.0, 0.01, len(clean))
    ranges[rng.random(len(clean)) < 0.02] = np.nan
    return LaserScan(ranges, clean.bearings, 0.03, 20.0)


def test_a_round_leg_has_the_radius_and_the_width_of_the_circle():
    clusters, features = features_of(two_legs_before_a_wall())
    leg = int(np.flatnonzero(~is_wide(clusters))[0])
    assert features["radius"][leg] == pytest.approx(0.06, rel=0.05)
    assert features["span"][leg] == pytest.approx(0.12, abs=0.02)
    assert features["circle_residual"][leg] < 1e-3
    assert features["bulge"][leg] > 0.02
    assert features["curvature"][leg] > 0.0


def test_a_leg_knows_the_other_leg_and_the_wall_behind_it():
    _, features = features_of(two_legs_before_a_wall())
    legs = np.flatnonzero(features["bulge"] > 0.02)  # not the piece of wall seen between them
    assert len(legs) == 2
    np.testing.assert_allclose(features["mate_distance"][legs], 0.3, atol=0.02)
    np.testing.assert_allclose(features["mate_width_ratio"][legs], 1.0, atol=0.1)
    assert (features["jump_low"][legs] > 0.8).all()
    assert (features["occluded_ends"][legs] == 0).all()


def test_a_board_is_straight_and_a_wall_is_not_described():
    clusters, features = features_of(scan_of(walls=[(2.0, -0.3, 2.0, 0.3), (4.0, -5.0, 4.0, 5.0)]))
    wide = is_wide(clusters)
    assert wide.sum() == 2
    assert np.isnan(features["points"][wide]).all()
    assert features["line_residual"][~wide] == pytest.approx(0.0, abs=1e-5)
    assert features["radius"][~wide] == pytest.approx(0.5)


def test_two_legs_in_one_cluster_have_a_valley():
    clusters, features = features_of(two_legs_before_a_wall(apart=0.14, wall=25.0))
    assert len(clusters) == 1  # 2 cm between the legs, and nothing in range behind them
    assert features["valley"][0] > 0.02


def test_the_features_do_not_know_left_from_right():
    scan = crowded_room(5)
    mirrored = LaserScan(scan.ranges[::-1], -scan.bearings[::-1], scan.range_min, scan.range_max)
    features = cluster_features(scan, cluster_scan(scan))
    again = cluster_features(mirrored, cluster_scan(mirrored))[::-1]
    columns = [i for i, name in enumerate(FEATURE_NAMES) if name not in ASYMMETRIC]
    np.testing.assert_allclose(features[:, columns], again[:, columns], atol=1e-4)


# which of two middle points, where the walk in steps begins, and which of two equal mates: all by beam order
ASYMMETRIC = {"middle_deviation", "boundary", "boundary_regularity", "turning", "curvature"}


def test_lengths_hardly_change_with_the_beam_spacing():
    fine_clusters, fine = features_of(two_legs_before_a_wall(distance=1.5))
    coarse_clusters, coarse = features_of(two_legs_before_a_wall(distance=1.5, spacing_deg=0.5))
    a, b = np.flatnonzero(~is_wide(fine_clusters))[0], np.flatnonzero(~is_wide(coarse_clusters))[0]
    for name in ("span", "width", "deviation", "surface_060", "mate_distance", "beside_mean_low"):
        assert fine[name][a] == pytest.approx(coarse[name][b], abs=0.03), name


@pytest.mark.parametrize("seed", range(6))
def test_the_kernels_say_what_the_reference_says(seed):
    scan = crowded_room(seed)
    clusters = cluster_scan(scan)
    found, expected = cluster_features(scan, clusters), cluster_features_reference(scan, clusters)
    assert found.shape == expected.shape
    for name, a, b in zip(FEATURE_NAMES, found.T, expected.T, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-3, atol=1e-4, err_msg=name)


@pytest.mark.parametrize("ranges", [[], [np.nan] * 4, [np.inf] * 4, [0.0] * 4])
def test_a_scan_without_returns_has_no_features(ranges):
    scan = LaserScan(np.array(ranges), np.linspace(-1.0, 1.0, len(ranges)), 0.1, 10.0)
    assert cluster_features(scan, cluster_scan(scan)).shape == (0, len(FEATURE_NAMES))


def test_points_on_one_spot_give_finite_features():
    scan = LaserScan(np.full(4, 0.1), 1e-9 * np.arange(4), 0.0, 10.0)
    assert np.isfinite(cluster_features(scan, cluster_scan(scan))).all()
