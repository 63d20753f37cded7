"""Local SLAM in a synthetic room whose walls are known."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.graph.loops.constraints import Kind
from tagalong.slam.local.active_submaps import ActiveSubmaps, ActiveSubmapsConfig
from tagalong.slam.local.local_slam import LocalSlam, LocalSlamConfig
from tagalong.slam.local.odometry_soundness import OdometrySoundness
from tagalong.slam.local.sweep import Sweep
from tagalong.slam.local.switching_motion import MotionHypothesis
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch, GridScanMatcher, GridScanMatcherConfig
from walls import cast

WALLS = np.array([[-4.0, -3.0, 5.0, -3.0], [5.0, -3.0, 5.0, 4.0], [5.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0],
                  [1.0, 1.5, 2.2, 1.5], [2.2, 1.5, 2.2, 2.5], [-2.0, -1.0, -1.2, -1.8]])  # fmt: skip
BEARINGS = np.deg2rad(np.arange(-135.0, 135.0, 0.75))


def drive(rng, steps=150):
    """Return true poses (n, 3) of a loop in the room, and a drifting odometry (n, 3) of it."""
    phase = np.linspace(0.0, 2.0 * np.pi, steps)
    truth = np.stack((2.0 * np.sin(phase), -1.2 + 1.2 * np.cos(phase), -phase), axis=-1)
    odometry = [truth[0]]
    for motion in between(truth[:-1], truth[1:]):
        slip = motion * [1.08, 1.08, 0.93] + rng.normal(0.0, 1.0, 3) * [0.003, 0.003, 0.002]
        odometry.append(compose(odometry[-1], slip))
    return truth, np.array(odometry)


def run(engine, odometry, scans):
    for pose, scan in zip(odometry, scans, strict=True):
        engine.update(pose, scan)
    return engine


def test_a_drifting_odometry_is_corrected_to_centimetres():
    rng = np.random.default_rng(0)
    truth, odometry = drive(rng)
    engine = run(make_slam("cartographer"), odometry, [cast(WALLS, pose, rng, bearings=BEARINGS) for pose in truth])
    engine.finish()
    error = between(truth, engine.trajectory())
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.04
    assert np.abs(error[:, 2]).max() < np.deg2rad(0.8)
    assert np.hypot(*between(truth[-1], odometry[-1])[:2]) > 0.2


def test_two_runs_are_equal_to_the_byte():
    rng = np.random.default_rng(1)
    truth, odometry = drive(rng, steps=60)
    scans = [cast(WALLS, pose, rng, bearings=BEARINGS) for pose in truth]
    first, second = (run(make_slam("cartographer"), odometry, scans) for _ in range(2))
    assert first.trajectory().tobytes() == second.trajectory().tobytes()
    assert first.map().probability.tobytes() == second.map().probability.tobytes()


def test_scans_that_say_nothing_leave_the_pose_to_the_odometry():
    rng = np.random.default_rng(2)
    _, odometry = drive(rng, steps=30)
    blind = [np.full(len(BEARINGS), value) for value in (np.nan, np.inf, 0.0, 1e9)]
    engine = make_slam("cartographer")
    for k, pose in enumerate(odometry):
        engine.update(pose, LaserScan(blind[k % 4], BEARINGS, 0.05, 20.0))
    np.testing.assert_allclose(engine.trajectory(), odometry, atol=1e-9)
    assert not engine.map().occupied.any()


def test_a_pose_out_of_this_world_begins_a_submap_there_and_no_huge_grid():
    local, rng = LocalSlam(LocalSlamConfig()), np.random.default_rng(0)
    for x in (0.0, 9e3):
        local.update(np.array([x, 0.0, 0.0]), cast(WALLS, np.zeros(3), rng, bearings=BEARINGS))
    assert len(local.submaps) == 2
    assert sum(submap.field.size for submap in local.submaps) < 1_000_000


def test_a_submap_that_would_be_huge_is_an_error():
    active, sweep = ActiveSubmaps(ActiveSubmapsConfig()), Sweep(np.array([[0.0, 0.0], [1.0, 1.0]]), 1, 0)
    active.insert(np.zeros(3), sweep)
    with pytest.raises(InputError, match="a submap would grow to"):
        active.insert(np.array([9e3, 9e3, 0.0]), sweep)


def test_while_odometry_stands_still_scans_that_contradict_what_was_mapped_are_not_inserted():
    rng, poses = np.random.default_rng(0), [np.array([-3.0 + 0.9 * k, -2.0, 0.0]) for k in range(8)]
    engine, odometry = make_slam("cartographer", global_=None), [*poses[:4], poses[3], *poses[5:]]
    away = [np.array([3.5, 3.0, -2.0])]  # what the laser sees at the scan that the odometry does not tell of
    seen = [*poses[:4], *away, *poses[5:]]
    updates = [engine.update(o, cast(WALLS, p, rng, bearings=BEARINGS)) for o, p in zip(odometry, seen, strict=True)]
    assert [update.integrated for update in updates[3:6]] == [True, False, True]
    off = between(np.array(poses), engine.trajectory())
    assert np.hypot(off[[3, 5, 6, 7], 0], off[[3, 5, 6, 7], 1]).max() < 0.06


def test_a_scan_that_a_driver_sends_once_more_tells_nothing():
    rng = np.random.default_rng(0)
    engine, poses = make_slam("cartographer"), [np.array([0.3 * k, 0.0, 0.0]) for k in range(6)]
    scans = [cast(WALLS, pose, rng, bearings=BEARINGS) for pose in poses]
    scans[4].ranges[7] = np.nan  # a beam without a measurement
    scans[5] = replace(scans[4], ranges=scans[4].ranges.copy())
    updates = [engine.update(pose, scan) for pose, scan in zip(poses, scans, strict=True)]
    np.testing.assert_allclose(between(updates[4].pose, updates[5].pose), [0.3, 0.0, 0.0], atol=1e-9)
    assert not updates[5].integrated


def test_a_scan_of_what_was_never_seen_is_left_to_the_odometry_and_tied_no_better_than_that():
    rng = np.random.default_rng(5)
    ahead = np.deg2rad(np.arange(-18.0, 18.0, 0.25))
    poses = np.stack((np.linspace(0.0, 0.5, 11), np.full(11, -1.5), np.zeros(11)), axis=-1)
    turned = np.array([0.5, -1.5, np.pi])
    engine = run(make_slam("cartographer"), poses, [cast(WALLS, pose, rng, bearings=ahead) for pose in poses])
    before = engine.trajectory()[-1]
    engine.update(turned, cast(WALLS, turned, rng, bearings=ahead))
    np.testing.assert_allclose(between(before, engine.trajectory()[-1]), between(poses[-1], turned), atol=1e-6)
    assert isinstance(engine, Cartographer)
    last = engine.constraints[-1]
    assert last.kind is Kind.INTRA
    assert last.submap == 0  # nothing has begun anew
    assert np.linalg.eigvalsh(last.information)[-1] < 0.05**-2


def test_a_second_round_is_tied_to_the_submaps_of_the_first():
    rng = np.random.default_rng(3)
    truth, odometry = drive(rng, steps=120)
    second = np.concatenate((truth, truth))
    closed = compose(odometry[-1], between(odometry[0], odometry))
    scans = [cast(WALLS, pose, rng, bearings=BEARINGS) for pose in second]
    options = {"local": LocalSlamConfig(submaps=ActiveSubmapsConfig(scans=15))}
    engine = run(make_slam("cartographer", **options), np.concatenate((odometry, closed)), scans)
    assert isinstance(engine, Cartographer)
    engine.finish()
    error = between(second, engine.trajectory())
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.02
    half = len(truth)
    ties = [(c.submap, engine.node_scans[c.node]) for c in engine.constraints if c.kind is Kind.INTER]
    assert any(submap < 3 and scan > half for submap, scan in ties)
    assert engine.rejected == 0


def test_finished_submaps_keep_what_is_matched_on_and_drop_what_only_insertion_needs():
    active = ActiveSubmaps(ActiveSubmapsConfig(min_scans=1, scans=2))
    bearings = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    circle = 3.0 * np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)

    def insert(count):
        for _ in range(count):
            active.insert(np.zeros(3), Sweep(np.concatenate((np.zeros((1, 2)), circle)), len(circle), 0))
        return [submap.visits.size > 0 for submap in active.submaps]

    def fields():
        return [submap.field.tobytes() for submap in active.submaps]

    assert insert(4) == [True, True]
    before = fields()[0]
    assert insert(4) == [False, False, True, True]
    assert fields()[0] == before
    before = fields()
    active.restart()
    assert insert(0) == [False] * 4
    assert insert(1) == [False] * 4 + [True]
    assert fields()[:4] == before


def test_what_lies_where_nothing_is_known_fits_as_likely_as_not():
    matcher = GridScanMatcher(GridScanMatcherConfig())
    usual = GridMatch(np.zeros(3), np.eye(3), 0.5, False)
    unknown, missed = GridMatch(np.zeros(3), np.eye(3), 0.0, False, seen=0.0), replace(usual, score=0.0)
    assert matcher.cost(unknown, 100) == pytest.approx(0.5 * (matcher.cost(usual, 100) + matcher.cost(missed, 100)))
    assert matcher.cost(None, 100) == matcher.cost(unknown, 100)


def test_points_that_a_driver_gives_four_times_lead_to_no_other_motion():
    slam, rng, pose = LocalSlam(LocalSlamConfig()), np.random.default_rng(8), np.array([-1.0, -2.0, 0.0])
    for k in range(6):
        slam.update(compose(pose, [0.05 * k, 0.0, 0.0]), cast(WALLS, compose(pose, [0.05 * k, 0, 0]), rng))
    scan = cast(WALLS, compose(pose, [0.3, 0.0, 0.0]), rng)
    points = slam._voxel_filter.apply(scan.points_robot)
    leads = []
    for given in (points, np.repeat(points, 4, axis=0)):
        hypotheses = slam._motion.predict(compose(pose, [0.3, 0.0, 0.4]), scan.time_s)
        leads.append(slam._matching.match(slam._motion, scan, given, hypotheses).lead)
    assert np.isfinite(leads[0])
    assert leads[1] == pytest.approx(leads[0], rel=0.1)


def test_each_of_a_few_points_weighs_and_of_many_as_of_a_usual_scan():
    matcher, match = GridScanMatcher(GridScanMatcherConfig()), GridMatch(np.zeros(3), np.eye(3), 0.5, False)
    assert matcher.cost(match, 20) == pytest.approx(0.25 * 20 * 3.0 * 0.5)
    spread = 20.0 * np.random.default_rng(0).random((400, 2))
    assert matcher.independent(spread[:20]) == 20
    assert matcher.independent(spread) == matcher.independent(spread[:200]) == 90


def test_a_scan_that_contradicts_a_submap_is_not_one_that_has_left_it_behind():
    matcher = GridScanMatcher(GridScanMatcherConfig())
    usual = GridMatch(np.zeros(3), np.eye(3), 0.6, False)
    matcher.believe(usual)
    assert matcher.is_beside(replace(usual, score=0.05, seen=0.1))
    assert not matcher.is_beside(replace(usual, score=0.05, seen=0.5))


def guess(x, sound=True):
    """Return a hypothesis that the robot is at x [m], to 0.1 m."""
    return MotionHypothesis(np.zeros(3), Prediction(np.array([x, 0.0, 0.0]), np.array([0.1, 0.05])), 1.0, sound)


def test_a_guess_that_sees_nothing_is_not_likelier_than_one_that_fits():
    slam, blind, seen = LocalSlam(LocalSlamConfig()), guess(9.0), guess(0.0)
    fits = GridMatch(np.zeros(3), np.diag([100.0, 100.0, 100.0]), 0.6, False)
    slam._matcher.believe(fits)
    chosen, match, lead = slam._matching._best([(blind, None), (seen, fits)], 200)
    assert chosen is seen
    assert match is fits
    assert lead == -np.inf


def test_a_robot_is_nowhere_else_because_nothing_is_known_there():
    slam, here, caught_up = LocalSlam(LocalSlamConfig()), guess(0.0), guess(8.0)
    fits = GridMatch(np.zeros(3), np.diag([100.0, 100.0, 100.0]), 0.6, False)
    slam._matcher.believe(fits)
    hardly = replace(fits, score=0.02)
    unknown = GridMatch(np.array([8.0, 0.0, 0.0]), np.zeros((3, 3)), 0.05, False, seen=0.1)
    for elsewhere in (None, unknown):
        assert slam._matching._best([(here, hardly), (caught_up, elsewhere)], 200)[0] is here
    assert slam._matching._best([(here, hardly), (caught_up, replace(fits, pose=unknown.pose))], 200)[0] is caught_up


def test_a_scan_without_a_map_says_nothing_for_or_against_a_fault():
    slam, soundness = LocalSlam(LocalSlamConfig()), OdometrySoundness()
    sound = replace(guess(0.0), cost=-np.log(0.998))
    fault = replace(guess(1.0, sound=False), cost=-np.log(0.002))
    scan = cast(WALLS, np.zeros(3), np.random.default_rng(5), bearings=BEARINGS)
    look = slam._matching.match(slam._motion, scan, scan.points_robot, [sound, fault])
    soundness.weigh(look.lead)
    assert (look.motion, look.match) == (sound, None)
    assert soundness.probability == pytest.approx(0.998)


def test_where_no_scan_tells_a_robot_whose_odometry_is_frozen_goes_on(monkeypatch):
    slam, told, rng = LocalSlam(LocalSlamConfig()), np.zeros(3), np.random.default_rng(4)
    for k in range(20):
        pose = np.array([-3.0 + 0.2 * k, -2.0, 0.0])
        told = pose if k < 14 else told
        scan = replace(cast(WALLS, pose, rng, bearings=BEARINGS), time_s=0.2 * k)
        if k == 19:
            monkeypatch.setattr(slam, "_contradicts", lambda *_: True)
            monkeypatch.setattr(slam._matcher, "explains", lambda _: False)
        result = slam.update(told, scan)
    assert result.contradicts
    np.testing.assert_allclose(between(result.pose, pose), 0.0, atol=0.05)


def test_frozen_odometry_that_tells_of_no_way_is_off_by_what_a_robot_may_have_done():
    slam, rng, inserted = LocalSlam(LocalSlamConfig()), np.random.default_rng(4), []
    for k in range(20):
        pose = np.array([-3.0 + 0.2 * k, -2.0, 0.0])
        told = np.array([-3.0 + 0.2 * min(k, 13), -2.0, 0.0])
        result = slam.update(told, replace(cast(WALLS, pose, rng, bearings=BEARINGS), time_s=0.2 * k))
        inserted += [result.insertion] if result.odometry_fault and result.insertion else []
    assert len(inserted) > 3
    assert all(insertion.drift.min() > 0.01 for insertion in inserted)


def test_odometry_that_seemed_precise_may_be_rough_where_a_scan_fits_badly(monkeypatch):
    slam, rng, truth = LocalSlam(LocalSlamConfig()), np.random.default_rng(7), np.array([-1.0, -2.0, 0.0])
    for k in range(6):
        pose = compose(truth, [0.1 * k - 0.5, 0.0, 0.0])
        slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS))
    monkeypatch.setattr(slam._matcher, "search", lambda *_: [])
    expected = compose(truth, [0.2, 0.15, 0.1])
    precise = MotionHypothesis(expected, Prediction(expected, np.array([0.002, 0.001])), 0.4, True)
    rough = replace(precise, prediction=Prediction(expected, np.array([0.2, 0.1])), cost=1.2)
    scan = cast(WALLS, truth, rng, bearings=BEARINGS)
    alone = slam._matching.match(slam._motion, scan, scan.points_robot, [precise]).match
    assert alone
    assert slam._matcher.is_poor(alone)
    assert precise.prediction.squared_distance(alone.pose) < 1.0  # so tight that the match cannot ask for more
    look = slam._matching.match(slam._motion, scan, scan.points_robot, [precise, rough])
    assert look.motion is rough
    assert look.match
    np.testing.assert_allclose(between(truth, look.match.pose), 0.0, atol=0.03)


def test_a_place_at_the_edge_of_the_map_is_told_by_what_is_seen_of_it():
    matcher = GridScanMatcher(GridScanMatcherConfig())
    usual = GridMatch(np.zeros(3), np.eye(3), 0.5, False)
    assert matcher.explains(replace(usual, score=0.2, seen=0.5))
    assert not matcher.explains(replace(usual, score=0.2, seen=1.0))
    assert not matcher.explains(replace(usual, score=0.02, seen=0.04))


def lost(places, here=0.02):
    """Return the match of a scan that fits by `here` where it is expected and by 0.5 at `places`; if in question."""
    slam, rng = LocalSlam(LocalSlamConfig()), np.random.default_rng(6)
    pose = np.zeros(3)
    for _ in range(4):
        pose = pose + np.array([0.1, 0.0, 0.0])
        slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS))
    fits = GridMatch(pose, 100.0 * np.eye(3), here, False)
    slam._matcher.search = lambda *_: [replace(fits, pose=np.array(place), score=0.5) for place in places]
    points = cast(WALLS, pose, rng, bearings=BEARINGS).points_robot
    _, match, _, in_question = slam._matching._anywhere(
        slam._motion, points, np.zeros(2), [guess(0.4)], [(guess(0.4), fits)]
    )
    assert match is not None
    return match.pose.tolist(), in_question


def test_a_scan_is_where_it_fits_if_no_other_place_is_about_as_likely():
    assert lost([(0.7, 0.0, 0.0), (5.0, 0.0, 0.0)]) == ([0.7, 0.0, 0.0], False)


def test_a_scan_that_is_elsewhere_at_either_of_two_places_is_in_question():
    two = [(0.8, 0.3, 0.0), (0.8, -0.3, 0.0)]
    assert lost(two)[1]
    assert lost(two, here=0.7) == ([0.4, 0.0, 0.0], False)


def test_a_scan_that_fits_where_it_is_expected_about_as_well_as_elsewhere_is_there():
    assert lost([(0.7, 0.0, 0.0)], here=0.5) == ([0.4, 0.0, 0.0], False)
    assert lost([(0.7, 0.0, 0.0)], here=0.4) == ([0.7, 0.0, 0.0], False)


def test_a_scan_that_fits_nowhere_is_in_question():
    assert lost([])[1]
    assert lost([(9.0, 9.0, 2.0)])[1]


def test_a_robot_that_stands_where_its_map_was_given_up_begins_another():
    rng, slam = np.random.default_rng(7), LocalSlam(LocalSlamConfig())
    pose = np.zeros(3)
    for _ in range(4):
        pose = pose + np.array([0.1, 0.0, 0.0])
        slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS))
    slam._leave_map()
    assert slam.update(pose, cast(WALLS, pose, rng, bearings=BEARINGS)).insertion is not None
