"""The last step of the global matcher: where both scans lie on the same straight pieces."""

from dataclasses import replace

import numpy as np
import pytest
from scan_to_scan_reference import log_evidence_reference
from tagalong.slam.errors import InputError
from tagalong.slam.scan_to_scan.shared_lines import (
    SharedLinesConfig,
    information,
    least_sure,
    log_evidence,
    merge,
    refine_by_shared_lines,
)

CONFIG = SharedLinesConfig()
COSTS = CONFIG.single, CONFIG.pair, CONFIG.line


def wall(start, end, count, rng=None, noise=0.006):
    """Points (count, 2) on a segment, in order."""
    points = np.linspace(start, end, count)
    return points if rng is None else points + rng.normal(0.0, noise, (count, 2))


def test_the_evidence_is_the_sum_over_all_cuts():
    rng = np.random.default_rng(0)
    for _ in range(20):
        points = np.vstack([wall([2, -1], [2, 1], 7, rng), wall([2, 1], [1.7, 1], 4, rng), rng.uniform(-1, 1, (3, 2))])
        apart = rng.random(len(points)) < 0.15
        for longest in (5, 20):
            found, _ = log_evidence(points, apart, 0.0075, COSTS, longest)
            # What costs e^-12 of the rest is left out.
            assert found == pytest.approx(log_evidence_reference(points, apart, 0.0075, COSTS, longest), abs=1e-4)


def test_the_best_cut_is_at_the_corner_and_where_it_must_be():
    points = np.vstack([wall([2, -1], [2, 1], 8), wall([1.8, 1.1], [1, 1.1], 5)])
    apart = np.zeros(13, dtype=bool)
    _, before = log_evidence(points, apart, 0.0075, COSTS, 20)
    assert (before[13], before[8]) == (8, 0)
    apart[3] = True
    _, before = log_evidence(points, apart, 0.0075, COSTS, 20)
    assert (before[13], before[8], before[4]) == (8, 4, 0)


def test_the_chain_goes_by_bearing_and_knows_how_the_pose_moves_each_point():
    rng = np.random.default_rng(1)
    reference, new = rng.uniform(-3, 3, (6, 2)), rng.uniform(-3, 3, (5, 2))
    pose, change = np.array([0.2, -0.1, 0.3]), np.array([1e-6, -2e-6, 3e-6])
    points, moves, _ = merge(reference, new, pose, 0.2, 8.0)
    bearings = np.arctan2(points[:, 1], points[:, 0])
    assert (np.diff(bearings) > 0.0).all()
    moved, _, _ = merge(reference, new, pose + change, 0.2, 8.0)
    np.testing.assert_allclose(moved - points, moves @ change, atol=1e-10)
    assert sum(not moves[k].any() for k in range(11)) == 6


def test_points_are_of_different_surfaces_where_nothing_or_a_jump_is_between_them():
    reference = np.array([[2.0, 0.0], [2.0, 0.1], [3.5, 0.3], [3.5, 0.4], [0.0, 3.0], [0.0, 3.01]])
    _, _, apart = merge(reference, np.empty((0, 2)), np.zeros(3), 0.2, 8.0)
    assert apart.tolist() == [False, True, False, True, False, True]


def test_a_wall_says_how_far_it_is_and_nothing_of_the_place_along_it():
    # Two interleaved sets of ten points on x = 2: the line is unknown, so their difference counts, of variance 2 / 10.
    ys = np.linspace(-1.0, 1.0, 20)
    points = np.stack((np.full(20, 2.0), ys), axis=-1)
    _, moves, _ = merge(points[::2], points[1::2], np.zeros(3), 0.2, 8.0)
    before = np.zeros(21, dtype=np.int64)
    found = information(points, moves, before)
    # Less what a tilt of the line explains: the one set lies 0.05 farther along than the other.
    assert found[0, 0] == pytest.approx(5.0, rel=0.01)
    np.testing.assert_allclose(found[1], 0.0, atol=1e-9)
    direction, sigma = least_sure(found / 0.0075**2)
    assert abs(direction[1]) == pytest.approx(1.0)
    assert sigma == pytest.approx(0.1)


def test_two_points_of_each_scan_at_the_end_of_a_corridor_are_enough():
    rng = np.random.default_rng(2)
    errors, before = [], []
    for _ in range(60):
        halves = [
            np.vstack([
                wall([0.3, -1 - 0.02 * k], [6, -1 - 0.02 * k], 30)[k::2],
                wall([6.5, -0.3], [6.5, 0.3], 5)[k::2],
                wall([6, 1], [0.3, 1], 30)[k::2],
            ])
            for k in (0, 1)
        ]  # fmt: skip
        reference, new = (half + rng.normal(0.0, 0.004, half.shape) for half in halves)
        pose = np.array([rng.normal(0.0, 0.008), 0.0, 0.0])
        before.append(abs(pose[0]))
        errors.append(abs(refine_by_shared_lines(reference, new, pose, CONFIG)[0]))
    assert np.mean(errors) < 0.7 * np.mean(before)


def test_the_pose_stays_where_it_is_sure_and_goes_no_farther_than_is_looked():
    rng = np.random.default_rng(3)
    room = np.vstack([wall([2, -2], [2, 2], 40, rng), wall([2, 2], [-2, 2], 40, rng)])
    near, off = np.array([0.001, 0.0, 0.0]), np.array([0.02, 0.03, 0.0])
    np.testing.assert_array_equal(
        refine_by_shared_lines(room[::2], room[1::2], near, replace(CONFIG, doubt=0.01)), near
    )
    settled = refine_by_shared_lines(room[::2], room[1::2], off, CONFIG)
    assert 0.0 < np.hypot(*(settled - off)[:2]) <= CONFIG.span + 1e-12
    np.testing.assert_allclose(refine_by_shared_lines(np.empty((0, 2)), room, off, CONFIG), off, atol=1e-9)


def test_noisier_scans_are_looked_at_more_coarsely():
    coarse = CONFIG.coarser(4.0)
    assert (coarse.noise, coarse.span, coarse.step) == (4 * CONFIG.noise, 4 * CONFIG.span, 4 * CONFIG.step)
    assert (coarse.line, coarse.longest) == (CONFIG.line, CONFIG.longest)


@pytest.mark.parametrize("wrong", [{"noise": 0.0}, {"step": -1.0}, {"line": -1.0}, {"longest": 2}])
def test_what_makes_no_sense_is_refused(wrong):
    with pytest.raises(InputError):
        SharedLinesConfig(**wrong)
