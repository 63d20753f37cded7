"""Odometry that stops while the robot drives on: scans stand for it, in both engines, until the wheels tell again."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.scan_to_scan import stopped_odometry
from tagalong.slam.scan_to_scan.laser_odometry import OdometryUpdate
from tagalong.slam.scan_to_scan.stopped_odometry import LONGEST_STOP, StoppedOdometry
from walls import cast

ROOM = np.array(
    [(-6, -5, 7, -5), (7, -5, 7, 6), (7, 6, -6, 6), (-6, 6, -6, -5), (3, 2, 3, 3), (3, 3, 4, 3), (-3, -3, -3, -1.5)],
    dtype=float,
)
STOPS = 30  # the scan at which the odometry does


def laps(speed, steps):
    """True poses around a room, `speed` [m] a scan, and scans."""
    rng, poses = np.random.default_rng(0), [np.array([0.0, -2.0, 0.0])]
    for _ in range(steps):
        poses.append(compose(poses[-1], (speed, 0.0, 0.5 * speed)))
    scans = [replace(cast(ROOM, pose, rng, noise=0.005), time_s=0.2 * k) for k, pose in enumerate(poses)]
    return np.array(poses), scans


@pytest.fixture(scope="module")
def drive():
    return laps(0.09, 140)


def frozen(truth, scans=None):
    """Odometry that says nothing more from `STOPS` on, or for so many scans, and then goes on where it stopped."""
    odometry = truth.copy()
    for k in range(STOPS, len(truth)):
        step = between(truth[k - 1], truth[k]) if scans is not None and k >= STOPS + scans else np.zeros(3)
        odometry[k] = compose(odometry[k - 1], step)
    return odometry


def followed(odometry, scans):
    stopped, poses, flags = StoppedOdometry(), [], []
    for pose, scan in zip(odometry, scans, strict=True):
        poses.append(stopped.apply(pose, scan))
        flags.append(stopped.has_stopped)
    return np.array(poses), np.array(flags)


def off(truth, poses):
    error = between(truth, poses)
    return np.hypot(error[:, 0], error[:, 1])


def test_scans_tell_the_way_since_it_stopped_once_that_is_sure(drive):
    truth, scans = drive
    poses, flags = followed(frozen(truth), scans)
    first = int(np.argmax(flags))
    assert first == STOPS + LONGEST_STOP
    assert flags[first:].all()
    np.testing.assert_array_equal(poses[:first], frozen(truth)[:first])
    assert off(truth, poses)[first:].max() < 0.12


def test_a_robot_that_stands_is_no_odometry_that_has_stopped(drive):
    truth, scans = drive
    poses, flags = followed(frozen(truth), [scans[min(k, STOPS)] for k in range(len(scans))])
    assert not flags.any()
    np.testing.assert_array_equal(poses, frozen(truth))


def test_a_robot_that_creeps_is_followed_to_the_tenth_of_a_millimetre(drive):
    creeping = np.stack((0.0005 * np.arange(100), np.zeros(100), np.zeros(100)), axis=-1)
    poses, flags = followed(creeping, [drive[1][0]] * 100)
    assert not flags.any()
    np.testing.assert_array_equal(poses, creeping)


def test_a_robot_that_turns_on_the_spot_does_not_stand(drive):
    turning = np.stack((np.zeros(100), np.zeros(100), 0.05 * np.arange(100)), axis=-1)
    poses, flags = followed(turning, [drive[1][0]] * 100)
    assert not flags.any()
    np.testing.assert_array_equal(poses, turning)


def test_it_may_stop_long_after_the_robot_has(drive):
    truth, scans = drive
    stands = 60
    truth = np.concatenate((truth[:STOPS], np.repeat(truth[STOPS - 1 : STOPS], stands, 0), truth[STOPS:]))
    scans = [*scans[:STOPS], *[scans[STOPS - 1]] * stands, *scans[STOPS:]]
    poses, flags = followed(frozen(truth), scans)
    assert not flags[STOPS + stands]
    assert flags[-1]
    assert off(truth, poses)[-20:].max() < 0.12


def test_a_robot_that_is_pushed_a_little_stands(drive):
    truth, scans = drive
    there = [STOPS, STOPS + 1, STOPS + 2, *[STOPS + 2] * 60]
    poses, flags = followed(np.tile(truth[STOPS], (len(there), 1)), [scans[k] for k in there])
    assert not flags.any()
    np.testing.assert_array_equal(poses, np.tile(truth[STOPS], (len(there), 1)))


def test_that_the_robot_moved_is_not_forgotten_where_its_scans_show_nothing(drive):
    truth, scans = drive
    blind = [replace(scan, ranges=np.full_like(scan.ranges, np.inf)) for scan in scans[STOPS + 15 : STOPS + 30]]
    _, flags = followed(frozen(truth), [*scans[: STOPS + 15], *blind, *scans[STOPS + 30 :]])
    assert flags[STOPS + LONGEST_STOP :].all()


def test_how_far_it_moves_is_seen_after_scans_that_show_nothing(drive):
    truth, scans = drive
    blind = [replace(scan, ranges=np.full_like(scan.ranges, np.inf)) for scan in scans[STOPS : STOPS + 30]]
    _, flags = followed(frozen(truth), [*scans[:STOPS], *blind, *scans[STOPS + 30 :]])
    assert not flags[: STOPS + 30].any()
    assert flags[STOPS + 42 :].all()


def test_wheels_that_go_on_where_they_stopped_are_taken_on_from_where_the_robot_is(drive):
    truth, scans = drive
    poses, flags = followed(frozen(truth, scans=60), scans)
    assert flags[STOPS + 59]
    assert not flags[STOPS + 60 :].any()
    assert off(truth, poses)[STOPS + 60 :].max() < 0.12


def test_wheels_that_tell_all_the_way_in_the_end_are_taken_at_their_word(drive):
    truth, scans = drive
    odometry = truth.copy()
    odometry[STOPS : STOPS + 60] = odometry[STOPS - 1]
    poses, flags = followed(odometry, scans)
    assert flags[STOPS + 59]
    np.testing.assert_allclose(poses[STOPS + 60 :], truth[STOPS + 60 :], atol=1e-12)


def test_odometry_that_catches_up_after_ten_scans_has_not_stopped(drive):
    truth, scans = drive
    odometry = truth.copy()
    odometry[STOPS : STOPS + 10] = odometry[STOPS - 1]
    poses, flags = followed(odometry, scans)
    assert not flags.any()
    np.testing.assert_array_equal(poses, odometry)


KNOWN, VAGUE, UNKNOWN = (0.01, 0.01), (0.28, 0.19), (2.0, 2.0)


@pytest.mark.parametrize(
    ("steps", "moved"),
    [
        ([((0.05, 0.0, 0.0), KNOWN)] * 20, True),
        ([((0.0, 0.0, 0.05), KNOWN)] * 20, True),
        ([((0.005, 0.0, 0.002), KNOWN)] * 20, False),  # less than a push
        ([((0.05, 0.0, 0.0), VAGUE)] * 20, False),  # 1 m, and 1.3 m may it be off
        ([((1.0, 0.0, 1.0), UNKNOWN)] * 20, False),
        ([((0.0, 0.0, 0.0), KNOWN)] * 10 + [((1.0, 0.0, 1.0), UNKNOWN)] + [((0.0, 0.0, 0.0), KNOWN)] * 10, False),
        ([((1.0, 0.0, 1.0), UNKNOWN)] * 10 + [((0.05, 0.0, 0.0), KNOWN)] * 10, True),
        ([((0.05, 0.0, 0.0), KNOWN)] * 10 + [((-0.05, 0.0, 0.0), KNOWN)] * 10, True),  # there and back
    ],
)
def test_the_robot_has_moved_where_the_way_is_known_and_long(monkeypatch, drive, steps, moved):
    class FrontEnd:
        def __init__(self):
            self.pose, self.steps = np.zeros(3), iter([((0.0, 0.0, 0.0), KNOWN), *steps])

        def update(self, _):
            step, sigma = next(self.steps)
            self.pose = compose(self.pose, step)
            return OdometryUpdate(self.pose, True, np.array(sigma))

    monkeypatch.setattr(stopped_odometry, "ScanToScanOdometry", FrontEnd)
    _, flags = followed(np.zeros((len(steps) + 1, 3)), [drive[1][0]] * (len(steps) + 1))
    assert flags[-1] == moved


@pytest.mark.parametrize("method", ["cartographer", "gmapping"])
def test_both_engines_map_on(method):
    truth, scans = laps(0.4, 140)
    engine = make_slam(method, **({"particles": 5} if method == "gmapping" else {}))
    for pose, scan in zip(frozen(truth), scans, strict=True):
        update = engine.update(pose, scan)
    engine.finish()
    assert update.located
    assert off(truth, engine.trajectory())[-40:].max() < 0.04
    assert update.diagnostics["odometry_fault"] == 1.0


def test_where_scans_that_stand_for_the_odometry_show_nothing_it_may_be_elsewhere(monkeypatch, drive):
    truth, scans = drive
    blind = replace(scans[STOPS + 40], ranges=np.full_like(scans[0].ranges, np.inf), time_s=scans[STOPS + 41].time_s)
    engine, reviewed = make_slam("cartographer"), []
    review = engine._recovery.review

    def spy(result, odometry, scan):
        reviewed.append(result.odometry_fault)
        return review(result, odometry, scan)

    monkeypatch.setattr(engine._recovery, "review", spy)
    late = replace(blind, time_s=blind.time_s + 2.0)
    for pose, scan in zip(frozen(truth), [*scans[: STOPS + 40], late], strict=False):
        engine.update(pose, scan)
    assert not reviewed[-2]
    assert reviewed[-1]


@pytest.mark.parametrize("method", ["cartographer", "gmapping"])
def test_a_log_without_odometry_is_mapped(method):
    truth, scans = laps(0.2, 200)
    engine = make_slam(method, **({"particles": 5} if method == "gmapping" else {}))
    for scan in scans:
        update = engine.update(np.zeros(3), scan)
    engine.finish()
    assert update.located
    path = compose(truth[0], engine.trajectory())
    assert off(truth, path)[-40:].max() < 0.04


def test_of_wheels_that_have_stopped_nothing_is_learned():
    truth, scans = laps(0.09, 190)
    engine = make_slam("cartographer")
    for pose, scan in zip(frozen(truth, scans=100), scans, strict=True):
        engine.update(pose, scan)
    np.testing.assert_allclose(engine.calibration.factors, [1.0, 1.0, 0.0], atol=0.005)
    assert engine.calibration.drift(5.0)[1] < 0.2
