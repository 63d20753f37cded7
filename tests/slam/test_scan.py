"""Ends of beams, against plain numpy."""

import numpy as np
import pytest
from scan_reference import fill_beam_points_reference
from tagalong.slam.errors import InputError
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_kernel import fill_beam_points


def test_ends_of_beams_are_those_of_plain_numpy():
    rng = np.random.default_rng(0)
    ranges, angles = rng.uniform(-1.0, 12.0, 90), np.linspace(-2.0, 2.0, 90)
    ranges[::7], ranges[::11] = np.nan, np.inf
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    ours, theirs = np.empty((90, 2)), np.empty((90, 2))
    fill_beam_points(ranges, directions, 0.1, 10.0, ours)
    fill_beam_points_reference(ranges, directions, 0.1, 10.0, theirs)
    np.testing.assert_array_equal(ours, theirs)
    np.testing.assert_array_equal(LaserScan(ranges, angles, 0.1, 10.0).beam_points, theirs)


def test_points_and_beams_are_those_of_the_returns():
    ranges = np.array([1.0, np.nan, np.inf, 0.01, 30.0, 30.1, -2.0, 2.5])
    scan = LaserScan(ranges, np.linspace(-1.0, 1.0, 8), 0.1, 30.0)
    np.testing.assert_array_equal(scan.beams, [0, 4, 7])
    np.testing.assert_array_equal(scan.beams, np.flatnonzero(scan.is_return))
    np.testing.assert_array_equal(scan.points, scan.beam_points[scan.is_return])


@pytest.mark.parametrize("bearings", [[0.2, 0.1, 0.0], [0.0, 0.1, 0.1], [0.0, np.nan, 0.2], [0.0, 0.1, np.inf]])
def test_bearings_that_do_not_ascend_are_refused(bearings):
    with pytest.raises(InputError, match="`bearings` must be finite and ascending"):
        LaserScan(np.ones(3), np.array(bearings), 0.1, 30.0)


def test_a_scan_may_have_one_beam_or_none():
    assert len(LaserScan(np.ones(1), np.zeros(1), 0.1, 30.0).points) == 1
    assert len(LaserScan(np.zeros(0), np.zeros(0), 0.1, 30.0).points) == 0


def test_a_scan_keeps_nothing_that_is_computed_from_it_and_shares_its_bearings():
    first, second = (LaserScan(np.ones(4), np.arange(4.0) / 2.0, 0.0, 2.0) for _ in range(2))
    before = set(vars(first))
    assert len(first.points) == len(first.points_robot) == len(first.beams) == len(first.beam_points) == 4
    assert set(vars(first)) == before
    assert first.bearings is second.bearings
