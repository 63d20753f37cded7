"""Scans that wait for odometry that stands still while the robot drives on."""

from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between, compose, part_of, wrap_one
from tagalong.slam.local.bridge import bridge_over
from tagalong.slam.local.local_slam import LocalSlam, LocalSlamConfig
from tagalong.slam.local.switching_motion import SwitchingMotion
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig
from tagalong.slam.scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from walls import cast

# A corridor with a niche where it begins, a corner, a second corridor: no scan tells how far along the robot is.
WALLS = np.array([[-3.0, -1.0, 21.0, -1.0], [21.0, -1.0, 21.0, 30.0], [-3.0, 1.0, -1.0, 1.0], [-1.0, 1.0, -1.0, 2.0],
                  [-1.0, 2.0, 0.5, 2.0], [0.5, 2.0, 0.5, 1.0], [0.5, 1.0, 19.0, 1.0], [19.0, 1.0, 19.0, 30.0],
                  [-3.0, -1.0, -3.0, 1.0]])  # fmt: skip
USUAL, ROUGH = np.array([0.2, 0.1]), np.array([0.1, 0.1])
BEARINGS = np.deg2rad(np.arange(-90.0, 90.5, 1.0))


def round_the_corner():
    """Return (n, 3) the poses of a robot that drives along the corridor, round the corner, and on."""
    first = [np.array([x, 0.0, 0.0]) for x in np.arange(0.0, 19.0, 0.5)]
    turn = [np.array([19.0 + np.sin(a), 1.0 - np.cos(a), a]) for a in np.linspace(0.0, np.pi / 2, 5)]
    then = [np.array([20.0, y, np.pi / 2]) for y in np.arange(1.5, 8.0, 0.5)]
    return np.array(first + turn + then)


def drive(frozen, truth=None, stands=()):
    """Return an engine after the drive in which the odometry stands still at the scans `frozen`, and its updates."""
    rng, truth = np.random.default_rng(0), round_the_corner() if truth is None else truth
    source = np.arange(len(truth))
    for k in frozen:
        source[k] = source[k - 1]
    engine = make_slam("cartographer")
    scans = [cast(WALLS, pose, rng, bearings=BEARINGS, reach=8.0) for pose in truth]
    updates = []
    for k, (pose, scan) in enumerate(zip(truth[source], scans, strict=True)):
        updates.append(engine.update(pose, scan))
        assert len(engine.trajectory()) == k + 1
    return engine, updates


def errors(engine, truth):
    off = between(truth, engine.trajectory())
    return np.hypot(off[:, 0], off[:, 1])


@pytest.mark.parametrize("first", [12, 36])  # in the corridor, and before the corner
def test_odometry_that_has_caught_up_tells_where_the_scans_before_were_taken(first):
    truth, frozen = round_the_corner(), range(first, first + 6)
    engine, _ = drive(frozen)
    engine.finish()
    undisturbed, _ = drive([])
    undisturbed.finish()
    assert errors(engine, truth).max() < errors(undisturbed, truth).max() + 0.15


def test_scans_that_wait_are_drawn_once_the_odometry_moves_and_in_their_order():
    frozen = range(36, 42)
    engine, updates = drive(frozen)
    assert not any(update.integrated for update in updates[37:42])
    assert set(frozen) <= set(engine.node_scans)
    assert engine.node_scans == sorted(set(engine.node_scans))


def test_scans_that_wait_are_drawn_at_the_latest_when_the_drive_ends():
    truth = round_the_corner()[:44]
    engine, _ = drive(range(36, 44), truth)
    engine.finish()
    assert set(range(38, 44)) & set(engine.node_scans)
    assert len(engine.trajectory()) == len(truth)


def test_odometry_that_stands_still_for_good_is_not_waited_for_for_ever():
    corner = [[19.0 + np.sin(a), 1.0 - np.cos(a), a] for a in np.linspace(0.0, 1.57, 40)]
    truth = np.concatenate((round_the_corner()[:38], corner))
    _, updates = drive(range(38, len(truth)), truth)
    assert any(update.integrated for update in updates[60:])
    off = between(truth[-1], updates[-1].pose)
    assert abs(off[1]) < 0.2  # how far it is along the corridor no scan tells
    assert abs(off[2]) < 0.1


