"""Odometry by local SLAM: what wheels tell wrongly, scans put right, and memory stays the same."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose
from tagalong.slam.local.local_odometry import AsTold, LocalOdometry
from tagalong.slam.local.local_slam import LocalSlamConfig
from walls import cast

CORNERS = [(-6, -4), (6, -4), (6, 1), (3.5, 1), (3.5, 4), (-6, 4), (-6, -4)]
CHEST = [(1.0, 1.2), (1.8, 1.2), (1.8, 2.0), (1.0, 2.0), (1.0, 1.2)]
ROOM = np.array([(*one, *other) for line in (CORNERS, CHEST) for one, other in pairwise(line)], dtype=np.float64)
STEP = np.array([0.1, 0.0, 0.04])


def led(odometry, told, count, blind=0):
    """Return true poses and what `odometry` makes of what is `told` (scan, step) of a drive, which ends `blind`."""
    rng = np.random.default_rng(0)
    true, wheels, truth, made = np.array([0.0, -2.5, 0.0]), np.zeros(3), [], []
    for k in range(count):
        truth.append(true)
        reach = 20.0 if k < count - blind else 0.1
        made.append(odometry.update(wheels, replace(cast(ROOM, true, rng, reach), time_s=0.1 * k)))
        true, wheels = compose(true, STEP), compose(wheels, told(k, STEP))
    return np.array(truth), np.array(made)


@pytest.mark.parametrize(
    "told",
    [
        lambda k, step: step * 1.15,
        lambda k, step: step * (0.0 if k % 12 in (7, 8) else 1.0),
        lambda k, step: step + np.array([0.0, 0.0, 0.2 * (k == 20)]),
    ],
    ids=["scaled", "slips", "turns-once"],
)
def test_scans_put_right_what_wheels_tell_wrongly(told):
    truth, made = led(LocalOdometry(LocalSlamConfig()), told, 60)
    off = between(between(truth[0], truth), between(made[0], made))
    assert np.hypot(off[:, 0], off[:, 1]).max() < 0.1
    assert np.abs(off[:, 2]).max() < 0.04
    _, by_wheels = led(AsTold(), told, 60)
    assert np.abs(between(between(truth[0], truth), by_wheels)[-1]).max() > 0.15


def test_no_more_than_the_growing_submaps_are_kept():
    odometry = LocalOdometry(LocalSlamConfig())
    led(odometry, lambda k, step: step, 300)
    assert len(odometry._local.submaps) <= 2


def test_what_was_learned_of_the_wheels_holds_where_no_scan_tells_anything():
    def gone(odometry):
        truth, made = led(odometry, lambda k, step: step * 1.15, 270, blind=20)
        return between(between(truth[-20], truth[-1]), between(made[-20], made[-1]))

    assert np.abs(gone(LocalOdometry(LocalSlamConfig()))).max() < 0.5 * np.abs(gone(AsTold())).max()


def test_scans_wait_while_the_odometry_stands_still():
    odometry = LocalOdometry(LocalSlamConfig())
    led(odometry, lambda k, step: step * (k < 20), 24)
    assert len(odometry._local._held.scans) == 3
