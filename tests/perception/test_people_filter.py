import numpy as np
from tagalong.perception.people_filter import filter_people
from tagalong.slam.scan import LaserScan


def test_points_near_a_person_are_dropped_and_nothing_is_rewritten():
    bearings = np.linspace(-1.0, 1.0, 201)
    ranges = np.where(np.abs(bearings) < 0.1, 2.0, 5.0)
    ranges[0], ranges[1], ranges[-1] = np.nan, np.inf, 0.0
    scan = LaserScan(ranges, bearings, 0.1, 30.0)
    filtered = filter_people(scan, [[2.1, 0.0]], 0.35)
    dropped = np.abs(bearings) < 0.1
    assert np.isnan(filtered.ranges[dropped]).all()
    assert not filtered.is_no_return[dropped].any()
    np.testing.assert_array_equal(filtered.ranges[~dropped], ranges[~dropped])
    np.testing.assert_array_equal(scan.ranges, ranges)


def test_nobody_means_the_same_scan():
    scan = LaserScan(np.full(11, 3.0), np.linspace(-1, 1, 11), 0.1, 30.0)
    np.testing.assert_array_equal(filter_people(scan, np.zeros((0, 2)), 0.35).ranges, scan.ranges)