def motion_of(steps):
    """Return the motion of a robot that has driven `steps` as its odometry says."""
    motion, pose = SwitchingMotion(ExtrapolatorConfig()), np.zeros(3)
    for k, step in enumerate([np.zeros(3), *steps]):
        pose = compose(pose, step)
        hypotheses = motion.predict(pose, 0.2 * k)
        motion.take(hypotheses, hypotheses[0], pose, 0.0)
    return motion, pose


@pytest.mark.parametrize(("steps", "caught_up"), [(1.0, False), (1.5, False), (5.0, True), (6.0, True)])
def test_odometry_has_caught_up_if_its_step_is_no_usual_one(steps, caught_up):
    motion, pose = motion_of([np.array([0.3, 0.0, 0.0])] * 30)
    assert motion.has_caught_up(compose(pose, [0.3 * steps, 0.0, 0.0]), scans=5) is caught_up
    turning, pose = motion_of([np.array([0.0, 0.0, 0.3])] * 30)
    assert turning.has_caught_up(compose(pose, [0.0, 0.0, 0.3 * steps]), scans=5) is caught_up


def test_noise_of_the_encoders_is_no_motion():
    motion, pose = motion_of([np.array([0.3, 0.0, 0.1])] * 5)
    assert motion.stands_still(pose)
    assert motion.stands_still(pose + np.array([1e-9, -1e-9, 1e-16]))
    assert not motion.stands_still(pose + np.array([0.0, 0.0, 0.01]))


def test_what_is_put_between_ends_where_the_odometry_does_whatever_the_scans_on_the_way_said():
    motion, pose = motion_of([np.array([0.3, 0.0, 0.0])] * 10)
    goal = matched = compose(pose, [1.0, 0.8, 1.2])
    for left in range(4, 0, -1):
        at, ways = motion.bridge(goal, np.zeros((left, 3)))
        hypotheses = motion.predict(at, 3.0 - 0.2 * left, ways)
        assert all((motion.prediction.sigma > 0.0).all() for motion in hypotheses)
        evenly = hypotheses[0]
        matched = compose(evenly.prediction.pose, [0.05, -0.02, 0.03]) if left > 1 else evenly.prediction.pose
        motion.take(hypotheses, evenly, matched, 0.0)
    np.testing.assert_allclose(matched, goal, atol=1e-9)


SEEN = np.array([(0.5, 0.0, 0.0), (0.0, 0.0, 1.5), (0.0, 0.1, 2.5), (0.4, 0.0, 0.1)])


def test_where_the_scans_showed_the_way_that_the_odometry_tells_it_is_the_likelier_one():
    end = reduce(compose, SEEN)
    (even, odds), (seen, shown) = ((way.pose, p) for p, way in bridge_over(end, SEEN, USUAL, ROUGH))
    np.testing.assert_allclose(seen, SEEN[0], atol=1e-9)
    np.testing.assert_allclose(even, (*(end[:2] / 4), wrap_one(end[2]) / 4), atol=1e-9)
    assert shown == pytest.approx(0.5) == odds
    (_, _), (_, shown) = ((way.pose, p) for p, way in bridge_over(compose(end, [2.0, 0.0, 0.0]), SEEN, USUAL, ROUGH))
    assert shown < 0.01


def test_what_the_scans_did_not_show_is_shared_out_among_them():
    pose, goal = np.zeros(3), np.array([3.0, -1.0, -2.0])
    for k in range(len(SEEN)):
        pose = compose(pose, bridge_over(between(pose, goal), SEEN[k:], USUAL, ROUGH)[1][1].pose)
    np.testing.assert_allclose(pose, goal, atol=1e-9)


