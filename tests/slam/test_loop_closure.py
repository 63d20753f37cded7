"""Loop closures in a building that looks the same every three metres: wrong ones are rejected and counted."""

from itertools import pairwise

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose, inverse
from tagalong.slam.graph.engine import Cartographer, CartographerConfig
from tagalong.slam.graph.loops.constraints import Kind
from tagalong.slam.graph.loops.global_config import GlobalSlamConfig
from tagalong.slam.local.active_submaps import ActiveSubmapsConfig
from tagalong.slam.local.local_slam import LocalSlamConfig
from walls import cast

BAYS, PERIOD, REACH = 10, 3.0, 4.0


def corridor():
    """Return (m, 4) walls of a corridor with equal bays on both sides."""
    lines = [(0.0, -1.0, 0.0, 1.0), (BAYS * PERIOD, -1.0, BAYS * PERIOD, 1.0)]
    for x in PERIOD * np.arange(BAYS):
        for side in (-1.0, 1.0):
            corners = [(x, 1.0), (x + 1.0, 1.0), (x + 1.0, 1.8), (x + 2.0, 1.8), (x + 2.0, 1.0), (x + PERIOD, 1.0)]
            lines += [(a, side * b, c, side * d) for (a, b), (c, d) in pairwise(corners)]
    return np.array(lines)


def there_and_back():
    """Return (n, 3) poses down the corridor, a turn on the spot, and back."""
    x = np.arange(1.5, BAYS * PERIOD - 1.5, 0.15)
    there = np.stack((x, 0.2 * np.sin(x), 0.04 * np.cos(x)), axis=-1)
    turn = np.tile(there[-1], (20, 1))
    turn[:, 2] = np.linspace(there[-1, 2], np.pi, 20)
    back = there[::-1].copy()
    back[:, 2] = np.pi
    return np.concatenate((there, turn, back))


@pytest.mark.parametrize("seed", [0, 1])
def test_closures_one_bay_off_are_rejected_and_counted(seed):
    rng, lines, truth = np.random.default_rng(seed), corridor(), there_and_back()
    odometry = [truth[0]]
    for motion in between(truth[:-1], truth[1:]):
        slip = motion * [1.03, 1.0, 1.0] + rng.normal(0.0, 1.0, 3) * [0.003, 0.003, 0.002]
        odometry.append(compose(odometry[-1], slip))
    submaps = ActiveSubmapsConfig(scans=15, distance=2.0)  # short ones, so that a scan is searched for bays away
    engine = Cartographer(
        CartographerConfig(local=LocalSlamConfig(submaps=submaps), global_=GlobalSlamConfig(search_every=0.3))
    )
    for pose, place in zip(odometry, truth, strict=True):
        engine.update(pose, cast(lines, place, rng, REACH))
    engine.finish()
    error = between(truth, engine.trajectory())
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.3  # a bay is 3 m
    assert engine.rejected >= 5
    places, first = truth[engine.node_scans], {}
    for tie in engine.constraints:
        if tie.kind is Kind.INTRA:
            first.setdefault(tie.submap, compose(places[tie.node], inverse(tie.pose)))
    ties = [tie for tie in engine.constraints if tie.kind is Kind.INTER]
    wrong = [between(tie.pose, between(first[tie.submap], places[tie.node])) for tie in ties]
    assert len(ties) > 300
    assert np.hypot(*np.array(wrong)[:, :2].T).max() < 0.5
