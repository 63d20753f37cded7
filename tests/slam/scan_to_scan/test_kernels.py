"""The numba kernels do what their plain references do."""

import numpy as np
import pytest
from scan_to_scan_reference import (
    lookup_fitness_reference,
    mark_unseen_reference,
    nearest_point_reference,
    polar_fitness_reference,
)
from tagalong.slam.geometry import compose, inverse, transform_points
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_scan.fitness import lookup_fitness, polar_fitness
from tagalong.slam.scan_to_scan.lookup import LookupConfig, build_lookup
from tagalong.slam.scan_to_scan.nearest import bin_near, metric_square, nearest_point
from tagalong.slam.scan_to_scan.registration import LINE, METRIC, POINT, correspond, normal_equations, segment_target
from tagalong.slam.scan_to_scan.surfaces import SurfaceConfig, find_surfaces, fit_lines, noise_of, relined
from tagalong.slam.scan_to_scan.symmetric import inverse_pose
from tagalong.slam.scan_to_scan.visibility import agreement, mark_unseen


def random_surfaces(rng, fov):
    bearings = np.linspace(-fov / 2, fov / 2, 120, endpoint=False)
    ranges = 3.0 + np.sin(3 * bearings) + rng.normal(0, 0.3, 120)
    ranges[rng.random(120) < 0.2] = np.inf
    return find_surfaces(LaserScan(ranges, bearings, 0.1, 10.0), SurfaceConfig())


@pytest.mark.parametrize("fov", [np.pi, 1.5 * np.pi, 2 * np.pi])
@pytest.mark.parametrize("lever", [np.inf, 3.0, 0.5])
def test_the_nearest_point_along_the_beams_is_the_nearest_of_all(fov, lever):
    rng = np.random.default_rng(0)
    surfaces = random_surfaces(rng, fov)
    for x, y in rng.normal(0, 3, (300, 2)):
        k = 1.0 if lever == np.inf else lever**2 / (x * x + y * y + lever**2)
        limit = rng.choice([0.04, 1.0, 400.0])
        got = nearest_point(x, y, k, surfaces.points, surfaces.rays, surfaces.first, limit)
        expected = nearest_point_reference(x, y, k, surfaces.points, limit)
        assert got[0] == expected[0]
        np.testing.assert_allclose(got[1], expected[1], rtol=1e-9)
        hint = int(rng.integers(len(surfaces)))
        hinted = nearest_point(x, y, k, surfaces.points, surfaces.rays, surfaces.first, limit, hint)
        assert hinted == got


def test_the_quick_bin_of_a_bearing_is_the_right_one_or_one_beside_it():
    bearings = np.random.default_rng(2).uniform(-np.pi, np.pi, 2000)
    for bearing in (*bearings.tolist(), -np.pi, 0.0, np.pi / 2, 3.14159):
        exact = int((bearing + np.pi) * 1024 / (2.0 * np.pi))
        apart = abs(bin_near(2.5 * np.cos(bearing), 2.5 * np.sin(bearing)) - exact)
        assert min(apart, 1024 - apart) <= 1
    assert 0 <= bin_near(0.0, 0.0) < 1024


@pytest.mark.parametrize("noise", [0.0, 0.005, 0.03])
def test_the_noise_of_a_scan_is_that_of_its_smooth_part(noise):
    rng = np.random.default_rng(3)
    bearings = np.radians(np.arange(-90.0, 90.0))
    ranges = 2.0 / np.maximum(np.abs(np.sin(bearings)), 0.3) + rng.normal(0.0, noise, 180)
    ranges[:60] += rng.uniform(0.0, 0.4, 60)  # a hedge
    found = noise_of(find_surfaces(LaserScan(ranges, bearings, 0.05, 20.0), SurfaceConfig(obliquity=3.0)))
    assert abs(found - noise) < 0.5 * noise + 0.001


@pytest.mark.parametrize("even", [False, True])
def test_lines_are_those_of_the_points_around_each_point(even):
    surfaces = random_surfaces(np.random.default_rng(4), 2 * np.pi)
    _, normals, _ = fit_lines(surfaces.points, surfaces.linked, 3, 9.0, even)
    count = len(surfaces)
    for m in range(count):
        behind = next((n for n in range(3) if not surfaces.linked[m - n - 1]), 3)
        ahead = next((n for n in range(3) if not surfaces.linked[(m + n) % count]), 3)
        behind, ahead = (min(behind, ahead),) * 2 if even else (behind, ahead)
        points = surfaces.points[np.arange(m - behind, m + ahead + 1) % count]
        if len(points) < 2:
            assert not normals[m].any()
            continue
        _, vectors = np.linalg.eigh(np.cov(points.T, bias=True))
        assert abs(abs(normals[m] @ vectors[:, 0]) - 1.0) < 1e-9


