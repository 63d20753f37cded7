"""The kernels against plain numpy, and the tiles they work on."""

import gmapping_reference as reference
import numpy as np
import pytest
from grid_reference import write_observation_reference
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.slam.errors import InputError
from tagalong.slam.gmapping.alignment import MapAlignment
from tagalong.slam.gmapping.config import MatcherConfig, TrackingConfig
from tagalong.slam.gmapping.fit_kernels import compare, draw_scores, search_samples
from tagalong.slam.gmapping.match_kernels import accumulate, new_memory, solve
from tagalong.slam.gmapping.matcher import ParticleScanMatcher
from tagalong.slam.gmapping.thinning_kernel import first_of_squares
from tagalong.slam.gmapping.tile_kernels import SIDE, draw_near
from tagalong.slam.gmapping.tile_maps import TileMaps
from tagalong.slam.grid import GridConfig, OccupancyGrid, render_map
from tagalong.slam.grid_kernels import write_observation
from tagalong.slam.processes.threads import Workers
from tagalong.slam.rays import ray_cells
from tagalong.slam.scan import LaserScan

FULLNESS = 0.1
coordinate = st.floats(-20.0, 20.0, allow_nan=False)


def room_scan(rng, n=200, lower=(-3.1, -2.3), upper=(4.2, 3.7)):
    """Ends of rays from (0, 0) in a rectangular room, noisy [m]."""
    angles = np.linspace(-np.pi, np.pi, n, endpoint=False)
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    with np.errstate(divide="ignore"):
        ranges = np.maximum(np.array(lower) / directions, np.array(upper) / directions).min(axis=1)
    return directions * (ranges + rng.normal(0.0, 0.01, n))[:, None]


def plain(maps, particle=0):
    """counts, means and bits of one particle as plain grids, and their corner in cells."""
    directory = maps.directory[particle]
    rows, cols = directory.shape

    def join(tiles):
        return tiles.reshape(rows, cols, SIDE, SIDE, -1).swapaxes(1, 2).reshape(rows * SIDE, cols * SIDE, -1)

    bits = (maps.bits[directory][..., None] >> np.arange(SIDE, dtype=np.uint32)) & 1
    return join(maps.counts[directory]), join(maps.means[directory]), join(bits)[..., 0].astype(bool)


def written_maps(rng, particles=1, scans=3):
    maps = TileMaps(particles, 0.05, FULLNESS, Workers(1))
    for _ in range(scans):
        poses = rng.normal(0.0, [0.1, 0.1, 0.05], (particles, 3))
        points = room_scan(rng)
        maps.write(poses, points, rng.random(len(points)) < 0.9)
    return maps


@settings(max_examples=60, deadline=None)
@given(coordinate, coordinate, coordinate, coordinate)
def test_a_ray_visits_a_chain_of_neighbouring_cells_from_start_to_end(x0, y0, x1, y1):
    cells = ray_cells(x0, y0, x1, y1)
    assert np.abs(np.diff(cells, axis=0)).max(initial=0) <= 1
    assert np.abs(cells[0] - np.floor([y0, x0])).max() <= 1
    assert np.abs(cells[-1] - np.floor([y1, x1])).max() <= 1


def test_the_grid_kernel_equals_numpy():
    rng = np.random.default_rng(0)
    grids = [(np.zeros((60, 70), np.float32), np.zeros((60, 70), np.int32)) for _ in range(2)]
    for stamp in range(1, 5):
        start, ends = rng.uniform(10, 50, 2), rng.uniform(1, 59, (80, 2))
        log_beta = np.where(rng.random(80) < 0.7, 0.8, np.nan)
        arguments = (*start, ends, log_beta, -0.4, 1.5, stamp)
        write_observation(*arguments, *grids[0])
        write_observation_reference(*arguments, *grids[1])
    np.testing.assert_allclose(grids[0][0], grids[1][0], atol=1e-6)
    np.testing.assert_array_equal(grids[0][1], grids[1][1])


