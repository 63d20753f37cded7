"""The branch and bound finds what trying every pose finds."""

import numba
import numpy as np
import pytest
from search_reference import add_lanes_reference
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import inverse, transform_points, wrap_angle
from tagalong.slam.search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from tagalong.slam.search.exhaustive import exhaustive_search, scores_at
from tagalong.slam.search.lanes import add_lanes
from tagalong.slam.search.score_pyramid import ScoreGrid, build_pyramid


def grid_of(points, resolution=0.1, sigma=0.2):
    """Gaussian bumps around points, by brute force."""
    low = points.min(axis=0) - 1.0
    cols, rows = np.ceil((points.max(axis=0) + 1.0 - low) / resolution).astype(int)
    x, y = low[0] + (np.arange(cols) + 0.5) * resolution, low[1] + (np.arange(rows) + 0.5) * resolution
    square = np.min((x[None, :, None] - points[:, 0]) ** 2 + (y[:, None, None] - points[:, 1]) ** 2, axis=-1)
    return ScoreGrid.from_likelihood(np.exp(-0.5 * square / sigma**2), (float(low[0]), float(low[1])), resolution)


def room(rng, n=60):
    """Points on the walls of an oblong with a niche."""
    t = rng.uniform(0, 1, n)
    walls = np.array([[0, 0, 5, 0], [5, 0, 5, 3], [5, 3, 2, 3], [2, 3, 2, 4], [2, 4, 0, 4], [0, 4, 0, 0]], float)
    wall = walls[rng.integers(len(walls), size=n)]
    return wall[:, :2] + t[:, None] * (wall[:, 2:] - wall[:, :2]) - [2.0, 1.5]


@pytest.mark.parametrize("seed", range(12))
def test_it_equals_the_exhaustive_search_to_the_bit(seed):
    rng = np.random.default_rng(seed)
    grid = grid_of(room(rng), resolution=float(rng.choice([0.05, 0.1, 0.25])))
    scan = rng.normal(0, 2, (int(rng.integers(1, 40)), 2)) if seed % 3 == 0 else room(rng)
    centre = rng.uniform([-2, -2, -3], [2, 2, 3])
    window = SearchWindow(linear=float(rng.uniform(0, 1.3)), angular=[0.5, 3.2][seed % 2], angular_step=0.11)
    least = 0.3 if seed % 4 == 0 else 0.0
    expected = exhaustive_search(grid, scan, centre, window, min_score=least)
    for top_level, margin in ((0, 0), (2, 0), (3, 30)):
        pyramid = build_pyramid(grid, top_level=top_level, margin=margin)
        found = branch_and_bound(pyramid, scan, centre, window, min_score=least)
        assert found.maxima == expected.maxima
        assert found.candidates == expected.candidates


