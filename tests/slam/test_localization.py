"""Localization on maps of synthetic buildings: found where it can be, "not sure" where it cannot."""

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.grid import GridConfig, render_map
from tagalong.slam.localization.beam_fit import BeamFit, BeamFitConfig
from tagalong.slam.localization.localizer import Localizer, LocalizerConfig, State
from tagalong.slam.localization.place_map import PlaceMap, PlaceMapConfig
from tagalong.slam.localization.whole_drive import smooth_drive
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.occupancy_map import OccupancyMap
from tagalong.slam.scan import LaserScan
from walls import BEARINGS, cast


def walls(*corners, closed=True):
    ends = [*corners[1:], corners[0]] if closed else corners[1:]
    return [(*a, *b) for a, b in zip(corners, ends, strict=False)]


OUTLINE = walls((-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0))
SYMMETRIC = np.array(
    OUTLINE
    + walls((1.0, 1.5), (2.2, 1.5), (2.2, 2.3), (1.0, 2.3))
    + walls((-1.0, -1.5), (-2.2, -1.5), (-2.2, -2.3), (-1.0, -2.3))
)
ROOM = np.array(
    walls((-4.0, -3.0), (4.0, -3.0), (4.0, 1.0), (2.5, 1.0), (2.5, 3.0), (-4.0, 3.0))
    + walls((1.0, 1.2), (1.8, 1.2), (1.8, 2.0), (1.0, 2.0))
    + walls((-3.0, 1.5), (-2.0, 1.5), (-2.6, 2.5))
)
CORRIDOR = np.array(walls((-30.0, -1.0), (30.0, -1.0), (30.0, 1.0), (-30.0, 1.0)))


def drawn(lines, poses, resolution=0.05, reach=20.0):
    """Return the map that scans from all `poses`, turned to all sides, draw."""
    rng = np.random.default_rng(1)
    turned = np.array([[x, y, heading] for x, y in poses for heading in (0.0, 1.6, 3.1, -1.6)])
    scans = [cast(lines, pose, rng, reach) for pose in turned]
    return render_map(turned, scans, GridConfig(resolution=resolution))


PLACES = [(x, y) for x in np.arange(-3.0, 3.1, 1.5) for y in (-0.8, 0.0, 0.8)]


@pytest.fixture(scope="module")
def room():
    return drawn(ROOM, PLACES)


BY_ODOMETRY = LocalizerConfig(local=None)


def driven(localizer, lines, start, motion, count, rng, reach=20.0, odometry=(0.0, 0.0, 0.0)):
    """Return the updates and true poses of a drive from `start` with `motion` a scan."""
    pose, odometry, updates, poses = np.array(start), np.array(odometry), [], []
    for _ in range(count):
        updates.append(localizer.update(odometry, cast(lines, pose, rng, reach)))
        poses.append(pose)
        pose = compose(pose, motion)
        odometry = compose(odometry, np.array(motion) * 1.03)
    return updates, poses


def led(start, motions):
    """Return the poses of a robot that moves so from `start`."""
    poses = [np.array(start)]
    for motion in motions:
        poses.append(compose(poses[-1], motion))
    return poses


def error(update, pose):
    return error_of(update.pose, pose)


def error_of(found, pose):
    moved = between(pose, found)
    return np.hypot(moved[0], moved[1]), abs(moved[2])


def test_a_robot_that_knows_nothing_is_found_and_tracked(room):
    rng = np.random.default_rng(0)
    for start in ((-2.8, -0.5, 0.4), (0.2, 0.7, -2.9), (2.9, -1.0, 1.7), (0.0, -2.0, 3.0)):
        updates, poses = driven(Localizer(room), ROOM, start, (0.05, 0.0, 0.05), 15, rng)
        sure = [u.state is State.TRACKING for u in updates]
        assert True in sure[:3]
        assert all(sure[sure.index(True) :])
        for update, pose in zip(updates[2:], poses[2:], strict=True):
            distance, turn = error(update, pose)
            assert distance < 0.05
            assert turn < np.deg2rad(1.0)


