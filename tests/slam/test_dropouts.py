"""Beams that are missing from a scan, as lasers lose them, say nothing; beams that met nothing do."""

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.graph.surface import surface_points
from tagalong.slam.scan import LaserScan
from walls import cast

BEARINGS = np.radians(np.linspace(-95.0, 95.0, 529))


def wall(missing, value):
    """Return a scan along a wall at y = -1, met a third of a metre apart, one beam without a return."""
    x = np.arange(1.0, 4.0, 0.3)
    ranges, bearings = np.hypot(x, 1.0), np.arctan2(-1.0, x)
    ranges[missing] = value
    return LaserScan(ranges, bearings, 0.1, 10.0)


@pytest.mark.parametrize("value", [np.nan, 0.0])
def test_a_wall_goes_on_behind_a_missing_beam(value):
    scan = wall(4, value)
    surface, returns = surface_points(scan.beam_points, scan.is_no_return, 0.05)
    assert returns == 9
    along = np.sort(surface[:, 0])
    inner = along[(along > 1.2) & (along < 3.5)]
    assert np.diff(inner).max() < 0.08
    np.testing.assert_allclose(surface[:, 1], -1.0, atol=1e-9)


def test_a_wall_ends_where_a_beam_met_nothing():
    scan = wall(4, np.inf)
    surface, returns = surface_points(scan.beam_points, scan.is_no_return, 0.05)
    assert returns == 9
    assert not ((surface[:, 0] > 1.95) & (surface[:, 0] < 2.45)).any()


def way_gone(length, reach, lost):
    """How far a robot believes to have come that drives 9 m along a smooth corridor of a `length` [m]."""
    rng, slam = np.random.default_rng(1), make_slam("cartographer", global_=None)
    lines = np.array([(-1.0, y, length, y) for y in (-1.2, 1.2)] + [(x, -1.2, x, 1.2) for x in (-1.0, length)])
    for x in np.arange(0.0, 9.01, 0.03):
        exact = cast(lines, np.array([x, 0.0, 0.0]), rng, reach, 0.01, BEARINGS)
        ranges = np.where(rng.random(len(exact)) < lost, np.nan, exact.ranges)
        slam.update([x, 0.0, 0.0], LaserScan(ranges, exact.bearings, 0.1, reach))
    return slam.trajectory()[-1, 0]


def test_a_robot_does_not_stick_to_the_dots_that_missing_beams_leave_of_a_smooth_corridor():
    assert abs(way_gone(25.0, 30.0, 0.2) - 9.0) < 0.05


def test_odometry_says_how_far_along_a_smooth_corridor_whose_end_is_out_of_reach():
    assert abs(way_gone(40.0, 5.0, 0.0) - 9.0) < 0.3
