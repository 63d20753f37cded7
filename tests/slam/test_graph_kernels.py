"""The kernels of graph SLAM do what their plain numpy twins do."""

import graph_reference as reference
import numpy as np
import pytest
from pose_graph_reference import normal_equations
from scipy.optimize import minimize
from tagalong.slam.geometry import between, compose, transform_points
from tagalong.slam.graph.loops.blur_kernels import blurred_scores, blurred_scores_reference
from tagalong.slam.local.submap_kernels import insert_scans
from tagalong.slam.pose_graph.normal_equations import block_pattern, fill
from tagalong.slam.pose_graph.pose_graph import PoseGraph
from tagalong.slam.scan_to_grid.correlative import correlate
from tagalong.slam.scan_to_grid.match_kernels import information_in_node
from tagalong.slam.scan_to_grid.refine_kernels import refine_many, refine_pose
from tagalong.slam.scan_to_grid.scan_matcher import far_radius
from tagalong.slam.scan_to_grid.spline_kernels import expand, linearize, misfit
from tagalong.slam.scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter, voxel_first, voxel_mean
from tagalong.slam.search.branch_and_bound import SearchWindow
from tagalong.slam.search.kernels import child_sums, rotated_cells, top_bounds
from tagalong.slam.search.score_pyramid import ScoreGrid, build_pyramid

RESOLUTION, CORNER = 0.05, np.array([-1.5, -1.0])


def walls():
    """Return a field of three walls two cells wide, and points on them seen from the origin."""
    field = np.zeros((60, 80), np.float32)
    field[8:10, 5:70], field[8:50, 68:70], field[45:47, 20:70] = 0.9, 0.8, 0.7
    rows, columns = np.nonzero(field)
    pick = np.arange(0, len(rows), 3)
    return field, CORNER + RESOLUTION * np.stack((columns[pick], rows[pick]), axis=-1)


@pytest.mark.parametrize("share", [0.0005, 0.3])
def test_scores_near_walls_only_are_those_of_a_filter_over_all_cells(share):
    """However walls lie to the blocks that are computed: across their borders and corners, and beside empty ones."""
    rng = np.random.default_rng(2)
    for shape in ((9, 9), (32, 33), (75, 140), (200, 150)):
        field = np.zeros(shape, np.float32)
        inside = field[4:-4, 4:-4]
        inside[:] = rng.random(inside.shape) * (rng.random(inside.shape) < share)
        np.testing.assert_array_equal(blurred_scores(field), blurred_scores_reference(field))


def test_a_lone_wall_is_worth_most_where_it_stands_and_nothing_five_cells_away():
    field = np.zeros((64, 64), np.float32)
    field[31, 32] = 0.5
    scores = blurred_scores(field)
    assert scores[31, 32] == scores.max() == round(255 * 2.5 * 0.5 * 0.3989**2)
    assert not scores[:, 37:].any()
    assert not scores[:27].any()
    assert scores[31, 31] == scores[31, 33] == scores[30, 32] == scores[32, 32] > 0