@pytest.mark.parametrize("margin", [0.0, 0.1])
def test_counted_cells_equal_numpy(margin):
    rng = np.random.default_rng(1)
    maps = TileMaps(1, 0.05, FULLNESS, Workers(1), margin)
    points = room_scan(rng, 500)
    is_hit = rng.random(500) < 0.8
    pose = np.array([[0.31, -0.22, 0.4]])
    maps.write(pose, points, is_hit)
    counts, means, occupied = plain(maps)
    turn = np.array([[np.cos(0.4), np.sin(0.4)], [-np.sin(0.4), np.cos(0.4)]])
    start, ends = maps.to_cells(pose[0, :2]), maps.to_cells(points @ turn + pose[0, :2])
    expected, sums = reference.count_rays(*start, ends, is_hit, counts.shape[:2], margin)
    np.testing.assert_array_equal(counts, expected)
    hit = expected[..., 0] > 0
    np.testing.assert_allclose(means[hit], (sums[hit] / expected[hit][:, :1]), atol=1e-5)
    np.testing.assert_array_equal(occupied, expected[..., 0] > FULLNESS * expected[..., 1])


def test_normal_equations_equal_numpy_and_a_step_solves_them():
    rng = np.random.default_rng(2)
    maps = written_maps(rng)
    counts, means, occupied = plain(maps)
    rows, cols = np.nonzero(occupied)
    centres, hits = np.stack((cols, rows), axis=-1) + means[rows, cols], counts[rows, cols, 0]
    free = (counts[..., 1] > 0) & ~occupied
    pose = np.append(maps.to_cells(np.array([0.05, -0.03])), 0.02)
    points = room_scan(rng, 150) / 0.05
    system = np.zeros((3, 4))
    remembered = new_memory(len(points))
    tiles = maps.directory[0], maps.counts, maps.means, maps.bits
    for _ in range(2):  # looked up anew, then remembered
        _, loss = accumulate(pose, points, 1, 3, 2.0, 0.15, *tiles, remembered, system)
    expected, expected_loss = reference.normal_equations(pose, points, 3, 2.0, 0.15, centres, hits, free)
    np.testing.assert_allclose(system, expected, rtol=1e-6, atol=1e-4)
    assert loss == pytest.approx(expected_loss, rel=1e-6)
    step = np.zeros(3)
    assert solve(system, step)
    np.testing.assert_allclose(system[:, :3] @ step, -system[:, 3], rtol=1e-6, atol=1e-6)
    assert not solve(np.zeros((3, 4)), step)


def test_more_points_than_are_independent_make_a_pose_no_surer():
    def covariance(independent):
        rng = np.random.default_rng(5)
        maps, points = written_maps(rng), room_scan(rng, 400)
        matcher = ParticleScanMatcher(MatcherConfig(samples=1, independent_points=independent), Workers(1))
        matches = matcher.match(maps, points, np.zeros((1, 3)), np.diag([4.0, 4.0, 1.0])[None], rng)
        return matches.roots[0] @ matches.roots[0].T, len(matcher.thinned(points, maps.cell))

    (fifty, count), (hundred, _), (all_of_them, _) = covariance(50.0), covariance(100.0), covariance(1e6)
    assert count > 200
    np.testing.assert_allclose(np.diag(fifty), 2.0 * np.diag(hundred), rtol=1e-3)
    assert (np.diag(all_of_them) < 0.55 * np.diag(hundred)).all()


def test_another_start_is_looked_for_only_where_the_map_speaks_against_the_first():
    rng, maps = np.random.default_rng(9), TileMaps(1, 0.05, FULLNESS, Workers(1))
    for _ in range(3):
        maps.write(np.zeros((1, 3)), room_scan(rng), np.ones(200, dtype=bool))
    points, covariance = room_scan(rng), np.diag(np.square([0.3, 0.3, 0.15]))[None]

    def off(expected, suspicion):
        """How far from the truth a scan is put that is expected there [m]."""
        matcher = ParticleScanMatcher(MatcherConfig(suspicion=suspicion), Workers(1))
        matches = matcher.match(maps, points, np.array([expected]), covariance, np.random.default_rng(0))
        return float(np.hypot(*matches.modes[0, :2])), matches.modes.tobytes()

    near, far = (0.02, -0.03, 0.01), (0.6, 0.4, 0.3)
    assert off(near, 0.75)[0] < 0.01
    assert off(near, 0.75) == off(near, 1e6)
    assert off(far, 0.75)[0] < 0.01
    assert off(far, 1e6)[0] > 0.1


