"""Which direction a scan leaves to the odometry."""

import numpy as np
import pytest
from tagalong.slam.geometry import compose
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_grid.degenerate_direction import degenerate_direction
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridScanMatcher, GridScanMatcherConfig
from tagalong.slam.scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from walls import cast

ALONG = [(-50.0, -1.2, 50.0, -1.2), (-50.0, 1.2, 50.0, 1.2)]
CLOSED = [*ALONG, (3.0, -1.2, 3.0, 1.2)]
BEARINGS = np.radians(np.linspace(-120.0, 120.0, 481))


def way(lines, heading, mount=(0.0, 0.0, 0.0), reach=5.0):
    """What a robot at the origin leaves to the odometry, with a laser of so many metres."""
    foot = compose(np.array([0.0, 0.0, heading]), np.array(mount))
    seen = cast(np.array(lines), foot, np.random.default_rng(0), reach, 0.01, BEARINGS)
    scan = LaserScan(seen.ranges, seen.bearings, 0.1, reach, T_robot_lidar=mount)
    return degenerate_direction(scan, AdaptiveVoxelFilter(AdaptiveVoxelConfig()).apply(scan.points_robot))


@pytest.mark.parametrize("mount", [(0.0, 0.0, 0.0), (-0.2, 0.1, np.pi), (0.1, 0.0, 0.3)])
@pytest.mark.parametrize("heading", [0.0, 0.4, -0.2])
def test_the_way_along_a_corridor_without_end_is_blind(heading, mount):
    found = way(ALONG, heading, mount)
    assert 0.5 < np.hypot(*found) <= 1.0
    across = found @ [np.sin(heading), np.cos(heading)]  # the corridor runs along (cos, -sin) of the heading
    assert abs(across) < 0.05


def test_a_corridor_whose_end_is_seen_is_not():
    assert not way(CLOSED, 0.0).any()
    assert not way(ALONG, 0.0, reach=200.0).any()


def test_nor_is_a_room_with_a_door_nor_a_view_of_nothing():
    room = [(-2.0, -2.0, 2.0, -2.0), (-2.0, 2.0, 2.0, 2.0), (2.0, -2.0, 2.0, -0.4), (2.0, 0.4, 2.0, 2.0)]
    assert not way(room, 0.0).any()
    assert not way([(100.0, 0.0, 100.0, 1.0)], 0.0).any()


class Slope:
    """Walls along the way of a robot that looks up, likelier the farther left."""

    field = np.tile(np.linspace(0.9, 0.1, 80, dtype=np.float32), (80, 1))
    corner, resolution = np.array([-2.0, -2.0]), 0.05


def test_only_along_that_way_the_odometry_is_trusted_more():
    points = np.stack((np.linspace(-1.5, 1.5, 100), np.tile([-0.2, -0.05, 0.05, 0.2], 25)), axis=-1)
    prediction = Prediction(np.array([0.0, 0.0, np.pi / 2]), np.array([0.03, 0.001]))
    matcher = GridScanMatcher(GridScanMatcherConfig())
    shifts = []
    for blind in (None, np.zeros(2), np.array([1.0, 0.0]), np.array([0.0, 1.0])):
        match = matcher.match(Slope(), points, prediction, blind)
        assert match is not None
        shifts.append(float(match.pose[0]))
    assert shifts[0] == shifts[1] < -0.015
    np.testing.assert_allclose(shifts[2], shifts[0], atol=1e-3)  # the robot's x is the map's y
    assert abs(shifts[3]) < 0.1 * abs(shifts[0])
