"""A robot comes as far along a smooth corridor as it drove, though its laser sees nothing but two plain walls."""

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import transform_points
from walls import cast

BEARINGS = np.radians(np.linspace(-95.0, 95.0, 529))


def way_gone(length, reach, heading=0.0):
    """How far a robot believes to have come that drives 9 m along a smooth corridor of a `length` [m]."""
    rng, slam = np.random.default_rng(1), make_slam("cartographer", global_=None)
    lines = np.array([(-1.0, y, length, y) for y in (-1.2, 1.2)] + [(x, -1.2, x, 1.2) for x in (-1.0, length)])
    lines = transform_points((0.0, 0.0, heading), lines.reshape(-1, 2)).reshape(-1, 4)
    for x in np.arange(0.0, 9.01, 0.03):
        pose = np.array([x * np.cos(heading), x * np.sin(heading), heading])
        slam.update(pose, cast(lines, pose, rng, reach, 0.01, BEARINGS))
    slam.finish()
    return np.hypot(*slam.trajectory()[-1, :2])


def test_scans_say_how_far_it_has_come_where_they_see_the_end():
    assert abs(way_gone(25.0, 30.0) - 9.0) < 0.05


@pytest.mark.parametrize("heading", [0.0, np.pi / 4.0])
def test_odometry_says_it_where_the_end_is_out_of_reach(heading):
    assert abs(way_gone(40.0, 5.0, heading) - 9.0) < 0.3