def matched(maps, points, expected, sigma):
    """Where a scan is put that is expected at a pose, with so much doubt along and across [m], and little of turn."""
    matcher, rng = ParticleScanMatcher(MatcherConfig(suspicion=1e6), Workers(1)), np.random.default_rng(0)
    return matcher.match(maps, points, np.array([expected]), np.diag(np.square([*sigma, 0.01]))[None], rng).modes[0]


@pytest.mark.parametrize("thick", [0.12, 0.15])
def test_the_other_face_of_a_wall_is_not_taken_for_the_one_that_was_seen(thick):
    rng, maps, ys = np.random.default_rng(3), TileMaps(1, 0.05, FULLNESS, Workers(1)), np.linspace(-1.5, 1.5, 150)
    face, jamb = np.stack((2.0 + rng.normal(0.0, 0.01, 150), ys), axis=1), np.array([[2.02, 1.9], [2.05, 1.9]])
    for _ in range(3):
        maps.write(np.zeros((1, 3)), np.concatenate((face, jamb)), np.ones(152, dtype=bool))
    through = np.array([3.0, 0.0, 0.0])  # the robot has gone round the wall
    other = np.stack((2.0 + thick - through[0] + rng.normal(0.0, 0.01, 150), ys), axis=1)
    assert matched(maps, other, through, (0.1, 0.1))[0] == pytest.approx(through[0], abs=0.002)
    same = np.stack((2.0 + rng.normal(0.0, 0.01, 150) - 0.9, ys), axis=1)  # seen from the same side as before: it pulls
    assert matched(maps, same, np.array([0.9 - thick, 0.0, 0.0]), (0.1, 0.1))[0] == pytest.approx(0.9, abs=0.01)


def test_hits_far_apart_on_a_wall_do_not_hold_the_robot_back_along_it():
    rng, maps, xs = np.random.default_rng(4), TileMaps(1, 0.05, FULLNESS, Workers(1)), np.arange(-3.0, 3.0, 0.2)
    walls = np.concatenate([np.stack((xs, np.full(len(xs), y)), axis=1) for y in (-1.0, 1.0)])
    maps.write(np.zeros((1, 3)), walls + rng.normal(0.0, 0.005, walls.shape), np.ones(len(walls), dtype=bool))
    middle = walls[np.abs(walls[:, 0]) < 2.5]
    for ahead in (0.06, 0.08):  # beams hit the walls beside the robot as far ahead of it as before
        pose = matched(maps, middle + rng.normal(0.0, 0.005, middle.shape), np.array([ahead, 0.03, 0.0]), (0.05, 0.1))
        assert pose[0] == pytest.approx(ahead, abs=0.02)
        assert abs(pose[1]) < 0.005


def test_a_heading_may_be_told_a_whole_turn_apart():
    rng, heading = np.random.default_rng(6), np.pi - 0.01
    turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    points = room_scan(rng) @ turn.T
    maps, matcher = TileMaps(1, 0.05, FULLNESS, Workers(1)), ParticleScanMatcher(MatcherConfig(), Workers(1))
    maps.write(np.array([[0.0, 0.0, heading]]), points, np.ones(200, dtype=bool))
    aligned, expected = MapAlignment(maps, 0, points, matcher, TrackingConfig()), np.array([0.0, 0.0, heading])
    near, beyond = (
        aligned.refined(expected + np.array([0.0, 0.0, 0.03 + whole]), expected, 0.01 * np.eye(3))
        for whole in (0.0, -2.0 * np.pi)
    )
    np.testing.assert_allclose(near.pose, beyond.pose, atol=1e-9)
    assert near.value == pytest.approx(beyond.value, abs=1e-6)
    assert near.pose[2] == pytest.approx(heading, abs=0.01)


