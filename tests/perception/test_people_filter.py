from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.perception.hindsight import filtered_scans
from tagalong.perception.legs.detector import Detections
from tagalong.perception.people_filter import (
    FilteredScan,
    PeopleFilter,
    RemovalConfig,
    near_points,
    points_lidar,
)
from tagalong.slam import LaserScan, RecordedDrive


def test_points_near_a_person_are_dropped_and_nothing_is_rewritten():
    bearings = np.linspace(-1.0, 1.0, 201)
    ranges = np.where(np.abs(bearings) < 0.1, 2.0, 5.0)
    ranges[0], ranges[1], ranges[-1] = np.nan, np.inf, 0.0
    scan = LaserScan(ranges, bearings, 0.1, 30.0)
    filtered = scan.without(near_points(scan, [[2.1, 0.0]], 0.35))
    dropped = np.abs(bearings) < 0.1
    assert np.isnan(filtered.ranges[dropped]).all()
    assert not filtered.is_no_return[dropped].any()
    np.testing.assert_array_equal(filtered.ranges[~dropped], ranges[~dropped])
    np.testing.assert_array_equal(scan.ranges, ranges)


def test_nobody_means_the_same_scan():
    scan = LaserScan(np.full(11, 3.0), np.linspace(-1, 1, 11), 0.1, 30.0)
    np.testing.assert_array_equal(scan.without(near_points(scan, np.zeros((0, 2)), 0.35)).ranges, scan.ranges)


def test_unconfirmed_legs_are_the_clusters_that_look_like_legs():
    scan = LaserScan(np.full(11, 3.0), np.linspace(-1, 1, 11), 0.1, 30.0, T_robot_lidar=(0.2, 0.1, np.pi / 2))
    positions, confidence = np.array([[1.0, 0.0], [2.0, 0.0], [0.2, 3.1]]), np.array([0.49, 0.5, 0.9])
    found = Detections(positions, confidence, confidence >= 0.3, clusters=None)
    filtered = FilteredScan(scan, np.zeros(3), None, found, RemovalConfig(unconfirmed_confidence=0.5))
    np.testing.assert_array_equal(filtered.unconfirmed_legs, positions[1:])
    np.testing.assert_allclose(points_lidar(scan, filtered.unconfirmed_legs), [[-0.1, -1.8], [3.0, 0.0]], atol=1e-12)
    none = FilteredScan(scan, np.zeros(3), None, found, RemovalConfig(unconfirmed_confidence=0.95))
    assert none.unconfirmed_legs.shape == (0, 2)


def test_people_are_placed_in_the_frame_of_the_laser():
    scan = LaserScan(np.full(11, 3.0), np.linspace(-1, 1, 11), 0.1, 30.0, T_robot_lidar=(0.2, 0.0, 0.0))
    points = np.array([[1.0, 3.0], [1.0, 4.0]])
    np.testing.assert_allclose(points_lidar(scan, points, (1.0, 1.0, np.pi / 2)), [[1.8, 0], [2.8, 0]], atol=1e-12)


def test_a_filtered_scan_drops_who_is_known_and_who_may_be_somebody_each_by_its_own_distance():
    bearings = np.radians([-60.0, -3.0, 0.0, 30.0, 33.0, 60.0])
    scan = LaserScan(np.full(6, 4.0), bearings, 0.1, 30.0)
    ends = scan.beam_points
    people = SimpleNamespace(points=ends[2:3])
    confidence = np.array([0.5, 0.49])
    found = Detections(ends[[3, 5]], confidence, confidence >= 0.3, clusters=None)
    config = RemovalConfig(zeta=0.25, unconfirmed_radius=0.1, unconfirmed_confidence=0.5)
    filtered = FilteredScan(scan, np.zeros(3), people, found, config)
    np.testing.assert_array_equal(filtered.removed, [False, True, True, True, False, False])
    np.testing.assert_array_equal(np.isnan(filtered.without_people.ranges), filtered.removed)
    np.testing.assert_array_equal(filtered.scan.ranges, 4.0)
    as_the_paper = FilteredScan(scan, np.zeros(3), people, found, RemovalConfig(zeta=0.25, unconfirmed_radius=0.0))
    np.testing.assert_array_equal(as_the_paper.removed, [False, True, True, False, False, False])


def room_from(x, time_s):
    """A scan of a room of 8 m by 5 m, taken at (x, 0) with the robot looking along x."""
    bearings = np.linspace(-2.3, 2.3, 461)
    cos, sin = np.cos(bearings), np.sin(bearings)
    along = np.where(cos > 0.0, 5.0 - x, 3.0 + x) / np.maximum(np.abs(cos), 1e-9)
    across = np.where(sin > 0.0, 3.0, 2.0) / np.maximum(np.abs(sin), 1e-9)
    return LaserScan(np.minimum(along, across), bearings, 0.1, 11.0, time_s=time_s)


def test_without_odometry_the_robots_way_is_made_of_the_scans():
    people_filter = PeopleFilter()
    for k in range(12):
        filtered = people_filter.update(room_from(0.1 * k, 0.1 * k))
    np.testing.assert_allclose(filtered.odometry, (1.1, 0.0, 0.0), atol=0.03)


@pytest.mark.parametrize(("made", "way"), [(0.0, 1.1), (0.5, 5.5)])
def test_a_drive_without_odometry_gets_it_from_its_scans_unless_somebody_has_made_it(made, way):
    scans = [room_from(0.1 * k, 0.1 * k) for k in range(12)]
    poses = np.array([[made * k, 0.0, 0.0] for k in range(12)])
    *_, last = filtered_scans(RecordedDrive(poses, scans, None, "room", has_odometry=False))
    np.testing.assert_allclose(last.odometry, (way, 0.0, 0.0), atol=0.03)