@pytest.mark.parametrize("kernel", [linearize, expand])
def test_cost_gradient_and_curvature_of_a_scan_are_those_of_numpy(kernel):
    rng = np.random.default_rng(0)
    field = rng.random((60, 80)).astype(np.float32) * (rng.random((60, 80)) < 0.4)
    points = rng.uniform(-3.0, 4.0, (300, 2))  # some beyond the field
    for pose in rng.normal(0.0, 0.3, (5, 3)):
        H, g = np.empty((3, 3)), np.empty(3)
        cost = kernel(field, CORNER, RESOLUTION, points, pose, H, g)
        wanted = reference.expansion(field, CORNER, RESOLUTION, points, pose, kernel is expand)
        np.testing.assert_allclose(cost, wanted[0], rtol=1e-12)
        assert misfit(field, CORNER, RESOLUTION, points, pose) == cost
        np.testing.assert_allclose(g, wanted[1], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(H, wanted[2], rtol=1e-9, atol=1e-6)


def test_the_spline_has_the_slopes_of_numerical_differences():
    rng = np.random.default_rng(1)
    field, cells, step = rng.random((20, 20)).astype(np.float32), rng.uniform(2.0, 17.0, (50, 2)), 1e-5
    _, slope, bend = reference.spline(field, cells)
    for k in range(2):
        plus, minus = (reference.spline(field, cells + sign * step * np.eye(2)[k]) for sign in (1.0, -1.0))
        np.testing.assert_allclose(slope[:, k], (plus[0] - minus[0]) / (2.0 * step), atol=1e-6)
        np.testing.assert_allclose(bend[:, k], (plus[1] - minus[1]) / (2.0 * step), atol=1e-6)


def test_a_refined_pose_is_the_optimum_that_scipy_finds():
    field, points = walls()
    prior, information, weight = np.array([0.02, -0.03, 0.01]), np.diag([50.0, 50.0, 200.0]), 1.5
    pose, curvature, rest, steps = refine_pose(field, CORNER, RESOLUTION, points, prior, prior, information, weight, 20)

    def total(x):
        offset = x - prior
        cost = reference.expansion(field, CORNER, RESOLUTION, points, x, False)[0]
        return weight * cost + 0.5 * offset @ information @ offset

    found = minimize(total, prior, method="Nelder-Mead", options={"xatol": 1e-7, "fatol": 1e-9, "maxiter": 2000})
    np.testing.assert_allclose(pose, found.x, atol=2e-5)
    assert steps < 10
    np.testing.assert_allclose(rest, reference.expansion(field, CORNER, RESOLUTION, points, pose, False)[0])
    H, g = np.empty((3, 3)), np.empty(3)
    linearize(field, CORNER, RESOLUTION, points, pose, H, g)
    np.testing.assert_array_equal(curvature, weight * H)  # of the scan alone, at the pose that is returned


@pytest.mark.parametrize("seed", range(40))
def test_no_step_of_a_match_goes_uphill_not_even_the_last(seed):
    rng = np.random.default_rng(seed)
    field, points = rng.random((60, 80)).astype(np.float32), rng.uniform((-1.0, -0.6), (2.0, 1.5), (2, 2))
    hold, pose, best = 1e-3 * np.eye(3), rng.normal(0.0, 0.05, 3), np.inf  # almost flat where the points bend upwards
    for _ in range(6):
        pose, _, rest, _ = refine_pose(field, CORNER, RESOLUTION, points, pose, np.zeros(3), hold, 1.5, 1, 1e6)
        total = 1.5 * rest + 0.5 * float(pose @ hold @ pose)
        assert total <= best + 1e-12
        best = total


def test_many_scans_at_once_are_found_where_each_alone_is_and_hopeless_ones_stay():
    field, points = walls()
    true = np.array([[0.12, -0.1, 0.05], [0.01, 0.0, 0.0], [0.0, 0.0, 0.0]])
    scans = [transform_points((*(-true[k, :2]), 0.0), points) for k in range(2)] + [points + 40.0]
    scans = [transform_points((0.0, 0.0, -true[k, 2]), scan) for k, scan in enumerate(scans)]
    firsts = np.concatenate(([0], np.cumsum([len(scan) for scan in scans])))
    poses, curvatures, scores = refine_many(
        field, CORNER, RESOLUTION, np.concatenate(scans), firsts, np.zeros((3, 3)), 1.5, 5, 4, 0.75, 0.3
    )
    np.testing.assert_allclose(poses[:2], true[:2], atol=0.01)
    assert (scores[:2] > 0.6).all()
    assert (np.linalg.eigvalsh(curvatures[:2]) > 0.0).all()
    assert (poses[2] == 0.0).all()
    assert scores[2] < 0.01


def test_the_correlative_search_scores_as_numpy_does():
    field, points = walls()
    prior, information = np.array([0.11, -0.16, 0.06]), np.diag([10.0, 10.0, 30.0])
    arguments = (field, CORNER, RESOLUTION, points[::4], prior, information, 1.5, 4, 5, 0.02)
    pose, rest = correlate(*arguments)
    wanted_pose, wanted_rest = reference.correlation(*arguments)
    np.testing.assert_allclose(pose, wanted_pose, atol=1e-12)
    np.testing.assert_allclose(rest, wanted_rest, rtol=1e-5)
    assert np.hypot(*pose[:2]) < 0.08  # the walls are two cells wide


@pytest.mark.parametrize("seed", range(6))
def test_the_correlative_search_weighs_the_prior_with_all_its_correlations(seed):
    rng = np.random.default_rng(seed)
    field, points = rng.random((60, 80)).astype(np.float32), rng.uniform((-1.4, -0.9), (2.3, 1.8), (40, 2))
    root = rng.normal(0.0, 1.0, (3, 3)) * [[8.0], [8.0], [25.0]]
    arguments = (field, CORNER, RESOLUTION, points, np.zeros(3), root @ root.T, 0.3, 3, 4, 0.03)
    pose, rest = correlate(*arguments)
    wanted_pose, wanted_rest = reference.correlation(*arguments)
    np.testing.assert_allclose(pose, wanted_pose, atol=1e-12)
    np.testing.assert_allclose(rest, wanted_rest, rtol=1e-5)


def test_a_scan_is_inserted_as_numpy_does():
    rng = np.random.default_rng(2)
    shape, origin = (60, 80), np.array([31.3, 25.8])
    hits, visits = rng.random(shape).astype(np.float32), np.full(shape, 3.0, np.float32)
    field, stamps = np.zeros(shape, np.float32), np.zeros(shape, np.int16)
    cells = np.column_stack((rng.uniform(2.0, 76.0, 90), rng.uniform(2.0, 56.0, 90)))
    wanted = reference.inserted(hits, visits, origin, cells, 50, 20, 0.5, 0.1)
    sizes = np.array([(91, 50, 20)])
    insert_scans(hits, visits, field, stamps, 6, np.concatenate((origin[None], cells)), sizes, 0.5, 0.1)
    for got, expected in zip((hits, visits, field), wanted, strict=True):
        np.testing.assert_allclose(got, expected, atol=1e-5)


def test_voxels_are_thinned_as_numpy_does_and_four_fifths_of_the_points_lie_within_the_far_radius():
    points = np.random.default_rng(3).normal(0.0, 2.0, (400, 2))
    for edge in (0.1, 0.5, 3.0):
        np.testing.assert_array_equal(voxel_first(points, edge), reference.first_in_voxel(points, edge))
        np.testing.assert_allclose(voxel_mean(points, edge), reference.mean_in_voxel(points, edge), atol=1e-12)
    for count in (1, 2, 77, 400):
        wanted = np.sqrt(np.quantile((points[:count] ** 2).sum(axis=1), 0.8))
        np.testing.assert_allclose(far_radius(points[:count]), wanted)


def test_every_bound_of_the_search_is_the_sum_over_its_block_and_above_all_scores_inside():
    rng = np.random.default_rng(4)
    pyramid = build_pyramid(ScoreGrid(rng.integers(0, 256, (50, 70)).astype(np.uint8), (0.0, 0.0), 0.1), margin=8)
    points, window = rng.uniform(-1.0, 1.0, (40, 2)), SearchWindow(linear=0.7, angular=0.2, angular_step=0.1)
    headings = window.headings(0.3)
    cells = np.empty((len(headings), len(points), 2), np.int32)
    rotated_cells(points, headings, 3.0, 2.0, 0.1, pyramid.border - 7, cells)
    turned = np.stack([transform_points((3.0, 2.0, heading), points) for heading in headings])
    np.testing.assert_array_equal(cells, np.floor(turned[:, :, ::-1] / 0.1).astype(int) + pyramid.border - 7)
    bounds, leaves = top_bounds(pyramid.phases, pyramid.skirt, pyramid.border, cells, 2), pyramid.levels[0]
    for k, a, b in np.ndindex(len(headings), 2, 2):
        rows, columns = (cells[k] + [8 * a, 8 * b]).T
        assert bounds[k, a, b] == pyramid.levels[3][rows, columns].astype(int).sum()
        inside, sums = [], np.empty(4, np.int64)
        for i, j in np.ndindex(4, 4):
            child_sums(leaves, cells[k], 8 * a + 2 * i, 8 * b + 2 * j, 1, sums)
            inside += sums.tolist()
        assert inside[0] == leaves[rows, columns].astype(int).sum()
        assert max(inside) <= bounds[k, a, b]


def test_sums_of_children_count_what_lies_outside_as_nothing():
    rng = np.random.default_rng(6)
    level, cells = rng.integers(1, 256, (9, 12)).astype(np.uint8), rng.integers(-6, 16, (500, 2)).astype(np.int32)
    sums = np.empty(4, np.int64)
    for i, j, half in ((0, 0, 1), (2, -3, 4), (-2, 5, 2)):
        child_sums(level, cells, i, j, half, sums)
        for child, got in enumerate(sums.tolist()):
            at = cells + np.array([i + (child >> 1) * half, j + (child & 1) * half])
            at = at[((at >= 0) & (at < level.shape)).all(axis=1)]
            assert got == level[at[:, 0], at[:, 1]].astype(int).sum()


@pytest.mark.parametrize("reach", [0, 1, 5, 9])
def test_the_correlative_search_of_any_window_scores_as_numpy_does_at_the_fields_edges_too(reach):
    rng = np.random.default_rng(reach)
    field, points = rng.random((23, 31)).astype(np.float32), rng.uniform(-1.5, 3.0, (60, 2))
    prior, information = np.array([0.05, 0.1, 0.4]), np.diag([3.0, 3.0, 9.0])
    arguments = (field, CORNER, RESOLUTION, points, prior, information, 1.0, reach, 3, 0.05)
    pose, rest = correlate(*arguments)
    wanted_pose, wanted_rest = reference.correlation(*arguments)
    np.testing.assert_allclose(pose, wanted_pose, atol=1e-12)
    np.testing.assert_allclose(rest, wanted_rest, rtol=1e-5)


def test_the_normal_equations_are_those_of_numpy():
    rng = np.random.default_rng(5)
    n, m = 12, 30
    poses = rng.normal(0.0, 1.5, (n, 3))
    i = rng.integers(0, n, m)
    edges = np.stack((i, (i + rng.integers(1, n, m)) % n), axis=-1).astype(np.int64)
    z = compose(between(poses[edges[:, 0]], poses[edges[:, 1]]), rng.normal(0.0, 0.2, (m, 3)))
    root = rng.normal(0.0, 1.0, (m, 3, 3)) + 4.0 * np.eye(3)
    graph = PoseGraph(poses, edges, z, root @ root.swapaxes(1, 2), np.where(np.arange(m) % 2, 2.0, np.inf))
    pattern = block_pattern(n, edges)
    data, gradient = np.empty(len(pattern.indices)), np.empty(3 * n)
    cost = fill(
        graph.poses, graph.edges, graph.measurements, graph.information, graph.kernel_width, 3,
        pattern.place, pattern.base, pattern.stride, pattern.edge_blocks, data, gradient,
    )  # fmt: skip
    dense = np.zeros((3 * n, 3 * n))
    for column in range(3 * n):
        part = slice(pattern.indptr[column], pattern.indptr[column + 1])
        dense[pattern.indices[part], column] = data[part]
    rows = (3 * pattern.place[:, None] + np.arange(3)).ravel()
    wanted_cost, wanted_gradient, wanted_H = normal_equations(graph, 3)
    np.testing.assert_allclose(cost, wanted_cost)
    np.testing.assert_allclose(gradient[rows], wanted_gradient.ravel(), atol=1e-9)
    np.testing.assert_allclose(dense[np.ix_(rows, rows)], wanted_H, atol=1e-9)


def test_points_out_of_range_are_dropped_and_the_others_keep_their_order():
    points = np.random.default_rng(2).uniform(-6.0, 6.0, (150, 2))
    kept = AdaptiveVoxelFilter(AdaptiveVoxelConfig(max_range=4.0)).apply(points)
    np.testing.assert_array_equal(kept, points[np.hypot(*points.T) <= 4.0])
    assert 0 < len(kept) < 150


@pytest.mark.parametrize("seed", range(5))
def test_the_information_of_a_match_is_what_numpy_makes_of_its_curvature(seed):
    rng = np.random.default_rng(seed)
    root, heading, sigma = 30.0 * rng.normal(0.0, 1.0, (3, 3)), rng.uniform(-3.0, 3.0), (0.01, 0.003)
    c, s = np.cos(heading), np.sin(heading)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    H = R.T @ (0.02 * root @ root.T) @ R + 1e-3 * np.eye(3)
    wanted = np.linalg.inv(np.linalg.inv(H) + np.diag(np.array([sigma[0], sigma[0], sigma[1]]) ** 2))
    np.testing.assert_allclose(information_in_node(root @ root.T, heading, sigma), wanted, rtol=1e-6, atol=1e-6)
