"""Every matcher on synthetic rooms with known answers."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_scan import MATCHERS, make_matcher
from tagalong.slam.scan_to_scan.fitness import polar_fitness
from tagalong.slam.scan_to_scan.global_matcher import GlobalConfig, GlobalMatcher
from tagalong.slam.scan_to_scan.iterative import IterativeMatcher, Refined
from tagalong.slam.scan_to_scan.lookup import LookupConfig, build_lookup
from tagalong.slam.scan_to_scan.shared_lines import SharedLinesConfig
from tagalong.slam.scan_to_scan.surfaces import find_surfaces, near_points
from tagalong.slam.search.exhaustive import exhaustive_search

BEARINGS = np.radians(np.arange(-90.0, 90.0))
FULL = np.radians(np.arange(-180.0, 180.0))
# An oblong with a niche and a pillar: no symmetry. Segments x0 y0 x1 y1.
ROOM = np.array(
    [
        [-3, -2, 4, -2], [4, -2, 4, 3], [4, 3, 1, 3], [1, 3, 1, 4.2], [1, 4.2, -1, 4.2], [-1, 4.2, -1, 3],
        [-1, 3, -3, 3], [-3, 3, -3, -2], [2, 1, 2.5, 1], [2.5, 1, 2.5, 1.4], [2.5, 1.4, 2, 1.4], [2, 1.4, 2, 1],
    ],
    dtype=float,
)  # fmt: skip
CORRIDOR = np.array([[-100, -1, 100, -1], [-100, 1, 100, 1]], dtype=float)


def scan_of(walls, pose, bearings=BEARINGS, noise=0.0, rng=None, range_max=20.0):
    """What a laser sees: the first wall along each beam, by solving for each beam and wall."""
    angle = bearings + pose[2]
    d = np.stack((np.cos(angle), np.sin(angle)), axis=-1)[:, None]
    a, s = walls[:, :2] - pose[:2], walls[:, 2:] - walls[:, :2]
    with np.errstate(divide="ignore", invalid="ignore"):
        det = d[..., 0] * s[:, 1] - d[..., 1] * s[:, 0]
        r = (a[:, 0] * s[:, 1] - a[:, 1] * s[:, 0]) / det
        along = (a[:, 0] * d[..., 1] - a[:, 1] * d[..., 0]) / det
    ranges = np.where((r > 0) & (along >= 0) & (along <= 1), r, np.inf).min(axis=1)
    ranges = ranges + (0.0 if rng is None else rng.normal(0.0, noise, len(ranges)))
    return LaserScan(ranges, bearings, 0.05, range_max)


@pytest.mark.parametrize("bearings", [BEARINGS, FULL, FULL + np.pi])
def test_a_view_explains_itself_wholly_by_its_beams(bearings):
    view = scan_of(ROOM, np.array([0.3, 0.2, 0.5]), bearings)
    matcher = make_matcher("pga")
    ranges, start, step, threshold = matcher.table(view)[4:]
    fitness = np.empty(2)
    polar_fitness(np.array([np.zeros(3), [0.0, 0.0, 0.02]]), view.points, ranges, start, step, threshold, fitness)
    assert fitness[0] == pytest.approx(1.0)
    assert fitness[1] < 0.99


REACH = {"icp": (0.1, 0.08), "plicp": (0.25, 0.2), "mbicp": (0.2, 0.15), "hglasm-g-small": (0.25, 0.25)}
REACH |= {"hglasm-g-medium": (0.9, 0.9)}
COARSE = {"pga": (0.3, 0.1), "glasm": (0.3, 0.1), "glasm-g": (0.3, 0.1)}


@pytest.mark.parametrize("name", MATCHERS)
def test_it_finds_the_pose_from_within_its_reach(name):
    rng = np.random.default_rng(5)
    matcher = make_matcher(name)
    linear, angular = REACH.get(name, (1.4, np.pi))
    near = COARSE.get(name, (0.03, 0.012))
    for _ in range(4):
        at = np.array([*rng.uniform(-0.6, 0.6, 2), rng.uniform(-3, 3)])
        moved = compose(at, [*rng.uniform(-0.2, 0.2, 2), rng.uniform(-0.3, 0.3)])
        truth = between(at, moved)
        guess = truth + rng.uniform(-1, 1, 3) * [linear, linear, angular]
        scans = [scan_of(ROOM, pose, FULL, 0.01, rng) for pose in (at, moved)]
        match = matcher.match(*scans, guess)
        error = between(truth, match.pose)
        assert np.hypot(error[0], error[1]) < near[0]
        assert abs(error[2]) < near[1]
        assert name in COARSE or (match.converged and match.score > 0.8)


@pytest.mark.parametrize("name", MATCHERS)
def test_equal_questions_have_equal_answers_in_any_order(name):
    rng = np.random.default_rng(1)
    a, b, c = (scan_of(ROOM, pose, noise=0.01, rng=rng) for pose in ([0, 0, 0], [0.1, 0, 0.05], [0.3, 0.2, 0.4]))
    matcher = make_matcher(name)
    first = matcher.match(a, b, [0, 0, 0])
    matcher.match(b, c, [0, 0, 0])
    for again in (matcher.match(a, b, [0, 0, 0]), make_matcher(name).match(a, b, [0, 0, 0])):
        np.testing.assert_array_equal(again.pose, first.pose)
        np.testing.assert_array_equal(again.covariance, first.covariance)


EMPTY = np.full(180, np.inf)
FEW = EMPTY.copy()
FEW[[20, 90, 150]] = 2.0
TWO_WALLS = scan_of(CORRIDOR, [0, 0, 0]).ranges
DEGENERATE = {
    "empty": EMPTY,
    "three points": FEW,
    "NaN": np.full(180, np.nan),
    "all too near": np.zeros(180),
    "all at the farthest range": np.full(180, 20.0),
}


@pytest.mark.parametrize("name", MATCHERS)
@pytest.mark.parametrize("kind", DEGENERATE)
def test_scans_that_say_nothing_are_never_believed(name, kind):
    nothing = LaserScan(DEGENERATE[kind], BEARINGS, 0.05, 20.0)
    room = scan_of(ROOM, [0, 0, 0])
    matcher = make_matcher(name)
    for pair in ((nothing, room), (room, nothing), (nothing, nothing)):
        match = matcher.match(*pair, [0.1, 0.0, 0.0])
        assert np.isfinite(match.pose).all()
        assert np.linalg.eigvalsh(match.covariance)[0] > 0.0
        # The arc of farthest ranges matches itself, at any heading: its covariance says so.
        assert not match.converged or match.covariance[2, 2] > 1.0 or np.trace(match.covariance) > 1.0


@pytest.mark.parametrize("name", MATCHERS)
@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03])
def test_along_a_corridor_the_covariance_is_metres_wide_and_across_it_centimetres(name, noise):
    rng = np.random.default_rng(2)
    at, moved = np.array([0.0, 0.1, 0.2]), np.array([0.15, 0.05, 0.25])
    scans = [scan_of(CORRIDOR, pose, FULL, noise, rng, range_max=8.0) for pose in (at, moved)]
    match = make_matcher(name).match(*scans, between(at, moved) + np.array([0.05, 0.02, 0.02]))
    along, across = np.array([np.cos(-0.2), np.sin(-0.2), 0.0]), np.array([-np.sin(-0.2), np.cos(-0.2), 0.0])
    assert np.sqrt(along @ match.covariance @ along) > 0.5
    assert np.sqrt(across @ match.covariance @ across) < (0.15 if name in COARSE else 0.05)
    error = between(between(at, moved), match.pose)
    # A corridor looks the same from behind: what searches the whole circle may turn round.
    if name not in COARSE and abs(error[2]) < 1.0:
        assert abs(across @ error) < 0.05
    assert abs(error[2]) < 1.0 or name in ("pga", "glasm", "glasm-g", "hglasm-g-large", "global")
    # Whoever searches the whole circle does not believe in either way round.
    assert name not in (*COARSE, "hglasm-g-large", "global") or not match.converged


@pytest.mark.parametrize("name", ["plicp", "global"])
def test_the_covariance_is_of_the_size_of_the_errors(name):
    rng = np.random.default_rng(3)
    matcher, squares = make_matcher(name), []
    for _ in range(60):
        at = np.array([*rng.uniform(-0.6, 0.6, 2), rng.uniform(-3, 3)])
        moved = compose(at, [*rng.uniform(-0.1, 0.1, 2), rng.uniform(-0.1, 0.1)])
        match = matcher.match(*(scan_of(ROOM, p, FULL, 0.01, rng) for p in (at, moved)), between(at, moved))
        error = match.pose - between(at, moved)
        squares.append(error @ np.linalg.solve(match.covariance, error))
    assert 1.0 < np.mean(squares) < 9.0  # 3 of a perfect one


def test_the_shared_lines_of_two_scans_place_global_better_in_a_hall_seen_along():
    hall = np.array(
        [
            [-3, -1, 5, -1], [5, -1, 5, -0.8], [5, -0.8, 9, -0.8], [-3, 1, 4, 1], [4, 1, 4, 1.4], [4, 1.4, 9, 1.4],
            [9, -0.8, 9, 1.4],
        ]
    )  # fmt: skip
    rng, errors = np.random.default_rng(0), []
    matchers = [GlobalMatcher(GlobalConfig(shared=SharedLinesConfig(doubt=doubt))) for doubt in (0.0025, np.inf)]
    for _ in range(80):
        at = np.array([rng.uniform(-1.5, 1.0), *rng.uniform(-0.5, 0.5, 2)])
        moved = compose(at, rng.uniform(-0.1, 0.1, 3))
        scans = [scan_of(hall, pose, BEARINGS[::2], 0.006, rng) for pose in (at, moved)]
        truth = between(at, moved)
        found = [between(truth, matcher.match(*scans, truth).pose) for matcher in matchers]
        errors.append([np.hypot(error[0], error[1]) for error in found])
    settled, polished = np.mean(errors, axis=0)
    assert settled < 0.98 * polished


def test_of_two_places_that_explain_the_scans_as_well_global_takes_the_one_nearer_to_the_guess():
    oblong = np.array([[-3, -2, 3, -2], [3, -2, 3, 2], [3, 2, -3, 2], [-3, 2, -3, -2]], dtype=float)
    rng, found = np.random.default_rng(0), []
    reference = scan_of(oblong, [0, 0, 0], FULL[::2], 0.006, rng)
    at = np.array([0.7, 0.3, 0.2])
    scan = scan_of(oblong, at, FULL[::2], 0.006, rng)
    # A crowd before the walls, which no pose explains: `sure` is out of reach, free space is searched too.
    crowd = rng.random(len(scan)) < 0.3
    scan = replace(scan, ranges=np.where(crowd, scan.ranges * rng.uniform(0.3, 0.8, len(scan)), scan.ranges))
    turned = np.array([-0.7, -0.3, 0.2 - np.pi])
    for far in (0.01, 0.0):
        matcher = GlobalMatcher(GlobalConfig(far=far, sure=2.0))
        for guess in (at, turned):
            pose = matcher.match(reference, scan, guess).pose
            found.append(bool(np.hypot(*between(guess, pose)[:2]) < 0.1))
    assert found[:2] == [True, True]
    assert found[2] != found[3]


# A narrow corridor with an alcove, a hall at its end: what tells where, and which way round, is far and has few beams.
LONG = np.array(
    [
        [-3, -0.6, 9, -0.6], [-3, 0.6, 4, 0.6], [4, 0.6, 4, 1.8], [4, 1.8, 5.2, 1.8], [5.2, 1.8, 5.2, 0.6],
        [5.2, 0.6, 9, 0.6], [9, -0.6, 9, -1.4], [9, -1.4, 10.5, -1.4], [10.5, -1.4, 10.5, 1], [10.5, 1, 9, 1],
        [9, 1, 9, 0.6], [-3, -0.6, -3, 0.6],
    ],
    dtype=float,
)  # fmt: skip


def test_the_far_end_of_a_corridor_outweighs_the_walls_beside_the_laser():
    rng, matcher = np.random.default_rng(0), make_matcher("global")
    for _ in range(6):
        at = np.array([rng.uniform(-0.5, 0.5), *rng.uniform(-0.1, 0.1, 2)])
        moved = compose(at, [rng.uniform(1.0, 1.9), *rng.uniform(-0.15, 0.15, 2)])
        truth = between(at, moved)
        guess = truth + rng.uniform(-1, 1, 3) * [1, 1, np.pi]
        match = matcher.match(*(scan_of(LONG, pose, noise=0.01, rng=rng) for pose in (at, moved)), guess)
        np.testing.assert_allclose(between(truth, match.pose), 0.0, atol=0.1)
        assert not match.ambiguous


def test_where_the_views_are_alike_what_stands_near_counts_by_its_beams():
    # Half a turn is told by a post of 8 cm before the laser only.
    walls = np.array(
        [
            [-3, -2, 3, -2], [3, -2, 3, 2], [3, 2, -3, 2], [-3, 2, -3, -2], [0.5, 0.2, 0.58, 0.2],
            [0.58, 0.2, 0.58, 0.28], [0.58, 0.28, 0.5, 0.28], [0.5, 0.28, 0.5, 0.2],
        ]
    )  # fmt: skip
    rng, found = np.random.default_rng(0), []
    matchers = [GlobalMatcher(replace(GlobalConfig(second_maxima=0), **some)) for some in ({}, {"endpoints": 0.0})]
    for _ in range(30):
        at = rng.uniform(-0.1, 0.1, 3)
        scans = [scan_of(walls, at, FULL[first::4], 0.02, rng) for first in (0, 2)]
        guess = rng.uniform(-0.5, 0.5, 3) * [1, 1, 6]
        found.append([bool(np.abs(matcher.match(*scans, guess).pose).max() < 0.1) for matcher in matchers])
    with_beams, without = np.mean(found, axis=0)
    assert with_beams > without + 0.15


def test_a_scan_explains_itself_but_for_the_fifth_that_is_taken_for_granted():
    matcher = GlobalMatcher(GlobalConfig())
    tool = IterativeMatcher(matcher.config.refinement)
    seen = find_surfaces(scan_of(ROOM, [0, 0, 0], FULL), matcher.config.refinement.surfaces)
    score = matcher._explains(tool, seen, seen, np.zeros(3))  # pyright: ignore[reportPrivateUsage]
    assert score == pytest.approx((2.0 / 2.2 + 0.5) / 1.5, abs=2e-3)


def test_of_poses_side_by_side_the_higher_maximum_is_taken_unless_it_explains_less():
    matcher = GlobalMatcher(GlobalConfig())
    poses = [Refined(np.array([x, 0.0, 0.0]), 1, True) for x in (0.1, 0.0, 1.0)]
    for worth, nearly, expected in (
        ((0.90, 1.0, 0.5), 0.0, 0),
        ((0.90, 1.0, 0.5), 0.97, 1),
        ((0.98, 1.0, 0.5), 0.97, 0),
        ((0.98, 0.5, 1.0), 0.0, 2),  # a metre away is another place
    ):
        assert matcher._choose(poses, np.array(worth), nearly) == expected  # pyright: ignore[reportPrivateUsage]


def test_global_recovers_where_icp_does_not():
    rng = np.random.default_rng(4)
    at, moved = np.array([0.2, -0.3, 0.4]), np.array([0.3, 0.1, 2.9])
    scans = [scan_of(ROOM, pose, FULL, 0.01, rng) for pose in (at, moved)]
    truth, guess = between(at, moved), np.zeros(3)
    found = make_matcher("global").match(*scans, guess)
    np.testing.assert_allclose(found.pose, truth, atol=0.02)
    assert found.converged and not found.ambiguous  # noqa: PT018
    for name in ("icp", "plicp", "mbicp"):
        assert np.abs(between(truth, make_matcher(name).match(*scans, guess).pose)).max() > 0.3


def test_the_second_kind_of_lines_leaves_exact_poses_exact_and_moves_noisy_ones_by_less_than_their_error():
    config = GlobalConfig().refinement
    tool, lines, errors = IterativeMatcher(config), replace(config.surfaces, even=True), []
    rng = np.random.default_rng(8)
    for k in range(60):
        at = np.array([*rng.uniform(-0.6, 0.6, 2), rng.uniform(-3, 3)])
        moved = compose(at, [*rng.uniform(-0.1, 0.1, 2), rng.uniform(-0.1, 0.1)])
        noise = 0.01 * (k % 2)
        reference, new = (scan_of(ROOM, pose, FULL[::4], noise, rng) for pose in (at, moved))
        surfaces = find_surfaces(new, config.surfaces)
        refined = tool.refine_both(reference, surfaces, between(at, moved))
        polished = tool.polish_both(reference, surfaces, refined, lines)
        pairs = ((between(at, moved), refined.pose), (between(at, moved), polished.pose), (refined.pose, polished.pose))
        errors.append([np.hypot(*between(*pair)[:2]) for pair in pairs])
        assert polished.iterations > refined.iterations
    exact, noisy = np.median(errors[::2], axis=0), np.mean(errors[1::2], axis=0)
    assert exact.max() < 2e-4
    assert noisy[2] < 0.7 * noisy[0]
    assert noisy[1] < 1.1 * noisy[0]


def test_a_room_that_looks_the_same_from_behind_is_ambiguous():
    walls = np.array([[-3, -2, 3, -2], [3, -2, 3, 2], [3, 2, -3, 2], [-3, 2, -3, -2]], dtype=float)
    scans = [scan_of(walls, pose, FULL, 0.005, np.random.default_rng(n)) for n, pose in enumerate(np.zeros((2, 3)))]
    match = make_matcher("global").match(*scans, [0, 0, 0])
    assert match.ambiguous
    assert match.alternatives is not None
    assert abs(abs(match.alternatives[0][2] - match.pose[2]) - np.pi) < 0.05


def test_bad_names_and_fields_are_named():
    with pytest.raises(InputError, match="unknown scan matcher 'ipc'"):
        make_matcher("ipc")
    with pytest.raises(InputError, match="'plicp'"):
        make_matcher("plicp", wibble=1)
    with pytest.raises(InputError, match="kept"):
        make_matcher("icp", kept=1.5)


def test_both_searches_of_global_are_those_of_the_exhaustive_search():
    rng = np.random.default_rng(6)
    matcher = GlobalMatcher(GlobalConfig())
    for _ in range(2):
        at = np.array([*rng.uniform(-0.6, 0.6, 2), rng.uniform(-3, 3)])
        reference, new = (scan_of(ROOM, pose, noise=0.01, rng=rng) for pose in (at, compose(at, [0.3, 0.2, 0.7])))
        points, guess = near_points(new, 30.0), rng.uniform(-1, 1, 3)
        for found, grid in (
            (matcher.search(reference, points, guess), build_lookup(near_points(reference, 30.0), LookupConfig())),
            (matcher.search_views(reference, points, guess), matcher.views_table(reference)),
        ):
            assert found.best == exhaustive_search(grid, points, guess, matcher.config.window).best


# A hall, a door 1 m wide, a room behind it.
HALL = np.array(
    [
        [-6, 0, 6, 0], [6, 0, 6, 2.4], [6, 2.4, 0.5, 2.4], [-0.5, 2.4, -6, 2.4], [-6, 2.4, -6, 0],
        [-0.5, 2.4, -0.5, 2.6], [0.5, 2.4, 0.5, 2.6], [-0.5, 2.6, -2, 2.6], [0.5, 2.6, 3.1, 2.6],
        [-2, 2.6, -2, 7], [3.1, 2.6, 3.1, 7], [-2, 7, 3.1, 7], [1.2, 5, 2, 5], [1.2, 5, 1.2, 5.8],
    ],
    dtype=float,
)  # fmt: skip


def test_views_that_share_little_are_told_by_free_space():
    rng = np.random.default_rng(7)
    at, moved = np.array([0.2, 1.3, 1.5]), np.array([0.1, 2.8, 1.6])
    scans = [scan_of(HALL, pose, noise=0.01, rng=rng) for pose in (at, moved)]
    truth = between(at, moved)
    guess = truth + np.array([0.7, -0.8, 2.0])
    endpoints = make_matcher("global", second_maxima=0).match(*scans, guess)
    both = make_matcher("global").match(*scans, guess)
    assert np.abs(between(truth, endpoints.pose)).max() > 0.3
    np.testing.assert_allclose(between(truth, both.pose), 0.0, atol=0.03)
