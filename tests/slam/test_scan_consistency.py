"""Scans of a drive are consistent from one to the next; a kidnapping breaks that, people who walk hardly do."""

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose, inverse, transform_points
from tagalong.slam.graph.recovery.scan_consistency import (
    ScanConsistency,
    ScanConsistencyConfig,
    contradiction,
    looked_through,
)
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig
from walls import cast

ROOM = np.array([(-5, -3, 5, -3), (5, -3, 5, 3), (5, 3, -5, 3), (-5, 3, -5, -3), (1, -1, 1, 1), (-2, 3, -2, 1)], float)
CIRCLE = np.deg2rad(np.arange(-180.0, 180.0, 1.0))


def test_of_a_drive_through_a_still_room_all_scans_are_consistent():
    rng, consistency = np.random.default_rng(0), ScanConsistency(ScanConsistencyConfig(), ExtrapolatorConfig())
    poses = [np.array([-4.0 + 0.08 * k, -2.0 + 0.3 * np.sin(0.1 * k), 0.3 * np.cos(0.1 * k)]) for k in range(100)]
    assert [consistency.inconsistency(cast(ROOM, pose, rng), pose, pose) for pose in poses] == [0.0] * 100


TURN, AWAY = np.array([0.0, 0.0, 0.1]), np.array([2.0, 1.5, 0.8])


@pytest.mark.parametrize(
    ("odometry_off", "match_off", "inconsistent"),
    [(0.0 * TURN, AWAY, 0), (TURN, 0.0 * TURN, 0), (TURN, AWAY, 1), (AWAY, 0.0 * TURN, 1), (AWAY, AWAY, 1)],
)
def test_a_scan_is_consistent_by_the_odometry_or_by_a_match_that_the_odometry_may_have_led_to(
    odometry_off, match_off, inconsistent
):
    rng, consistency = np.random.default_rng(0), ScanConsistency(ScanConsistencyConfig(), ExtrapolatorConfig())
    poses = [np.array([-3.0, -2.0, 0.0]), np.array([-2.9, -2.0, 0.1])]
    assert consistency.inconsistency(cast(ROOM, poses[0], rng), poses[0], poses[0]) == 0.0
    share = consistency.inconsistency(cast(ROOM, poses[1], rng), poses[1] + odometry_off, poses[1] + match_off)
    assert (share > 0.0) == bool(inconsistent)


def test_a_kidnapping_is_one_inconsistency_by_the_share_that_contradicts():
    rng, consistency = np.random.default_rng(0), ScanConsistency(ScanConsistencyConfig(), ExtrapolatorConfig())
    here, there = np.array([-4.0, -2.0, 0.0]), np.array([3.0, 2.0, 2.0])
    shares = [
        consistency.inconsistency(cast(ROOM, true, rng), here, here) for true in (here, here, there, there, there)
    ]
    scans = [cast(ROOM, true, np.random.default_rng(0)) for true in (here, there)]
    assert shares[2] == pytest.approx(contradiction(*scans, np.zeros(3), 0.4), abs=0.03)
    assert shares[2] > 0.3
    assert shares[:2] + shares[3:] == [0.0] * 4


def test_what_always_contradicts_is_usual_and_a_suspect_scan_needs_half_as_much():
    rng, config = np.random.default_rng(0), ScanConsistencyConfig()
    still = cast(ROOM, np.zeros(3), rng)

    def flickering(share):
        near = rng.permutation(len(still))[: round(share * len(still))]
        return LaserScan(np.where(np.isin(np.arange(len(still)), near), 0.3, still.ranges), still.bearings, 0.05, 20.0)

    consistency, pose = ScanConsistency(config, ExtrapolatorConfig()), np.zeros(3)
    for _ in range(200):
        consistency.inconsistency(flickering(0.1), pose, pose)
    assert consistency.inconsistency(flickering(0.1), pose, pose) == 0.0
    assert consistency.inconsistency(flickering(0.4), pose, pose) > 0.1
    for suspect in (False, True):
        fresh = ScanConsistency(config, ExtrapolatorConfig())
        fresh.inconsistency(still, pose, pose)
        assert (fresh.inconsistency(flickering(0.03), pose, pose, suspect=suspect) > 0.0) == suspect


def test_a_person_beside_the_robot_contradicts_little_and_beams_without_a_return_nothing():
    rng, pose = np.random.default_rng(0), np.array([-4.0, -2.0, 0.0])
    legs = np.array([(-3.0, -2.0, -3.0, -1.85), (-3.0, -1.6, -3.0, -1.45)])
    before, after = cast(ROOM, pose, rng), cast(np.concatenate((ROOM, legs)), pose, rng)
    share = contradiction(before, after, np.zeros(3), 0.4)
    assert 0.01 < share < 0.06
    unknown = before.without(np.ones(len(before), dtype=np.bool_))
    nothing = LaserScan(np.full(len(before), np.inf), before.bearings, 0.05, 20.0)
    assert contradiction(unknown, after, np.zeros(3), 0.4) == 0.0
    assert contradiction(nothing, after, np.zeros(3), 0.4) == 0.0


def test_the_kernel_counts_what_lies_before_the_beams_on_both_sides():
    rng = np.random.default_rng(0)
    for bearings in (CIRCLE, np.deg2rad(np.arange(-90.0, 91.0, 2.0)), CIRCLE + np.pi):
        ranges = rng.uniform(0.5, 9.0, len(bearings))
        ranges[rng.random(len(ranges)) < 0.1] = np.nan
        mount, motion, points = rng.uniform(-1.0, 1.0, 3), rng.uniform(-1.0, 1.0, 3), rng.uniform(-6.0, 6.0, (200, 2))
        expected, step = 0, bearings[1] - bearings[0]
        for x, y in transform_points(compose(inverse(mount), motion), points):
            place = ((np.arctan2(y, x) - bearings[0]) % (2.0 * np.pi)) / step
            if int(place) + 1 < len(bearings):
                ends = ranges[int(place) : int(place) + 2]
                expected += bool((ends <= 8.0).all() and (np.hypot(x, y) < ends - 0.4).all())
        assert 5 < expected < 190
        assert looked_through(bearings, ranges, 8.0, mount, points, motion, 0.4) == expected


def test_two_lasers_mounted_apart_see_one_room():
    rng, mount, poses = np.random.default_rng(0), np.array([0.3, 0.1, 0.5]), ((-4.0, -2.0, 0.0), (-3.8, -2.0, 0.2))
    before, after = (cast(ROOM, compose(np.array(pose), mount), rng) for pose in poses)
    before, after = (
        LaserScan(scan.ranges, scan.bearings, 0.05, 20.0, 0.0, (0.3, 0.1, 0.5)) for scan in (before, after)
    )
    motion = between(np.array(poses[0]), np.array(poses[1]))
    assert contradiction(before, after, motion, 0.4) == 0.0
    assert contradiction(before, after, motion + np.array([1.5, 0.0, 0.0]), 0.4) > 0.05


def test_settings_without_sense_are_refused():
    with pytest.raises(InputError, match="slack"):
        ScanConsistencyConfig(slack=0.0)
