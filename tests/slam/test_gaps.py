"""Gaps in a log: the first scan after one sees nothing of what was mapped; odometry alone leads there, if anything."""

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.graph.local.match_monitor import MatchMonitor, MatchMonitorConfig
from tagalong.slam.graph.local.submap import Submap, SubmapConfig
from tagalong.slam.graph.local.sweep import Sweep
from tagalong.slam.graph.recovery.search_region import SearchRegion
from walls import cast

REACH = 5.0  # [m] of the laser


def box(x, y, wide, tall):
    return [
        (x, y, x + wide, y),
        (x + wide, y, x + wide, y + tall),
        (x + wide, y + tall, x, y + tall),
        (x, y + tall, x, y),
    ]


def corridor():
    """Return (k, 4) walls of a corridor of 40 m in which cupboards stand on both sides, no two alike."""
    rng, lines = np.random.default_rng(3), box(0.0, -1.5, 40.0, 3.0)
    for x in np.arange(0.6, 39.0, 1.3):
        deep = rng.uniform(0.2, 0.8)
        lines += box(x + rng.uniform(0.0, 0.4), rng.choice([-1.5, 1.5 - deep]), rng.uniform(0.3, 0.8), deep)
    return np.array(lines)


LINES = corridor()


def along(first, last):
    """Return true poses, 0.1 m apart, from x = `first` to x = `last` [m], looking ahead."""
    x = np.linspace(first, last, round(abs(last - first) / 0.1) + 1)
    heading = 0.0 if last > first else np.pi
    return np.stack((x, 0.1 * np.sin(x), np.full(len(x), heading)), axis=-1)


def drive(engine, segments, slips):
    """Feed scans at the true poses of `segments`; the odometry errs by `slips` (3,) from one to the next.

    Returns updates, (n, 3) true poses and (n, 3) odometry.
    """
    rng, truth, odometry, updates = np.random.default_rng(0), np.concatenate(segments), [segments[0][0]], []
    starts = np.cumsum([len(segment) for segment in segments]).tolist()
    for k, pose in enumerate(truth):
        if k:
            motion = between(truth[k - 1], pose)
            odometry.append(compose(odometry[-1], compose(motion, slips) if k in starts else motion))
        updates.append(engine.update(odometry[-1], cast(LINES, pose, rng, REACH)))
    return updates, truth, np.array(odometry)


def errors(engine, truth):
    engine.finish()
    off = between(truth, engine.trajectory())
    return np.hypot(off[:, 0], off[:, 1])


def test_after_a_short_gap_the_odometry_is_believed_and_not_a_match_on_what_was_never_seen():
    engine, slip = make_slam("cartographer"), np.array([0.3, 0.4, 0.1])
    updates, _, odometry = drive(engine, [along(2.0, 8.0), along(14.0, 17.0)], slip)
    assert isinstance(engine, Cartographer)
    assert engine.losses == 0
    assert all(update.located for update in updates)
    before, after = updates[60].pose, updates[61].pose
    np.testing.assert_allclose(between(before, after), between(odometry[60], odometry[61]), atol=0.05)


def test_what_the_odometry_missed_in_a_gap_is_known_once_the_robot_comes_back():
    engine, slip = make_slam("cartographer"), np.array([0.3, 0.4, 0.1])
    _, truth, _ = drive(engine, [along(2.0, 8.0), along(14.0, 17.0), along(17.0, 3.0)], slip * 0.5)
    assert errors(engine, truth).max() < 0.2


def test_after_a_long_gap_the_robot_is_lost_until_it_comes_back_to_its_map():
    engine, slip = make_slam("cartographer"), np.array([1.0, 1.0, 0.2])
    assert isinstance(engine, Cartographer)
    updates, truth, odometry = drive(engine, [along(2.0, 9.0), along(20.0, 26.0)], slip)
    assert (engine.losses, engine.relocalizations) == (1, 0)
    assert not any(update.located for update in updates[71:])
    engine.finish()
    far = np.hypot(*(engine.map().occupied_points - truth[0, :2]).T) > 15.0
    assert far.sum() > 100  # drawn all the same, where the odometry puts it
    rng, back = np.random.default_rng(1), along(26.0, 3.0)
    for k, pose in enumerate(back):
        motion = between(back[k - 1], pose) if k else between(truth[-1], pose)
        engine.update(compose(odometry[-1], motion), cast(LINES, pose, rng, REACH))
        odometry = np.append(odometry, compose(odometry[-1], motion)[None], axis=0)
    assert errors(engine, np.concatenate((truth, back))).max() < 0.1
    assert (engine.losses, engine.relocalizations) == (1, 1)