@pytest.mark.parametrize(("top_level", "half"), [(0, 3), (1, 10), (3, 30)])
def test_where_the_margin_is_half_a_window_a_window_that_meets_the_grid_is_read_whole(top_level, half):
    pyramid = build_pyramid(
        ScoreGrid(np.full((21, 34), 9, np.uint8), (0.0, 0.0), 0.1), top_level=top_level, margin=half
    )
    stride, side = 1 << top_level, 2 * half + 1
    blocks = -(-side // stride)
    _, _, rows, cols = pyramid.phases.shape
    for size, whole, read in ((21, rows, blocks), (34, cols, -(-blocks // 16) * 16)):
        for cell in (
            1 - side,
            size - 1,
        ):  # where the lowest pose of the window puts a point that other poses put inside
            first = ((cell + pyramid.border) >> top_level) + pyramid.skirt
            assert 0 <= first <= whole - read


def test_it_equals_the_exhaustive_search_where_many_poses_tie():
    values = np.zeros((40, 40), dtype=np.uint8)
    values[10:30] = 200
    grid = ScoreGrid(values, (0.0, 0.0), 0.1)
    window = SearchWindow(linear=0.7, angular=0.3, angular_step=0.1)
    found = branch_and_bound(build_pyramid(grid, top_level=2), [[0.03, 0.04]], (2.0, 2.0, 0.0), window)
    assert found.maxima == exhaustive_search(grid, [[0.03, 0.04]], (2.0, 2.0, 0.0), window).maxima
    assert found.maxima[0].pose == (2.0, 2.0, 0.0)


def test_more_than_256_points_do_not_overflow():
    rng = np.random.default_rng(3)
    grid = ScoreGrid(np.full((60, 60), 255, dtype=np.uint8), (0.0, 0.0), 0.1)
    found = branch_and_bound(
        build_pyramid(grid),
        rng.uniform(-0.5, 0.5, (900, 2)),
        (3, 3, 0),
        SearchWindow(linear=0.4, angular=0.1, angular_step=0.1),
    )
    assert found.maxima[0].score == 1.0


def test_a_moved_scan_is_found_within_a_cell_and_a_step():
    rng = np.random.default_rng(1)
    walls = room(rng, 200)
    truth = np.array([0.83, -0.61, 2.4])
    scan = transform_points(inverse(truth), walls[::2])
    window = SearchWindow(linear=2.0, angular=np.pi, angular_step=np.radians(2.0))
    best = branch_and_bound(build_pyramid(grid_of(walls), margin=20), scan, (0, 0, 0), window).best
    assert best is not None
    np.testing.assert_allclose(best.pose[:2], truth[:2], atol=0.1)
    assert abs(wrap_angle(best.pose[2] - truth[2])) < 0.035
    assert best.score > 0.9


def test_further_maxima_are_apart_and_each_is_the_best_of_what_is_left():
    corners = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]])
    grid = grid_of(corners)
    window = SearchWindow(linear=1.5, angular=0.0, angular_step=0.1)
    found = branch_and_bound(
        build_pyramid(grid), [[0.05, 0.0]], (1, 1, 0), window, maxima=6, separation=Separation(linear=0.7)
    )
    places = np.array([m.pose[:2] for m in found.maxima])
    assert sorted(np.rint(places[:4]).tolist()) == sorted(corners.tolist())
    assert [m.score for m in found.maxima] == sorted((m.score for m in found.maxima), reverse=True)
    apart = np.abs(places[:, None] - places[None]).max(axis=-1)
    assert apart[~np.eye(len(places), dtype=bool)].min() > 0.7


def maxima_by_brute_force(grid, scan, centre, window, maxima, separation):
    """Sort every pose, then take the next that is apart from those taken."""
    headings, half = window.headings(centre[2]), window.reach(grid.resolution)
    steps = np.arange(-half, half + 1)
    totals = np.array([scores_at(grid, scan, centre[0], centre[1], heading, steps) for heading in headings])
    k, i, j = np.indices(totals.shape)
    rank = (k - len(headings) // 2) ** 2 + (i - half) ** 2 + (j - half) ** 2
    order = np.lexsort((j.ravel(), i.ravel(), k.ravel(), rank.ravel(), -totals.ravel()))
    reach, taken = separation.reach(headings, grid.resolution), []
    for k, i, j in zip(*(a.tolist() for a in np.unravel_index(order, totals.shape)), strict=True):
        if taken and totals[k, i, j] < np.ceil(separation.least_share * totals[taken[0]]):
            break
        turns = [min(abs(k - t[0]), len(headings) - abs(k - t[0])) for t in taken]
        if all(n > reach[0] or max(abs(i - t[1]), abs(j - t[2])) > reach[1] for n, t in zip(turns, taken, strict=True)):
            taken.append((k, i, j))
        if len(taken) == maxima:
            break
    return [(totals[t] / (255.0 * len(scan)), headings[t[0]], *t[1:]) for t in taken], half


@pytest.mark.parametrize("seed", range(6))
def test_all_maxima_are_those_of_trying_every_pose(seed):
    rng = np.random.default_rng(seed)
    grid, scan, centre = grid_of(room(rng)), room(rng, 30), rng.uniform([-1, -1, -3], [1, 1, 3])
    window = SearchWindow(linear=1.2, angular=np.pi, angular_step=0.15)
    separation = Separation(linear=0.3, angular=0.3, least_share=[0.0, 0.5, 0.7][seed % 3])
    expected, half = maxima_by_brute_force(grid, scan, centre, window, 12, separation)
    found = branch_and_bound(
        build_pyramid(grid, top_level=seed % 4), scan, centre, window, maxima=12, separation=separation
    )
    poses = [
        (float(score), float(wrap_angle(theta)), centre[1] + (i - half) * 0.1, centre[0] + (j - half) * 0.1)
        for score, theta, i, j in expected
    ]
    got = [(m.score, m.pose[2], m.pose[1], m.pose[0]) for m in found.maxima]
    assert len(got) == len(poses)
    np.testing.assert_allclose(got, poses, rtol=0.0, atol=1e-12)


def test_nothing_is_found_below_the_least_score_or_without_points():
    grid = grid_of(np.zeros((1, 2)))
    window = SearchWindow(linear=0.5, angular=0.2, angular_step=0.1)
    pyramid = build_pyramid(grid)
    assert branch_and_bound(pyramid, [[9.0, 9.0]], (0, 0, 0), window, min_score=0.01).best is None
    assert branch_and_bound(pyramid, np.empty((0, 2)), (0, 0, 0), window).best is None


def test_bad_input_is_named():
    with pytest.raises(InputError, match="uint8"):
        ScoreGrid(np.zeros((3, 3)), (0.0, 0.0), 0.1)
    with pytest.raises(InputError, match="resolution"):
        ScoreGrid(np.zeros((3, 3), dtype=np.uint8), (0.0, 0.0), 0.0)
    with pytest.raises(InputError, match="angular_step"):
        SearchWindow(linear=1.0, angular=1.0, angular_step=0.0)
    with pytest.raises(InputError, match="top_level"):
        build_pyramid(ScoreGrid(np.zeros((3, 3), dtype=np.uint8), (0.0, 0.0), 0.1), top_level=9)


def test_sixteen_sums_at_once_are_those_of_numpy():
    @numba.njit
    def add(sums, values, starts):
        add_lanes(sums, 3, values, starts, len(starts), 5)

    rng = np.random.default_rng(0)
    sums, values = rng.integers(0, 60000, 40).astype(np.uint16), rng.integers(0, 256, 40).astype(np.uint8)
    starts, expected = np.array([0, 7, 19, 7], dtype=np.int64), sums.copy()
    add_lanes_reference(expected, 3, values, starts, len(starts), 5)
    add(sums, values, starts)
    np.testing.assert_array_equal(sums, expected)