def test_what_speaks_against_a_pose_is_told_apart_from_what_is_unknown():
    rng, maps = np.random.default_rng(10), TileMaps(1, 0.05, FULLNESS, Workers(1))
    maps.write(np.zeros((1, 3)), room_scan(rng, 2000), np.ones(2000, dtype=bool))
    inside = np.stack((np.linspace(-2.0, 2.0, 10), np.ones(10)), axis=1)  # where rays have been
    outside = np.stack((np.linspace(-2.0, 2.0, 30), np.full(30, 6.0)), axis=1)  # where none has
    matcher = ParticleScanMatcher(MatcherConfig(unseen=0.4, weight=30.0), Workers(1))
    aligned = MapAlignment(maps, 0, np.concatenate((inside, outside)), matcher, TrackingConfig())
    told = aligned.refined(np.zeros(3), np.zeros(3), 1e-9 * np.eye(3))
    assert (told.against, told.unknown) == pytest.approx((0.25, 0.75))
    assert told.value == pytest.approx(-30.0 * (0.25 + 0.4 * 0.75), abs=1e-3)


def test_a_few_points_are_worth_no_more_than_their_number():
    rng, maps = np.random.default_rng(10), TileMaps(1, 0.05, FULLNESS, Workers(1))
    maps.write(np.zeros((1, 3)), room_scan(rng, 2000), np.ones(2000, dtype=bool))
    matcher = ParticleScanMatcher(MatcherConfig(weight=30.0), Workers(1))

    def value(n):
        inside = np.stack((np.linspace(-2.0, 2.0, n), np.ones(n)), axis=1)  # where rays have been and hit nothing
        aligned = MapAlignment(maps, 0, inside, matcher, TrackingConfig())
        return aligned.refined(np.zeros(3), np.zeros(3), 1e-9 * np.eye(3)).value

    assert [value(n) for n in (1, 4, 30, 45)] == pytest.approx([-1.0, -4.0, -30.0, -30.0], abs=1e-3)


def test_a_match_that_remembers_its_last_step_finds_what_one_that_looks_anew_does():
    rng = np.random.default_rng(7)
    maps = written_maps(rng)
    points, remembered = room_scan(rng, 150) / 0.05, new_memory(150)
    tiles = maps.directory[0], maps.counts, maps.means, maps.bits
    for shift in ((0.0, 0.0, 0.0), (0.01, 0.0, 0.001), (0.1, -0.05, 0.02), (0.1, -0.04, 0.02), (40.0, 0.0, 0.0)):
        pose = np.append(maps.to_cells(np.array(shift[:2])), shift[2])
        again, anew = np.zeros((3, 4)), np.zeros((3, 4))
        told = accumulate(pose, points, 1, 3, 2.0, 0.15, *tiles, remembered, again)
        assert told == accumulate(pose, points, 1, 3, 2.0, 0.15, *tiles, new_memory(150), anew)
        np.testing.assert_array_equal(again, anew)


def test_thinning_keeps_the_first_point_of_each_square_in_order():
    points = np.random.default_rng(8).normal(0.0, 0.3, (300, 2))
    squares = np.floor(points / 0.1)
    firsts = np.sort(np.unique(squares, axis=0, return_index=True)[1])
    assert len(firsts) < 200
    np.testing.assert_array_equal(first_of_squares(points, 0.1), points[firsts])
    assert first_of_squares(points[:0], 0.1).shape == (0, 2)