@pytest.mark.parametrize(
    "motion", [(1.0, 0.0, 0.0), (1.0, 0.5, 1e-9), (0.5, 1.0, 2.0), (0.0, 0.0, -3.0), (1.0, 2.0, -0.1)]
)
def test_the_parts_of_a_motion_make_the_whole(motion):
    pose = np.zeros(3)
    for _ in range(5):
        pose = compose(pose, part_of(motion, 0.2))
    np.testing.assert_allclose(pose, motion, atol=1e-6)


def points_of(scan):
    return AdaptiveVoxelFilter(AdaptiveVoxelConfig()).apply(scan.points_robot)


def waiting(last):
    """Return local SLAM after the corridor's first 36 scans and a wait of two scans, the robot at `last` in them."""
    rng, local, truth = np.random.default_rng(0), LocalSlam(LocalSlamConfig()), round_the_corner()[:36]
    for pose in truth:
        local.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS, reach=8.0))
    for _ in range(2):
        assert local.wait(truth[-1], cast(WALLS, last, rng, bearings=BEARINGS, reach=8.0))
    return local, truth[-1]


def test_a_scan_that_waits_is_told_to_contradict_the_map_and_is_not_counted_twice():
    local, _ = waiting(np.array([-0.3, 0.5, 1.5]))
    assert local._monitor.rejected == 0
    result = local.wait(round_the_corner()[35], cast(WALLS, np.array([-0.3, 0.5, 1.5]), np.random.default_rng(1)))
    assert result
    assert result.contradicts


@pytest.mark.parametrize("in_question", [False, True])
def test_a_waiting_scan_that_may_as_well_be_elsewhere_tells_nothing_of_the_odometry(monkeypatch, in_question):
    local, at = waiting(round_the_corner()[35])
    match, before, pose = local._matching.match, local._motion.soundness.probability, local._motion.pose

    def doubtful(motion, scan, points, hypotheses):
        look = match(motion, scan, points, hypotheses)
        aside = replace(look.match, pose=compose(look.match.pose, [0.0, 0.3, 0.0]))
        # by far likelier elsewhere, if that place were the right one
        return replace(look, motion=hypotheses[-1], match=aside, lead=20.0, in_question=in_question, rival=None)

    monkeypatch.setattr(local._matching, "match", doubtful)
    monkeypatch.setattr(SwitchingMotion, "_going_on", lambda *_: (np.array([0.0, 5.0, 0.0]), np.array([0.1, 0.1])))
    result = local.wait(at, cast(WALLS, at, np.random.default_rng(3), bearings=BEARINGS, reach=8.0))
    assert result
    assert (result.match is None) == in_question
    assert bool(abs(local._motion.soundness.probability - before) > 0.5) != in_question
    assert bool(np.abs(between(pose, result.pose)).max() < 0.2) == in_question
    assert result.contradicts or not in_question


def test_what_was_found_while_a_scan_waited_holds_until_something_is_drawn():
    local, at = waiting(round_the_corner()[37])
    first, second = local.rest()
    assert first.look
    assert second.look is None  # what becomes of the first may change it
    moved = replace(first.look.match, pose=at + np.array([0.25, 0.0, 0.0]))
    known = replace(first, look=replace(first.look, match=moved))
    np.testing.assert_array_equal(first.look.points, points_of(first.scan))
    taken = local.take(known)
    np.testing.assert_array_equal(taken.pose, moved.pose)
    assert taken.insertion
    again = replace(known, scan=replace(known.scan, ranges=known.scan.ranges + 1e-4))
    assert np.hypot(*(local.take(again).pose - moved.pose)[:2]) > 0.0  # the look holds no longer


def test_odometry_that_has_caught_up_is_as_rough_as_the_whole_way_and_teaches_nothing_of_its_precision():
    local, at = waiting(round_the_corner()[37])
    goal, motion = compose(at, [1.5, 0.0, 0.0]), local._held.motion
    assert motion
    faults, shares = motion.faults, motion.precision.shares
    for due in local.rest(goal):
        assert due.bridge is not None
        local.take(due)
    assert local._motion.faults == faults + 2
    assert local._motion.precision.shares is shares
    assert local._motion.predict(goal, 9.0)[0].prediction.sigma[0] > 0.06 * 1.5
