"""How far a laser sees, along beams that are the same for all of its scans."""

import numpy as np
import pytest
from tagalong.perception.legs.range_view import Fan, fan_of, seen_in
from tagalong.slam import LaserScan

BEARINGS = np.linspace(-1.0, 1.0, 201)
FAN = Fan(201, -1.0, 0.01)


def scan_of(bearings, ranges=4.0):
    return LaserScan(np.broadcast_to(ranges, len(bearings)), bearings, 0.1, 10.0)


def test_a_scan_along_the_same_beams_is_told_as_it_is():
    scan = scan_of(BEARINGS, np.linspace(1.0, 5.0, 201))
    view = seen_in(scan, (1.0, 2.0, 0.5), FAN)
    np.testing.assert_array_equal(view.ranges, scan.ranges)
    assert (view.first, view.step) == (pytest.approx(-1.0), pytest.approx(0.01))
    assert view.laser == pytest.approx((1.0, 2.0, 0.5))


@pytest.mark.parametrize(
    "bearings",
    [BEARINGS + 0.1, 1.03 * BEARINGS, np.linspace(-1.0, 1.0, 190), BEARINGS + 0.004 * np.sin(9.0 * BEARINGS)],
    ids=["turned", "stretched", "fewer", "bent"],
)
def test_a_scan_along_others_is_told_by_the_nearest_of_its_beams(bearings):
    view = seen_in(scan_of(bearings, 4.0 + bearings), np.zeros(3), FAN)
    assert view.ranges.shape == (201,)
    assert (view.first, view.step) == (-1.0, 0.01)
    known = view.ranges > 0.0
    assert known.sum() == pytest.approx(201 - max(0.0, bearings[0] + 1.0) / 0.01, abs=2)
    assert np.abs(view.ranges - 4.0 - FAN.bearings)[known].max() < 0.02


def test_where_a_scan_has_no_beam_nothing_is_known_and_where_it_met_nothing_it_saw_far():
    bearings, ranges = np.delete(BEARINGS, slice(50, 60)), np.full(191, 4.0)
    ranges[100], ranges[120] = np.inf, np.nan
    view = seen_in(scan_of(bearings, ranges), np.zeros(3), FAN)
    assert set(np.flatnonzero(view.ranges == 0.0)) == {*range(51, 59), 130}
    assert set(np.flatnonzero(view.ranges == 10.0)) == {110}


def test_a_full_circle_may_begin_anywhere():
    fan = Fan(360, -np.pi, np.radians(1.0))
    begun = np.radians(np.arange(360.0)) + 0.1
    view = seen_in(scan_of(begun, 4.0 + np.sin(begun)), np.zeros(3), fan)
    assert np.abs(view.ranges - 4.0 - np.sin(fan.bearings)).max() < 0.01


def test_scans_of_a_tenth_more_beams_may_be_of_the_same_laser():
    assert FAN.may_be_of(scan_of(np.linspace(-1.0, 1.0, 215)))
    assert FAN.may_be_of(scan_of(1.05 * BEARINGS))
    assert not FAN.may_be_of(scan_of(np.linspace(-1.0, 1.0, 101)))
    assert not FAN.may_be_of(scan_of(np.linspace(-2.0, 2.0, 201)))
    assert not FAN.may_be_of(scan_of(np.zeros(0)))


@pytest.mark.parametrize("beams", [0, 1, 2])
def test_scans_of_hardly_any_beams_are_told_too(beams):
    scan = scan_of(0.1 * np.arange(beams))
    fan = fan_of(scan)
    assert fan.may_be_of(scan)
    assert seen_in(scan, np.zeros(3), fan).ranges.tolist() == [4.0] * beams
    assert seen_in(scan_of(np.zeros(0)), np.zeros(3), FAN).ranges.tolist() == [0.0] * 201