@pytest.mark.parametrize("theta", [0.0, 0.7])
def test_half_speaks_against_a_point_where_a_wall_is_two_cells_away_and_all_where_it_is_three(theta):
    rng, bits, near = np.random.default_rng(3), np.zeros((2, SIDE), np.uint32), np.zeros((2, SIDE), np.uint64)
    bits[1, 15], bits[1, 20] = np.uint32(1 << 12), np.uint32(1 << 21)
    draw_near(np.ones((1, 1), np.bool_), np.ones((1, 1), np.int32), bits, near)
    points = rng.uniform(-9.0, 9.0, (200, 2))
    cos, sin = np.cos(theta), np.sin(theta)
    cells = np.floor(points @ np.array([[cos, sin], [-sin, cos]]) + 16.0)
    apart = np.abs(cells[:, None] - [(12, 15), (21, 20)]).max(axis=-1).min(axis=1)
    counts = np.ones((2, SIDE * SIDE, 2), np.uint16)
    against, unknown = compare(16.0, 16.0, theta, points, 0.4, np.inf, np.ones((1, 1), np.int32), counts, near)
    assert (2.0 * against, unknown) == (np.clip(apart - 1, 0, 2).sum(), 0)
    assert set(np.clip(apart - 1, 0, 2)) == {0, 1, 2}


def test_the_search_finds_the_best_of_all_samples():
    rng = np.random.default_rng(3)
    maps = written_maps(rng)
    counts, _, occupied = plain(maps)
    prior = np.append(maps.to_cells(np.array([0.25, -0.2])), 0.15)
    root = np.linalg.cholesky(np.diag([5.0, 5.0, 0.1]) ** 2)
    samples, points = rng.standard_normal((60, 3)), room_scan(rng, 60) / 0.05
    pose, tiles = np.zeros(3), (maps.directory[0], maps.counts, maps.near)
    search_samples(prior, root, samples, points, 30.0, 0.4, *tiles, pose)
    poses, values = reference.sample_values(prior, root, samples, points, 30.0, 0.4, counts[..., 1] > 0, occupied)
    np.testing.assert_allclose(pose, poses[np.argmax(values)], rtol=1e-12)


def test_what_speaks_against_a_pose_equals_numpy():
    rng = np.random.default_rng(5)
    maps = written_maps(rng)
    counts, _, occupied = plain(maps)
    for shift in ([0.0, 0.0, 0.0], [0.3, -0.2, 0.2], [3.0, 1.0, 2.0]):
        pose = np.append(maps.to_cells(np.array(shift[:2])), shift[2])
        points = room_scan(rng, 150) / 0.05
        found = compare(*pose, points, 0.25, np.inf, maps.directory[0], maps.counts, maps.near)
        assert found == reference.spoken_against(pose, points, 0.25, counts[..., 1] > 0, occupied)


def test_the_table_of_a_coarse_search_equals_numpy():
    maps = written_maps(np.random.default_rng(6))
    counts, _, occupied = plain(maps)
    values = np.empty(np.array(occupied.shape) // 2, dtype=np.uint8)
    draw_scores(0, 0, 2, np.uint8(128), np.uint8(204), maps.directory[0], maps.counts, maps.bits, values)
    np.testing.assert_array_equal(values, reference.score_table(2, 128, 204, counts[..., 1] > 0, occupied))


def test_a_changed_child_never_changes_its_parent_and_shares_what_it_did_not_touch():
    rng = np.random.default_rng(4)
    maps = written_maps(rng, particles=3)
    before = [[array.copy() for array in plain(maps, p)] for p in range(3)]
    stored = maps.tiles
    maps.resample(np.array([1, 1, 2]))
    assert maps.tiles < stored
    for p, parent in enumerate((1, 1, 2)):
        for now, then in zip(plain(maps, p), before[parent], strict=True):
            np.testing.assert_array_equal(now, then)
    shared = maps.tiles
    poses = np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]])
    maps.write(poses, np.array([[0.6, 0.1]]), np.array([True]))
    assert shared <= maps.tiles <= shared + 4
    one, two = plain(maps, 0)[0], plain(maps, 1)[0]
    start = before[1][0]
    row, col = np.floor(maps.to_cells(np.array([0.6, 0.1])))[::-1].astype(int)
    assert (one[row, col] == start[row, col] + 1).all()
    assert (two[row, col] == start[row, col]).all()
    changed = (one != start).any(axis=-1) & (two != start).any(axis=-1)
    assert changed.sum() < (one != start).any(axis=-1).sum()