def test_wheels_that_slip_lead_no_robot_astray_that_local_slam_follows(room):
    start, step, away = np.array((-2.8, -2.0, 0.0)), np.array((0.08, 0.0, 0.03)), {}
    for config in (None, BY_ODOMETRY):
        rng, pose, wheels = np.random.default_rng(1), start, np.zeros(3)
        localizer, truth, scans = Localizer(room, config, start, keep_history=True), [], []
        for k in range(40):
            truth.append(pose)
            scans.append(cast(ROOM, pose, rng))
            localizer.update(wheels, scans[-1])
            pose = compose(pose, step)
            wheels = compose(wheels, step * (3.0 if k % 10 in (5, 6, 7) else 0.3))
        sure = np.isfinite(localizer.trajectory()[:, 0])
        off = between(np.array(truth), np.nan_to_num(localizer.trajectory()))[sure]
        away[config] = sure.mean(), np.hypot(off[:, 0], off[:, 1]).max()
        if config is None:
            moved, motion = between(truth[0], np.array(truth)), localizer.odometry()
            assert np.abs(moved - between(motion[0], motion)).max() < 0.1
            whole = smooth_drive(localizer, RecordedDrive(motion, scans, None, "slips")).trajectory
            assert np.abs(whole - np.array(truth)).max() < 0.1
    assert away[None][0] > 0.95
    assert away[None][1] < 0.1
    assert away[BY_ODOMETRY][0] < 0.9 or away[BY_ODOMETRY][1] > 0.1


def test_a_given_start_needs_no_search_even_in_a_symmetric_room():
    rng = np.random.default_rng(0)
    start = np.array([-2.0, 0.0, 0.3])
    localizer = Localizer(drawn(SYMMETRIC, PLACES), start=start + np.array([0.15, -0.1, 0.05]))
    updates, poses = driven(localizer, SYMMETRIC, start, (0.05, 0.0, 0.03), 8, rng)
    assert all(u.belief is None and u.matched for u in updates)
    assert max(error(u, pose)[0] for u, pose in zip(updates, poses, strict=True)) < 0.05


def test_in_a_room_that_looks_the_same_when_turned_there_is_never_a_pose():
    rng = np.random.default_rng(0)
    localizer = Localizer(drawn(SYMMETRIC, PLACES))
    updates, poses = driven(localizer, SYMMETRIC, (-2.0, 0.0, 0.3), (0.1, 0.0, 0.04), 25, rng)
    for update, pose in zip(updates, poses, strict=True):
        assert update.pose is None
        assert update.state is State.SEARCHING
        assert update.belief is not None
        assert update.belief.ratio < 20.0
        there = [np.hypot(*between(pose, q)[:2]) < 0.1 for q in update.belief.poses[:2]]
        mirrored = [np.hypot(*(pose[:2] + q[:2])) < 0.1 for q in update.belief.poses[:2]]
        assert sorted(there) == sorted(mirrored) == [False, True]
    assert np.isnan(localizer.trajectory()).all()
    assert localizer.pose is None


def test_in_the_middle_of_a_smooth_corridor_it_is_not_sure_but_at_an_end_with_a_door_it_is():
    rng = np.random.default_rng(0)
    doors = np.array(CORRIDOR.tolist() + walls((28.0, 1.0), (28.0, 0.0), (29.0, 0.0), closed=False))
    grid = drawn(doors, [(x, 0.0) for x in np.arange(-29.0, 29.0, 2.0)], reach=8.0)
    updates, _ = driven(Localizer(grid), doors, (-5.0, 0.1, 0.02), (0.1, 0.0, 0.0), 20, rng, reach=8.0)
    assert all(update.pose is None for update in updates)
    updates, poses = driven(Localizer(grid), doors, (24.0, 0.1, 0.02), (0.2, 0.0, 0.0), 10, rng, reach=8.0)
    assert updates[-1].pose is not None
    assert error(updates[-1], poses[-1])[0] < 0.1


def test_at_the_edge_of_the_map_it_is_found_although_half_of_what_it_sees_is_not_mapped(room):
    rng = np.random.default_rng(0)
    probability = room.probability.copy()
    probability[:, int((1.2 - room.origin[0]) / room.resolution) :] = np.nan
    part = OccupancyMap(probability, room.resolution, room.origin)
    assert part.known.mean() < 0.8 * room.known.mean()
    for start in ((0.0, 0.8, 0.4), (-0.5, -1.0, -0.5)):
        updates, poses = driven(Localizer(part), ROOM, start, (0.05, 0.0, 0.05), 30, rng)
        assert all(
            error_of(u.belief.poses[0], pose)[0] < 0.1 for u, pose in zip(updates, poses, strict=True) if u.belief
        )
        assert updates[-1].pose is not None
        assert error(updates[-1], poses[-1])[0] < 0.1


def test_a_robot_beyond_the_end_of_the_map_is_nowhere_on_it(room):
    """Some place on the map fits best: it must fit better than the unknown would."""
    probability = room.probability.copy()
    probability[:, int((-2.0 - room.origin[0]) / room.resolution) :] = np.nan
    part = OccupancyMap(probability, room.resolution, room.origin)
    for seed in range(3):
        rng = np.random.default_rng(seed)
        start = (2.5, rng.uniform(-2.0, 0.0), rng.uniform(-3.0, 3.0))
        updates, _ = driven(Localizer(part), ROOM, start, (0.05, 0.0, 0.06), 60, rng)
        assert all(update.pose is None for update in updates)