def test_the_gaussian_table_is_the_highest_gaussian_of_all_points():
    points = np.random.default_rng(1).uniform(-2, 2, (40, 2))
    config = LookupConfig()
    grid = build_lookup(points, config)
    rows, cols = grid.values.shape
    x = grid.origin[0] + (np.arange(cols) + 0.5) * grid.resolution
    y = grid.origin[1] + (np.arange(rows) + 0.5) * grid.resolution
    square = ((x[None, :, None] - points[:, 0]) ** 2 + (y[:, None, None] - points[:, 1]) ** 2).min(axis=-1)
    expected = np.where(square <= config.radius**2, 255 * np.exp(-0.5 * square / config.sigma**2), 0.0)
    assert np.abs(grid.values - expected).max() <= 0.5 + 1e-6


def test_the_binary_table_is_a_square_around_each_point():
    grid = build_lookup(np.array([[0.051, 0.052]]), LookupConfig(pattern="square"))
    assert set(np.unique(grid.values)) == {0, 255}
    assert (grid.values > 0).sum() == 16


def test_a_population_is_scored_as_one_by_one():
    rng = np.random.default_rng(2)
    points, poses = rng.normal(0, 2, (70, 2)), rng.normal(0, 1.5, (50, 3))
    grid = build_lookup(rng.normal(0, 2, (80, 2)), LookupConfig())
    fitness = np.empty(50)
    lookup_fitness(poses, points, grid.values, *grid.origin, grid.resolution, fitness)
    np.testing.assert_allclose(fitness, lookup_fitness_reference(poses, points, grid), atol=1e-12)
    ranges = np.where(rng.random(181) < 0.1, np.nan, rng.uniform(1, 4, 181))
    settings = (ranges, -np.pi / 2, np.pi / 180, 0.5)
    polar_fitness(poses, points, *settings, fitness)
    np.testing.assert_allclose(fitness, polar_fitness_reference(poses, points, *settings), atol=1e-12)


@pytest.mark.parametrize("k", [1.0, 0.6, 0.2])
@pytest.mark.parametrize("linked", [(True, True), (True, False), (False, True), (False, False)])
def test_the_target_on_the_segments_beside_a_point_is_the_nearest_of_all_on_them(k, linked):
    rng, links = np.random.default_rng(7), np.array([*linked, False])
    for _ in range(20):
        points = np.array([2.0, 0.5]) + rng.normal(0.0, 0.3, (3, 2))
        x, y = points[1] + rng.normal(0.0, 0.3, 2)
        shares = np.linspace(0.0, 1.0, 2001)[:, None]
        others = [points[other] for other, link in ((0, linked[0]), (2, linked[1])) if link]
        near = np.vstack([points[1:2], *(points[1] + shares * (other - points[1]) for other in others)])
        squares = np.array([metric_square(u - x, v - y, x, y, k) for u, v in near])
        target = segment_target(x, y, k, 1, points, links)
        assert metric_square(target[0] - x, target[1] - y, x, y, k) == pytest.approx(squares.min(), abs=1e-5)
        np.testing.assert_allclose(target, near[squares.argmin()], atol=3e-3)


@pytest.mark.parametrize(("kind", "lever"), [(POINT, np.inf), (LINE, np.inf), (METRIC, 3.0)])
def test_the_step_is_the_gradient_of_what_is_minimised(kind, lever):
    rng = np.random.default_rng(3)
    surfaces = random_surfaces(rng, 2 * np.pi)
    points = transform_points([0.05, -0.03, 0.04], surfaces.points + rng.normal(0, 0.01, surfaces.points.shape))
    index, square, moved = np.empty(len(points), np.int32), np.empty(len(points)), np.empty((len(points), 2))
    system = np.empty((3, 4))
    pose = np.array([0.02, 0.01, -0.03])
    correspond(points, pose, lever, surfaces.arrays, 1.0, index, square, moved)
    normal_equations(kind, pose, lever, surfaces.arrays, 1e6, index, moved, system)
    gradient = np.empty(3)
    scratch = np.empty((3, 4))
    for gene in range(3):
        sums = []
        for sign in (1, -1):
            moved_pose = pose.copy()
            moved_pose[gene] += sign * 1e-5
            cos, sin = np.cos(moved_pose[2]), np.sin(moved_pose[2])
            shifted = points @ np.array([[cos, sin], [-sin, cos]]) + moved_pose[:2]
            sums.append(normal_equations(kind, moved_pose, lever, surfaces.arrays, 1e6, index, shifted, scratch)[1])
        gradient[gene] = -0.5 * (sums[0] - sums[1]) / 2e-5
    # MbICP holds its metric still within a step, so its gradient is right to first order in the distance only.
    scale = np.abs(system[:, 3]).max()
    np.testing.assert_allclose(system[:, 3], gradient, atol=(0.15 if kind == METRIC else 1e-3) * scale)


