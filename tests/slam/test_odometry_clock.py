"""Odometry that comes late: by how much is learned from where the robot brakes and turns, and made up for."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam import make_slam
from tagalong.slam.geometry import between
from tagalong.slam.local.odometry_clock import OdometryClock
from tagalong.slam.scan_to_grid.extrapolator import ExtrapolatorConfig
from walls import cast

CLEAR = np.diag([1e4, 1e4, 1e5])  # information of a scan that tells the place to centimetres
ROOM = np.array([[-4.0, -3.0, 5.0, -3.0], [5.0, -3.0, 5.0, 4.0], [5.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0]])
STEP_S = 0.2


def tour(times_s):
    """Return where a robot is at some times (n,) [s], which speeds up, brakes and turns: (n, 3)."""
    fine = np.arange(-1.0, times_s.max() + 1.0, 0.01)
    turn = 0.5 * np.sin(0.9 * fine)
    heading, speed = np.cumsum(turn) * 0.01, 0.4 + 0.3 * np.sin(1.3 * fine)
    places = np.cumsum(np.stack((speed * np.cos(heading), speed * np.sin(heading)), axis=-1), axis=0) * 0.01
    return np.stack([np.interp(times_s, fine, axis) for axis in (*places.T, heading)], axis=-1)


def learned(late_s, stamps=None, scans=200, information=CLEAR):
    """Return the clock of a robot whose odometry is so late, and how far off it is at each scan (n, 3)."""
    times = STEP_S * np.arange(scans)
    truth, odometry, clock = tour(times), tour(times - late_s), OdometryClock(ExtrapolatorConfig())
    told = []
    for k, stamp in enumerate(times if stamps is None else stamps):
        told.append(clock.apply(odometry[k], stamp))
        if k:
            clock.learn(between(truth[k - 1], truth[k]), information)
    return clock, between(truth, np.array(told))


@pytest.mark.parametrize("late_s", [-0.2, -0.1, 0.0, 0.1, 0.3])
def test_how_late_odometry_is_is_learned(late_s):
    assert learned(late_s)[0].late_s == pytest.approx(late_s, abs=0.04)


def test_late_odometry_is_made_up_for():
    off = np.abs(learned(0.2)[1][:, 2])
    assert off[-50:].mean() < 0.5 * off[:10].mean()


def test_an_even_drive_says_nothing():
    clock = OdometryClock(ExtrapolatorConfig())
    for k in range(50):
        clock.apply(np.array([0.2 * k - 0.1, 0.0, 0.0]), 0.2 * k)
        clock.learn(np.array([0.2, 0.0, 0.0]), CLEAR)
    assert clock.late_s == pytest.approx(0.0, abs=1e-6)


def test_what_scans_do_not_tell_is_not_learned():
    assert learned(0.3, information=np.zeros((3, 3)))[0].late_s == 0.0


def test_stamps_that_tell_no_time_leave_odometry_as_it_is():
    clock, off = learned(0.2, stamps=np.zeros(200))
    assert clock.late_s == 0.0
    np.testing.assert_allclose(off, between(tour(STEP_S * np.arange(200)), tour(STEP_S * np.arange(200) - 0.2)))


def test_stamps_in_bursts_make_no_odometry_jump():
    times = STEP_S * np.arange(200)
    bursts = 0.8 * np.floor(times / 0.8) + 1e-3 * (np.arange(200) % 4)
    off = learned(0.0, stamps=bursts)[1]
    assert np.abs(np.diff(off[:, :2], axis=0)).max() < 0.05


def test_odometry_that_stands_still_is_told_as_standing_still():
    clock, times = OdometryClock(ExtrapolatorConfig()), 0.5 * np.arange(6)
    clock.late_s = 0.2
    told = [clock.apply(np.array([x, 0.0, 0.0]), t) for x, t in zip((0.0, 0.5, 1.0, 1.0, 1.0, 3.0), times, strict=True)]
    assert [pose[0] for pose in told] == pytest.approx([0.0, 0.7, 1.2, 1.2, 1.2, 3.0 + 0.2 * 2.0 / 1.5])


def test_graph_slam_learns_how_late_the_odometry_is():
    times, rng = STEP_S * np.arange(250), np.random.default_rng(0)
    truth = tour(times)
    truth[:, :2] = 2.0 * np.sin(0.7 * truth[:, :2])
    bearings, engine = np.deg2rad(np.arange(-135.0, 135.0, 1.5)), make_slam("cartographer")
    late = np.stack([np.interp(times - 0.2, times, axis) for axis in truth.T], axis=-1)
    for k, pose in enumerate(truth):
        engine.update(late[k], replace(cast(ROOM, pose, rng, bearings=bearings), time_s=times[k]))
    assert engine.clock.late_s == pytest.approx(0.2, abs=0.06)