def test_what_places_explain_stays_theirs_when_they_are_sorted(room):
    hypotheses = (localizer := Localizer(room)).hypotheses
    localizer.update(np.zeros(3), cast(ROOM, np.array((-2.8, -0.5, 0.4)), np.random.default_rng(0)))
    assert len(hypotheses) > 3
    np.testing.assert_allclose(hypotheses._known + hypotheses._misfits, np.log(2.0))  # one scan: known is the rest


def test_a_given_start_holds_where_half_of_what_it_sees_is_not_mapped(room):
    probability = room.probability.copy()
    probability[:, int((-1.0 - room.origin[0]) / room.resolution) :] = np.nan
    start = np.array((-1.4, 0.2, 0.0))
    update = Localizer(OccupancyMap(probability, room.resolution, room.origin), start=start).update(
        np.zeros(3), cast(ROOM, start, np.random.default_rng(0))
    )
    assert update.explained is not None
    assert update.explained < 0.7
    assert update.pose is not None
    assert error(update, start)[0] < 0.1


def test_after_a_jump_it_says_that_it_is_lost_and_finds_itself_within_ten_scans(room):
    rng = np.random.default_rng(0)
    localizer = Localizer(room, start=(-2.8, -0.5, 0.4))
    before, _ = driven(localizer, ROOM, (-2.8, -0.5, 0.4), (0.05, 0.0, 0.0), 6, rng)
    assert all(update.matched for update in before)
    here = (0.31, 0.0, 0.0)
    updates, poses = driven(localizer, ROOM, (2.8, 0.8, -2.0), (0.05, 0.0, 0.02), 10, rng, odometry=here)
    assert localizer.lost == 1
    assert updates[-1].pose is not None
    assert error(updates[-1], poses[-1])[0] < 0.05


def test_scans_of_another_building_are_never_given_a_pose(room):
    rng = np.random.default_rng(0)
    other = np.array(
        walls((-9.0, -1.0), (2.0, -1.0), (2.0, -6.0), (4.0, -6.0), (4.0, 5.0), (2.0, 5.0), (2.0, 1.0), (-9.0, 1.0))
    )
    updates, _ = driven(Localizer(room), other, (-4.0, 0.0, 0.0), (0.1, 0.0, 0.0), 12, rng)
    assert all(update.pose is None for update in updates)


def test_scans_that_say_nothing_lose_the_robot_only_after_some_way(room):
    blank = LaserScan(np.full(len(BEARINGS), np.inf), BEARINGS, 0.05, 20.0)
    broken = LaserScan(np.full(len(BEARINGS), np.nan), BEARINGS, 0.05, 20.0)
    localizer = Localizer(room, start=(-2.8, -0.5, 0.0))
    for x in np.arange(0.0, 5.0, 0.5):
        update = localizer.update((x, 0.0, 0.0), broken if x else blank)
        assert update.pose is not None
        assert not update.matched
        assert update.explained is None
        np.testing.assert_allclose(update.pose, (-2.8 + x, -0.5, 0.0))
    assert localizer.update((9.0, 0.0, 0.0), blank).pose is None
    assert localizer.update((9.5, 0.0, 0.0), blank).state is State.SEARCHING


@pytest.mark.parametrize("resolution", [0.02, 0.1])
def test_the_maps_resolution_does_not_matter(resolution):
    rng = np.random.default_rng(0)
    updates, poses = driven(
        Localizer(drawn(ROOM, PLACES, resolution)), ROOM, (-2.8, -0.5, 0.4), (0.05, 0.0, 0.05), 5, rng
    )
    assert updates[-1].pose is not None
    assert error(updates[-1], poses[-1])[0] < 0.06


@pytest.mark.parametrize("resolution", [0.05, 0.1])
def test_two_cells_beside_all_walls_a_scan_fits_no_better_than_in_the_unknown(resolution):
    fit = BeamFit(PlaceMap(drawn(ROOM, PLACES, resolution)), BeamFitConfig())
    points = cast(ROOM, np.zeros(3), np.random.default_rng(3), 20.0).points_robot
    aside = 2.0 * max(resolution, BeamFitConfig().sigma)
    misfits, _ = fit.judge(
        fit.sight(np.zeros(3), points, np.zeros(2)), np.array([(0.0, 0.0, 0.0), (aside, aside, 0.0)])
    )
    assert misfits[0] < 0.5 * fit.unseen < fit.unseen < misfits[1]