def test_a_place_is_within_the_region_if_the_odometry_over_the_gap_can_have_led_there():
    start = np.array([10.0, 2.0, 0.3])
    region = SearchRegion.across(8.0, np.array([0.4, 0.8]), start)  # 16 steps: a quarter, twice
    np.testing.assert_allclose(region.limits, [0.2 + 4.0 * 0.4, 0.4])
    since = np.array([5.0, -1.0, 2.0])
    expected = compose(start, since)
    for slip, within in (
        ((0.0, 0.0, 0.0), True),
        ((1.2, 1.2, 0.39), True),
        ((0.0, 1.9, 0.0), False),
        ((0.0, 0.0, 0.41), False),
    ):
        assert region.holds(compose(compose(start, slip), since), expected) == within, slip
    np.testing.assert_allclose(region.widened(region).limits, 2.0 * region.limits)
    np.testing.assert_array_equal(region.widened(region).start, start)
    np.testing.assert_allclose(SearchRegion.across(0.1, np.array([0.4, 0.8]), start).limits, [0.8 + 0.05 * 1.6, 1.6])


@pytest.mark.parametrize(
    ("away", "score", "far", "nothing"),
    [
        (0.0, 0.05, False, False),
        (10.0, 0.05, False, True),
        (10.0, 0.2, False, False),
        (10.0, 0.2, True, True),
        (10.0, 0.3, True, False),
        (0.0, 0.2, True, False),
        (4.5, 0.05, False, True),
    ],
)
def test_a_scan_has_no_overlap_with_a_submap_where_it_fits_nowhere_and_lies_beside(away, score, far, nothing):
    submap, bearings = Submap(SubmapConfig(), np.zeros(3)), np.linspace(-np.pi, np.pi, 200, endpoint=False)
    circle = 3.0 * np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)
    submap.insert(Sweep(np.concatenate((np.zeros((1, 2)), circle)), len(circle), 0))
    monitor = MatchMonitor(MatchMonitorConfig())
    assert not monitor.rejects(submap, circle, np.zeros(2), np.zeros(3), 0.9)
    predicted, pose = np.array([away, float(far), 0.0]), np.array([away, 0.0, 0.0])
    assert monitor.has_no_overlap(submap, circle, predicted, pose, score) == nothing


def test_a_match_is_far_off_by_a_quarter_of_a_metre_or_six_degrees():
    monitor, predicted = MatchMonitor(MatchMonitorConfig()), np.array([1.0, 2.0, 3.1])
    for off, far in (((0.2, 0.1, 0.09), False), ((0.2, 0.2, 0.0), True), ((0.0, 0.0, 0.11), True)):
        assert monitor.far_off(predicted, compose(predicted, np.array(off))) == far, off


def test_a_found_drive_segment_is_tied_to_the_map_around_it_and_not_to_where_the_robot_got_lost():
    engine, slip = make_slam("cartographer"), np.zeros(3)
    assert isinstance(engine, Cartographer)
    drive(engine, [along(2.0, 12.0)], slip)
    graph = engine._global  # pyright: ignore[reportPrivateUsage]
    assert graph is not None
    nodes, ties = len(graph.graph.nodes), len(graph.graph.constraints)
    graph.begin_segment()
    engine._local.restart()  # pyright: ignore[reportPrivateUsage]
    rng = np.random.default_rng(1)
    engine.update(np.array([3.0, 0.0, 0.0]), cast(LINES, np.array([4.0, 0.0, 0.0]), rng, REACH))
    graph.place_segment(np.array([4.0, 0.0, 0.0]), engine.local_trajectory()[-1])
    found = [c for c in graph.graph.constraints[ties:] if c.node == nodes and c.searched]
    assert len(found) == 1
    assert np.linalg.inv(found[0].information)[0, 0] == pytest.approx(0.1**2)
    assert (graph.graph.nodes[nodes].motion.sigma > 1.0).all()
