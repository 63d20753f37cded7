"""Features of clusters: known shapes, the reference, mirrored scans, other beam spacings."""

import numpy as np
import pytest
from legs_reference import cluster_features_reference
from tagalong.envs.simulation2d.outlines import LEG, Outlines
from tagalong.perception.legs.clusters import cluster_scan
from tagalong.perception.legs.features import FEATURE_NAMES, cluster_features, is_wide
from tagalong.scripts.training.leg_scans import Scanner, draw_scan, take_scan
from tagalong.slam import LaserScan


def perfect_scanner(spacing_deg=0.25):
    bearings = np.radians(np.arange(-90.0, 90.0 + 1e-9, spacing_deg))
    faults = {"noise": 0.0, "quantum": 1e-6, "mixed": 0.0, "divergence": 1e-3, "lost": 0.0, "nothing": np.inf}
    return Scanner(bearings=bearings, range_min=0.03, range_max=20.0, smoothing=0, grazing=1e9, dark=0.0, **faults)


def features_of(outlines, spacing_deg=0.25):
    """Scan without faults; (clusters, {name: (m,)})."""
    rng = np.random.default_rng(0)
    scan = take_scan(rng, perfect_scanner(spacing_deg), outlines, 0.0, speed=0.0).scan
    clusters = cluster_scan(scan)
    return clusters, dict(zip(FEATURE_NAMES, cluster_features(scan, clusters).T, strict=True))


def two_legs_before_a_wall(radius=0.06, apart=0.3, distance=2.0, wall=3.0):
    outlines = Outlines()
    for side in (-0.5, 0.5):
        outlines.ellipse(np.array([distance, side * apart]), radius, radius, kind=LEG)
    outlines.segment(np.array([wall, -8.0]), np.array([wall, 8.0]))
    return outlines


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
    board = Outlines()
    board.segment(np.array([2.0, -0.3]), np.array([2.0, 0.3]))
    board.segment(np.array([4.0, -5.0]), np.array([4.0, 5.0]))
    clusters, features = features_of(board)
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
    scan = draw_scan(np.random.default_rng(5)).scan
    mirrored = LaserScan(scan.ranges[::-1], -scan.bearings[::-1], scan.range_min, scan.range_max)
    features = cluster_features(scan, cluster_scan(scan))
    again = cluster_features(mirrored, cluster_scan(mirrored))[::-1]
    columns = [i for i, name in enumerate(FEATURE_NAMES) if name not in ASYMMETRIC]
    np.testing.assert_allclose(features[:, columns], again[:, columns], atol=1e-4)


# which of two middle points, where the walk in steps begins, and which of two equal mates: all by beam order
ASYMMETRIC = {"middle_deviation", "boundary", "boundary_regularity", "turning", "curvature"}


def test_lengths_hardly_change_with_the_beam_spacing():
    fine_clusters, fine = features_of(two_legs_before_a_wall(distance=1.5), 0.25)
    coarse_clusters, coarse = features_of(two_legs_before_a_wall(distance=1.5), 0.5)
    a, b = np.flatnonzero(~is_wide(fine_clusters))[0], np.flatnonzero(~is_wide(coarse_clusters))[0]
    for name in ("span", "width", "deviation", "surface_060", "mate_distance", "beside_mean_low"):
        assert fine[name][a] == pytest.approx(coarse[name][b], abs=0.03), name


@pytest.mark.parametrize("seed", range(6))
def test_the_kernels_say_what_the_reference_says(seed):
    scan = draw_scan(np.random.default_rng(seed)).scan
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