def test_two_runs_are_equal_to_the_byte(room):
    paths = []
    for _ in range(2):
        localizer = Localizer(room)
        driven(localizer, ROOM, (0.2, 0.7, -2.9), (0.05, 0.0, 0.05), 6, np.random.default_rng(3))
        paths.append(localizer.trajectory().tobytes())
    assert paths[0] == paths[1]


def test_a_robot_that_was_pushed_aside_knows_it_by_its_scans_and_without_local_slam_is_not_sure(room):
    start = (0.0, -1.0, 0.0)
    for away, turn in ((0.3, 0.25), (0.4, -0.25), (0.5, 0.2)):
        rng = np.random.default_rng(0)
        localizer = Localizer(room, start=start)
        driven(localizer, ROOM, start, (0.0, 0.0, 0.0), 4, rng)
        pushed = compose(np.array(start), np.array([0.0, away, turn]))
        updates, poses = driven(localizer, ROOM, pushed, (0.0, 0.0, 0.02), 14, rng)
        assert max(error(update, pose)[0] for update, pose in zip(updates, poses, strict=True)) < 0.1
        localizer = Localizer(room, BY_ODOMETRY, start)
        driven(localizer, ROOM, start, (0.0, 0.0, 0.0), 4, rng)
        updates, poses = driven(localizer, ROOM, pushed, (0.0, 0.0, 0.02), 40, rng)
        sure = [k for k, update in enumerate(updates) if update.belief is not None and update.pose is not None]
        assert len(sure) == 1
        for update, pose in zip(updates[sure[0] :], poses[sure[0] :], strict=True):
            assert error(update, pose)[0] < 0.1


def test_a_robot_that_was_kidnapped_to_where_it_looks_almost_as_where_it_was_is_not_sure():
    grid = drawn(SYMMETRIC, PLACES)
    cases = [
        ((-2.0, 0.0, 0.3), (0.2, 0.0, 0.45)),
        ((0.0, -1.0, 0.0), (0.0, 0.2, -0.45)),
        ((-2.0, 0.0, 0.3), (0.2, 0.0, 0.6)),
    ]
    for start, off in cases:
        rng = np.random.default_rng(0)
        localizer = Localizer(grid, BY_ODOMETRY, start)
        driven(localizer, SYMMETRIC, start, (0.0, 0.0, 0.0), 4, rng)
        turned = compose(np.array([0.0, 0.0, np.pi]), compose(np.array(start), np.array(off)))
        updates, _ = driven(localizer, SYMMETRIC, turned, (0.0, 0.0, 0.02), 6, rng)
        assert localizer.lost == 1
        assert all(update.pose is None for update in updates[2:])


def test_a_map_without_walls_and_a_start_that_is_no_pose_are_refused(room):
    with pytest.raises(InputError, match="occupied"):
        Localizer(OccupancyMap(np.zeros((50, 50), np.float32), 0.05, (0.0, 0.0)))
    with pytest.raises(InputError, match="start"):
        Localizer(room, start=(0.0, np.nan, 0.0))


@pytest.mark.parametrize("place", [(1000.0, 0.0), (9.0, 9.0), (-5.0, 0.0)])
def test_a_start_where_the_map_knows_nothing_is_refused(room, place):
    """There no scan contradicts it: the robot was sure of it for ever."""
    with pytest.raises(InputError, match=r"`start` must lie within 0.5 m of the map's free space, .* m away"):
        Localizer(room, start=(*place, 0.0))
    with pytest.raises(InputError, match="odometry"):
        Localizer(room).update((0.0, 0.0), cast(ROOM, np.zeros(3), np.random.default_rng(0)))
    with pytest.raises(InputError, match="patience"):
        LocalizerConfig(patience=0)


def test_the_search_starts_from_blocks_as_small_as_memory_allows_and_finds_the_same(room):
    assert len(PlaceMap(room).pyramid.levels) == 2
    blocks = (2.0 * PlaceMap(room).half_side / 0.1) ** 2
    for share, levels in ((1 / 3.9, 2), (1 / 4.1, 3), (1 / 17.0, 4)):
        place = PlaceMap(room, PlaceMapConfig(most_blocks=int(share * blocks)))
        assert len(place.pyramid.levels) == levels
        assert place.pyramid.skirt << (levels - 1) >= 2 * int(place.half_side / 0.1)  # a tenth of the time
        updates, _ = driven(Localizer(place), ROOM, (0.2, 0.7, -2.9), (0.05, 0.0, 0.05), 6, np.random.default_rng(0))
        same, _ = driven(Localizer(room), ROOM, (0.2, 0.7, -2.9), (0.05, 0.0, 0.05), 6, np.random.default_rng(0))
        assert [u.state for u in updates] == [u.state for u in same]
        np.testing.assert_array_equal(updates[-1].pose, same[-1].pose)