def test_maps_grow_in_every_direction_and_keep_what_they_had():
    maps = TileMaps(1, 0.05, FULLNESS, Workers(1))
    for angle in np.arange(0.0, 2.0 * np.pi, 0.7):
        maps.write(np.array([[0.0, 0.0, angle]]), np.array([[9.0 + angle, 0.01]]), np.array([True]))
    counts, _, occupied = plain(maps)
    assert occupied.sum() == 9
    row, col = np.floor(maps.to_cells(np.zeros(2)))[::-1].astype(int)
    assert counts[row, col, 1] == 9


def test_a_rendered_map_has_walls_where_they_are_and_is_free_inside():
    rng = np.random.default_rng(5)
    points = room_scan(rng, 720)
    bearings = np.arctan2(points[:, 1], points[:, 0])
    order = np.argsort(bearings)
    scan = LaserScan(np.linalg.norm(points, axis=1)[order], bearings[order], 0.1, 30.0)
    result = render_map(np.zeros((5, 3)), [scan] * 5, GridConfig(resolution=0.02))
    walls = result.occupied_points
    distance = np.abs(np.stack((walls - (-3.1, -2.3), walls - (4.2, 3.7)))).min(axis=(0, 2))
    assert distance.max() < 0.06
    row, col = ((np.zeros(2) - result.origin) / 0.02).astype(int)[::-1]
    assert result.free[row, col]
    assert not result.known[0, 0] or result.occupied[0, 0]
    assert not OccupancyGrid().to_map().known.any()


def test_scans_drawn_together_make_the_bytes_of_scans_written_one_by_one(monkeypatch):
    monkeypatch.setattr("tagalong.slam.grid._AT_ONCE", 7)
    rng, config = np.random.default_rng(6), GridConfig(resolution=0.1, max_range=6.0)
    bearings = np.linspace(-np.pi, np.pi, 90, endpoint=False)
    scans = [LaserScan(rng.uniform(0.5, 9.0, 90), bearings, 0.1, 8.0, T_robot_lidar=(0.2, 0.1, 0.3)) for _ in range(20)]
    scans[4] = LaserScan(np.full(90, np.nan), bearings, 0.1, 8.0)  # says nothing
    poses = np.cumsum(rng.normal(0.0, (2.0, 2.0, 1.0), (20, 3)), axis=0)  # the grid grows to all sides
    poses[0] = 0.0  # rays along the lines between cells
    grid = OccupancyGrid(config)
    for pose, scan in zip(poses, scans, strict=True):
        grid.write(pose, scan)
    one_by_one, together = grid.to_map(), render_map(poses, scans, config)
    assert together.origin == one_by_one.origin
    assert together.probability.tobytes() == one_by_one.probability.tobytes()


def test_a_grid_refuses_to_grow_beyond_reason():
    scan = LaserScan(np.array([5.0]), np.array([0.0]), 0.1, 8.0)
    with pytest.raises(
        InputError, match=r"the map would grow to .* m in cells of 0\.05 m; .* or the cells are too small"
    ):
        render_map(np.array([[0.0, 0.0, 0.0], [1e7, 1e7, 0.0]]), [scan] * 2)


def test_rays_beyond_the_longest_range_free_cells_but_hit_nothing():
    nothing = [np.inf] * 3
    scan = LaserScan(np.array([5.0, *nothing, np.nan]), np.array([-0.5, -0.01, 0.0, 0.01, 0.5]), 0.1, 8.0)
    assert not render_map(np.zeros((1, 3)), [scan], GridConfig(max_range=3.0)).occupied.any()
    cleared = render_map(np.zeros((1, 3)), [scan], GridConfig(max_range=3.0, clear_no_return=True))
    assert cleared.free.sum() > 2 * 0.8 * 3.0 / 0.05
