"""Loop closure after a gap in a log: submaps of before it have to be found, for none of them is known to be near."""

import numpy as np
import pytest
from tagalong.slam.geometry import compose
from tagalong.slam.graph.engine import Cartographer, CartographerConfig
from tagalong.slam.local.active_submaps import ActiveSubmapsConfig
from tagalong.slam.local.local_slam import LocalSlamConfig
from walls import cast

REACH = 4.0  # [m] of the laser


def corridor():
    """Return (k, 4) walls of a corridor of 30 m with cupboards on both sides, no two alike."""
    rng = np.random.default_rng(3)
    lines = [(0.0, -1.5, 30.0, -1.5), (0.0, 1.5, 30.0, 1.5), (0.0, -1.5, 0.0, 1.5), (30.0, -1.5, 30.0, 1.5)]
    for x in np.arange(0.6, 29.0, 1.3):
        wide, deep, side = rng.uniform(0.3, 0.8), rng.uniform(0.2, 0.8), rng.choice([-1.0, 1.0])
        face = side * (1.5 - deep)
        lines += [(x, face, x + wide, face), (x, face, x, side * 1.5), (x + wide, face, x + wide, side * 1.5)]
    return np.array(lines)


def drive(engine, places, slip):
    """Feed scans at `places` [m] along the corridor, the odometry off by `slip` (3,)."""
    lines, rng = corridor(), np.random.default_rng(0)
    for x in places:
        pose = np.array([x, 0.0, 0.0])
        engine.update(compose(slip, pose), cast(lines, pose, rng, REACH))


@pytest.fixture
def engine():
    submaps = ActiveSubmapsConfig(scans=8)  # short ones, so that some are finished soon
    return Cartographer(CartographerConfig(local=LocalSlamConfig(submaps=submaps)))


@pytest.mark.parametrize("gap_m", [0.0, 5.0])
def test_submaps_of_before_a_gap_do_not_count_as_tied(engine, gap_m):
    """Without a gap, scans are matched with the submaps before theirs as soon as these are finished, unsearched."""
    drive(engine, np.arange(2.0, 6.0, 0.1), np.zeros(3))
    matching, begun, tracked = engine._global._matching, len(engine._mapping.local.submaps), []
    track = matching.track
    matching.track = lambda s, nodes: tracked.append(s) or track(s, nodes)
    drive(engine, np.arange(6.0, 11.0, 0.1) + gap_m, np.array([0.0, 0.3, 0.05]) * (gap_m > 0.0))
    assert engine.losses == 0
    assert len(engine._mapping.local.submaps) >= begun + 2
    assert any(s < begun for s in tracked) == (gap_m == 0.0)