def hall_of_doors(places):
    """Return walls of a hall of 18 m with equal recesses at these x, which end at their right."""
    lines, x = [(-9.0, -1.5, 9.0, -1.5), (-9.0, -1.5, -9.0, 1.5), (9.0, -1.5, 9.0, 1.5)], -9.0
    for middle in places:
        left, right = middle - 0.5, middle + 0.5
        lines += [(x, 1.5, left, 1.5), (left, 1.5, left, 1.8), (left, 1.8, right, 1.8), (right, 1.8, right, 1.5)]
        x = right
    return np.array([*lines, (x, 1.5, 9.0, 1.5)])


def test_in_a_hall_of_equal_doors_it_is_sure_only_after_an_end_and_the_whole_drive_then_is_right():
    hall, rng = hall_of_doors((-6.0, 0.0, 6.0)), np.random.default_rng(0)
    grid = drawn(hall, [(x, 0.0) for x in np.arange(-8.0, 8.1, 1.0)], reach=4.0)
    localizer = Localizer(grid, keep_history=True)
    updates, poses = driven(localizer, hall, (-1.0, 0.1, 0.0), (0.15, 0.0, 0.0), 60, rng, reach=4.0)
    sure = [update.pose is not None for update in updates]
    assert not any(sure[:25])
    assert all(error(u, pose)[0] < 0.3 for u, pose in zip(updates, poses, strict=True) if u.pose is not None)
    assert sure[-1]
    odometry = np.array([compose(np.zeros(3), (0.15 * 1.03 * k, 0.0, 0.0)) for k in range(60)])
    rng = np.random.default_rng(0)
    scans = [cast(hall, pose, rng, 4.0) for pose in poses]
    smoothed = smooth_drive(localizer, RecordedDrive(odometry, scans, None, "hall"))
    assert smoothed.probability > 0.9
    assert all(error_of(found, pose)[0] < 0.3 for found, pose in zip(smoothed.trajectory, poses, strict=True))


def test_the_whole_drive_of_a_robot_that_is_taken_off_the_map_ends_there(room):
    rng = np.random.default_rng(0)
    away = np.array(walls((-1.0, -8.0), (1.5, -8.0), (1.5, 9.0), (-1.0, 9.0)) + walls((0.5, 2.0), (1.5, 3.5)))
    turning, ahead = [(0.05, 0.0, 0.05)], [(0.25, 0.0, 0.0)]
    poses, beyond = led((-2.8, -0.5, 0.4), 19 * turning), led((0.2, -5.0, 1.5), 39 * ahead)
    odometry = led((0.0, 0.0, 0.0), 19 * turning + 40 * ahead)
    scans = [cast(ROOM, pose, rng) for pose in poses] + [cast(away, pose, rng) for pose in beyond]
    localizer = Localizer(room, keep_history=True)
    for pose, scan in zip(odometry, scans, strict=True):
        localizer.update(pose, scan)
    trajectory = smooth_drive(localizer, RecordedDrive(np.array(odometry), scans, None, "taken away")).trajectory
    assert max(error_of(found, pose)[0] for found, pose in zip(trajectory, poses, strict=False)) < 0.1
    assert np.isnan(trajectory[30:]).all()


def test_a_hole_in_the_map_where_no_beam_went_does_not_end_a_hypothesis(room):
    probability = room.probability.copy()
    row, col = (int((v - o) / room.resolution) for v, o in zip((-0.5, -2.5), room.origin[::-1], strict=True))
    probability[row - 3 : row + 4, col - 3 : col + 4] = np.nan
    holed = OccupancyMap(probability, room.resolution, room.origin)
    rng = np.random.default_rng(0)
    updates, poses = driven(Localizer(holed), ROOM, (-2.8, -0.5, 0.0), (0.05, 0.0, 0.0), 12, rng)
    assert all(error(u, pose)[0] < 0.1 for u, pose in zip(updates[3:], poses[3:], strict=True))


def test_a_drive_that_was_not_kept_cannot_be_smoothed(room):
    with pytest.raises(InputError, match="keep_history"):
        smooth_drive(
            Localizer(room),
            RecordedDrive(np.zeros((1, 3)), [cast(ROOM, np.zeros(3), np.random.default_rng(0))], None, "x"),
        )
