"""Drawn buildings and drives in two dimensions: their geometry is right, and one seed gives the same bytes."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.envs.simulation2d.building_plans import CLEARANCE, KINDS, BuildingPlan, draw_plan
from tagalong.envs.simulation2d.drawn_drives import (
    ODOMETRY,
    Traits,
    draw_drive,
    draw_feet,
    draw_way,
    drive_along,
    take_scan,
    wheel_odometry,
)
from tagalong.envs.simulation2d.outlines import Outlines, cast
from tagalong.envs.simulation2d.sweep_kernel import sweep
from tagalong.slam import InputError
from tagalong.slam.geometry import between

TRAITS = Traits(
    reach=6.0, view_deg=360.0, beams=360, noise=0.0, missing=0.0, mount=0.0,
    interval_s=0.2, speed=0.5, way=10.0, odometry="good", people=0,
)  # fmt: skip
NOBODY = np.zeros((0, 3))


def square_room(side=10.0):
    out = Outlines()
    out.polygon(np.array([(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)]))
    return BuildingPlan(out, np.full(2, side / 2.0))


def scan_of(plan, pose, traits=TRAITS, feet=NOBODY):
    return take_scan(plan.outlines.arrays(), np.array([pose]), feet, traits, 0.0, np.random.default_rng(0))


def test_rays_meet_an_ellipse_and_a_segment_where_geometry_says():
    outlines = Outlines()
    outlines.ellipse(np.array([3.0, 0.0]), 1.0, 0.5, heading=np.pi / 2)
    outlines.segment(np.array([-2.0, -1.0]), np.array([-2.0, 1.0]))
    ranges, met = cast(np.zeros((3, 2)), np.array([0.0, np.pi, np.pi / 2]), 10.0, *outlines.arrays())
    np.testing.assert_allclose(ranges, [2.5, 2.0, np.inf])
    np.testing.assert_array_equal(met, [0, 1, -1])


def test_an_empty_square_room_gives_the_ranges_that_geometry_says():
    scan = scan_of(square_room(), (5.0, 5.0, 0.3))
    angles = scan.bearings + 0.3
    exact = 5.0 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    np.testing.assert_allclose(scan.ranges[exact < 6.0], exact[exact < 6.0], atol=1e-9)
    assert scan.is_no_return[exact > 6.0].all()
    assert 0 < scan.is_no_return.sum() < 360


def test_a_laser_before_the_centre_measures_from_there():
    scan = scan_of(square_room(), (5.0, 5.0, 0.0), replace(TRAITS, mount=0.2, view_deg=180.0, beams=181))
    assert scan.ranges[90] == pytest.approx(4.8)
    assert scan.T_robot_lidar == (0.2, 0.0, 0.0)


def test_a_person_is_met_where_the_feet_are_and_missing_beams_know_nothing():
    scan = scan_of(square_room(), (5.0, 5.0, 0.0), replace(TRAITS, beams=361), np.array([(7.0, 5.0, 0.1)]))
    assert scan.ranges[180] == pytest.approx(1.9)
    assert scan.ranges[0] == pytest.approx(5.0, abs=1e-3)
    lost = scan_of(square_room(), (5.0, 5.0, 0.0), replace(TRAITS, missing=0.2))
    assert 0.1 < np.isnan(lost.ranges).mean() < 0.3


@pytest.mark.parametrize("seed", range(5))
def test_a_sweep_by_sectors_meets_what_each_beam_meets(seed):
    rng, out = np.random.default_rng(seed), Outlines()
    for _ in range(30):
        out.box(rng.uniform(-8.0, 8.0, 2), *rng.uniform(0.1, 3.0, 2), rng.uniform(0.0, np.pi))
        out.ellipse(rng.uniform(-8.0, 8.0, 2), *rng.uniform(0.05, 1.0, 2), rng.uniform(0.0, np.pi))
    angles = rng.uniform(-9.0, 9.0) + np.linspace(0.0, rng.choice([3.0, 6.25]), 400)
    wanted, _ = cast(np.zeros((400, 2)), angles, 7.0, *out.arrays())
    np.testing.assert_array_equal(sweep(0.0, 0.0, angles, 7.0, *out.arrays()), wanted)


@pytest.mark.parametrize("kind", KINDS)
def test_nearly_all_free_space_of_a_floor_can_be_driven(kind):
    for seed in range(3):
        plan = draw_plan(kind, np.random.default_rng(seed))
        wide = plan.space.clearance >= CLEARANCE
        assert plan.planner.area > 0.85 * wide.sum() * plan.space.resolution**2
        assert plan.space.free[plan.space.index(plan.inside)]
        border = np.concatenate((plan.space.free[[0, -1]].ravel(), plan.space.free[:, [0, -1]].ravel()))
        assert not border.any()  # nothing leads out of the building


def test_every_room_of_a_grid_of_rooms_can_be_reached():
    for seed in range(3):
        plan = draw_plan("cells", np.random.default_rng(seed))
        side = 2.0 * plan.inside[0]
        _, segments = plan.outlines.arrays()
        count = np.rint(segments[:4, [0, 2]].max() / side), np.rint(segments[:4, [1, 3]].max() / side)
        x, y = plan.planner.places.T
        rooms = set(zip((x // side).astype(int).tolist(), (y // side).astype(int).tolist(), strict=True))
        assert len(rooms) == count[0] * count[1]


def test_the_robot_keeps_clear_of_the_walls_and_comes_back_to_places():
    plan = draw_plan("office", np.random.default_rng(3))
    way = draw_way(plan, 150.0, np.random.default_rng(4))
    poses = drive_along(way, 0.8, 0.0)
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    assert plan.space.clearance_at(poses[:, :2]).min() > 0.05
    assert steps.max() <= 0.8 * 0.05 + 1e-9
    assert steps.sum() > 100.0
    starts = np.unique(way, axis=0, return_counts=True)[1]
    assert (starts > 1).any()  # a place that was drawn once more begins a leg again, to the bit


def test_one_seed_gives_the_same_bytes_and_another_another_world():
    first, again, other = draw_drive("cells", 1), draw_drive("cells", 1), draw_drive("cells", 2)
    assert first.traits == again.traits
    assert first.traits != other.traits
    assert first.recording.odometry.tobytes() == again.recording.odometry.tobytes()
    assert first.truth.tobytes() == again.truth.tobytes()
    for a, b in zip(first.recording.scans, again.recording.scans, strict=True):
        assert a.ranges.tobytes() == b.ranges.tobytes()
        assert a.time_s == b.time_s


def test_a_spinning_laser_measures_each_beam_where_the_robot_is_by_then():
    plan, way = square_room(), np.array([(5.0, 5.0, 0.0), (5.0, 5.0, 0.2), (5.4, 5.0, 0.2)])
    scan = take_scan(plan.outlines.arrays(), way, NOBODY, TRAITS, 0.0, np.random.default_rng(0))
    turned = scan.bearings + np.minimum(0.4 * (scan.bearings + np.pi) / (2.0 * np.pi), 0.2)
    moved = np.maximum(0.8 * scan.bearings / (2.0 * np.pi), 0.0)
    x = np.where(np.cos(turned) > 0.0, 5.0 - moved, 5.0 + moved) / np.abs(np.cos(turned))
    exact = np.minimum(x, 5.0 / np.abs(np.sin(turned)))
    near = exact < 5.9
    np.testing.assert_allclose(scan.ranges[near], exact[near], atol=0.02)


def test_a_drive_with_a_spinning_laser_has_scans_at_five_hertz_at_least():
    drive = draw_drive("cells", 1, spinning=True)
    assert np.diff(drive.recording.times_s).max() <= 0.2 + 1e-9
    assert len(drive.recording) <= 2500


def test_people_walk_and_step_aside_for_the_robot():
    plan, times = square_room(), np.arange(0.0, 60.0, 0.1)
    truth = np.tile((5.0, 5.0, 0.0), (len(times), 1))
    feet = draw_feet(plan, truth, times, 3, np.random.default_rng(0))
    assert feet.shape == (600, 6, 3)
    middles = 0.5 * (feet[:, ::2, :2] + feet[:, 1::2, :2])
    assert (np.ptp(middles, axis=0).max(axis=1) > 2.0).all()
    steps = np.hypot(*np.diff(middles, axis=0).transpose(2, 0, 1))
    assert np.quantile(steps, 0.95) < 0.15  # at 1.4 m/s at most, but round the robot
    assert np.hypot(*(middles - 5.0).transpose(2, 0, 1)).min() >= 0.5 - 1e-9
    assert draw_feet(plan, truth, times, 0, np.random.default_rng(0)).shape == (600, 0, 3)


def test_bad_odometry_is_worse_than_typical_and_that_than_good():
    motion = drive_along(draw_way(square_room(), 100.0, np.random.default_rng(0)), 0.5, 0.0)
    errors = []
    for name in ("good", "typical", "bad"):
        off = []
        for seed in range(10):
            said = wheel_odometry(motion, 10, ODOMETRY[name], np.random.default_rng(seed))
            assert len(said) == len(motion[::10])
            off.append(np.hypot(*(between(said[0], said) - between(motion[0], motion[::10]))[:, :2].T).mean())
        errors.append(np.mean(off))
    assert 3.0 * errors[0] < errors[1]
    assert 2.0 * errors[1] < errors[2]


def test_slips_come_on_top_of_what_the_wheels_believe():
    motion = drive_along(draw_way(square_room(), 100.0, np.random.default_rng(0)), 0.5, 0.0)
    slipping = replace(ODOMETRY["good"], slip_every=20.0, slip_way=0.3, slip_turn=0.2)
    plain = wheel_odometry(motion, 10, ODOMETRY["good"], np.random.default_rng(1))
    slipped = wheel_odometry(motion, 10, slipping, np.random.default_rng(1))
    more = np.abs(between(slipped[:-1], slipped[1:])[:, 2] - between(plain[:-1], plain[1:])[:, 2])
    assert 1 <= (more > 0.1).sum() <= 15


def test_a_kind_of_building_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match="unknown kind of building 'barn'; "):
        draw_plan("barn", np.random.default_rng(0))