def test_the_inverse_pose_and_its_derivative():
    pose, inverted, jacobian = np.array([0.4, -0.7, 1.1]), np.empty(3), np.empty((3, 3))
    inverse_pose(pose, inverted, jacobian)
    np.testing.assert_allclose(inverted, inverse(pose), atol=1e-12)
    np.testing.assert_allclose(compose(pose, inverted), 0.0, atol=1e-12)
    numeric = [(inverse(pose + d) - inverse(pose - d)) / 2e-6 for d in np.eye(3) * 1e-6]
    np.testing.assert_allclose(jacobian, np.array(numeric).T, atol=1e-6)


def ring(radius, pillars=()):
    """What a laser in the middle of a round room sees, with `pillars` = (bearing, range) one beam wide."""
    bearings = np.radians(np.arange(-180.0, 180.0))
    ranges = np.full(360, radius)
    for bearing, distance in pillars:
        ranges[int(bearing) + 180] = distance
    return find_surfaces(LaserScan(ranges, bearings, 0.05, 20.0), SurfaceConfig())


def test_points_in_seen_free_space_contradict_by_how_far_they_stand_in_it():
    seen = ring(4.0)
    arrays = (seen.points, seen.rays, seen.feet, seen.normals, seen.first)
    for distance, expected in (
        (4.0, (1.0, 0.0)),
        (3.75, (0.04, 0.25)),
        (3.5, (0.0, 1.5)),
        (1.0, (0.0, 2.0)),
        (6.0, (0, 0)),
    ):
        points = transform_points([0.0, 0.0, 0.3], seen.points * (distance / 4.0))
        hits, contradictions, most = agreement(points, np.array([0.0, 0.0, -0.3]), *arrays, 0.1, 0.3)
        np.testing.assert_allclose((hits / most, contradictions / most), expected, atol=0.02)


def test_a_point_counts_its_range_whether_it_hits_or_contradicts():
    seen = ring(4.0)
    arrays = (seen.points, seen.rays, seen.feet, seen.normals, seen.first)
    points = np.array([[4.0, 0.0], [0.0, 1.0], [-2.0, 0.0]])  # on the wall, and 3 m and 2 m before it
    hits, contradictions, most = agreement(points, np.zeros(3), *arrays, 0.1, 0.3)
    np.testing.assert_allclose((hits, contradictions, most), (4.0, 1.0 * 2.0 + 2.0 * 2.0, 7.0), atol=0.02)


def test_only_what_the_reference_saw_to_be_free_stays_worth_nothing():
    seen = ring(3.0)
    keep = seen.points[:, 1] < 1e-9  # nothing is known of the upper half
    half = find_surfaces(LaserScan(np.full(181, 3.0), np.radians(np.arange(-180.0, 1.0)), 0.05, 20.0), SurfaceConfig())
    assert keep.sum() == len(half)
    values = np.zeros((100, 100), dtype=np.uint8)
    values[0, 0] = 255
    mark_unseen(half.points, half.rays, -5.0, -5.0, 0.1, 0.3, np.uint8(200), values)
    x, y = np.meshgrid(*(np.arange(-4.95, 5.0, 0.1),) * 2)
    distance, angle = np.hypot(x, y), np.degrees(np.arctan2(y, x))
    assert values[0, 0] == 255
    assert (values[(distance < 2.65) & (angle < -3) & (angle > -177)] == 0).all()
    unseen = (distance > 2.75) | ((angle > 6) & (angle < 174))
    unseen[0, 0] = False
    assert (values[unseen] == 200).all()


@pytest.mark.parametrize("fov", [np.pi, 1.5 * np.pi, 2 * np.pi])
def test_cells_are_marked_as_by_looking_at_every_beam(fov):
    rng = np.random.default_rng(5)
    seen = random_surfaces(rng, fov)
    values, expected = (np.full((70, 90), 10, dtype=np.uint8) for _ in range(2))
    mark_unseen(seen.points, seen.rays, -4.537, -3.461, 0.1, 0.3, np.uint8(200), values)
    mark_unseen_reference(seen.points, -4.537, -3.461, 0.1, 0.3, 200, expected)
    np.testing.assert_array_equal(values, expected)


def test_lines_fitted_anew_are_those_of_a_new_chain_of_points():
    scan = LaserScan(3.0 + np.sin(np.arange(200) / 9.0), np.linspace(-3.1, 3.0, 200), 0.1, 10.0)
    config = SurfaceConfig(neighbours=10, tolerance=0.06, even=True)
    again, new = relined(find_surfaces(scan, SurfaceConfig()), config), find_surfaces(scan, config)
    for one, other in zip(again.arrays, new.arrays, strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(again.tilt_variance, new.tilt_variance)
    edges = np.linspace(-np.pi, np.pi, len(new.first), endpoint=False)
    np.testing.assert_array_equal(new.first, np.searchsorted(scan.bearings, edges))
