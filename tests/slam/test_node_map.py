"""The map on which a lost robot is searched for: of the nodes around it, and of no more than it takes."""

from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.graph.recovery import node_map
from tagalong.slam.graph.recovery.node_map import NodeMap
from walls import cast

WALLS = np.array([[-4.0, -3.0, 25.0, -3.0], [25.0, -3.0, 25.0, 4.0], [25.0, 4.0, -4.0, 4.0], [-4.0, 4.0, -4.0, -3.0]])


def drawn_of(poses, monkeypatch):
    """Return the poses of the nodes that are drawn around the last of `poses`."""
    drawn, rng, draw = [], np.random.default_rng(0), node_map.draw
    monkeypatch.setattr(node_map, "draw", lambda placed, *rest: drawn.append(placed) or draw(placed, *rest))
    scans = [cast(WALLS, pose, rng, bearings=np.linspace(-1.5, 1.5, 60)) for pose in poses]
    segments = SimpleNamespace(placed_nodes=np.ones(len(poses), dtype=np.bool_))
    made = NodeMap(SimpleNamespace(graph=SimpleNamespace(segments=segments)), SimpleNamespace(scans=scans))  # pyright: ignore[reportArgumentType]
    assert made.around(np.array(poses)) is not None
    return drawn[0]


@pytest.mark.parametrize("laps", [1, 4])
def test_however_often_the_robot_was_there_no_more_is_drawn(monkeypatch, laps):
    lap = [np.array([x, 0.0, 0.0]) for x in np.linspace(0.0, 10.0, 120)]
    drawn = drawn_of(lap * laps, monkeypatch)
    assert len(drawn) <= 300
    assert len(drawn) >= 100
    assert drawn[:, 0].max() - drawn[:, 0].min() > 9.0


def test_only_what_a_laser_may_see_from_there_is_drawn(monkeypatch):
    drawn = drawn_of([np.array([x, 0.0, 0.0]) for x in np.linspace(0.0, 20.0, 41)], monkeypatch)
    assert drawn[:, 0].min() == pytest.approx(5.0)
    assert len(drawn) == 31
