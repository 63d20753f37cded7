"""Loop closures are sought for a stretch of the drive, and a piece must agree with what was mapped before it."""

import numpy as np
import pytest
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.graph.loops.loop_search import are_apart
from tagalong.slam.graph.loops.piece_fit import agrees, ends_and_passes
from tagalong.slam.graph.loops.stretch import STRETCH, stretch
from walls import cast

REACH = 6.0  # [m] of the laser


def box(x, y, u, v):
    """Return the four walls of a box between two corners [m]."""
    return [(x, y, u, y), (u, y, u, v), (u, v, x, v), (x, v, x, y)]


def ring(seed=3):
    """Return (k, 4) walls of a corridor around a block of 16 m x 10 m, with cupboards along it, no two alike."""
    rng = np.random.default_rng(seed)
    walls = [*box(0.0, 0.0, 20.0, 14.0), *box(2.0, 2.0, 18.0, 12.0)]
    for k in range(32):
        wide, deep = rng.uniform(0.3, 0.8), rng.uniform(0.2, 0.6)
        x, y = rng.uniform(2.5, 17.0), rng.uniform(2.5, 11.0)
        along = [(x, 0.0, x + wide, deep), (x, 14.0 - deep, x + wide, 14.0)]
        across = [(0.0, y, deep, y + wide), (20.0 - deep, y, 20.0, y + wide)]
        walls += box(*[*along, *across][k % 4])
    return np.array(walls)


def rounds(n):
    """Return (k, 3) poses of so many rounds through the corridor."""
    corners, path = [(1.0, 1.0), (19.0, 1.0), (19.0, 13.0), (1.0, 13.0)], []
    for k in range(4 * n):
        a, b = np.array(corners[k % 4]), np.array(corners[(k + 1) % 4])
        heading = float(np.arctan2(*(b - a)[::-1]))
        path += [(*p, heading) for p in np.linspace(a, b, int(np.hypot(*(b - a)) / 0.2), endpoint=False)]
        path += [(*b, heading + t) for t in np.linspace(0.0, np.pi / 2, 8)]
    return np.array(path)


def drive(truth, cut, slip):
    """Return an engine after a drive whose scans in `cut` are missing and whose odometry is off by `slip` after it."""
    engine, walls, rng = Cartographer(), ring(), np.random.default_rng(0)
    odometry, kept = truth[0], []
    for k, place in enumerate(truth):
        if k:
            odometry = compose(odometry, between(truth[k - 1], place))
        if k == cut.stop:
            odometry = compose(odometry, slip)
        if k not in cut:
            engine.update(odometry, cast(walls, place, rng, REACH))
            kept.append(k)
    return engine, np.array(kept)


@pytest.fixture(scope="module")
def drives():
    """Return an engine with two rounds and a gap in the second, its odometry turned by half a radian there."""
    truth = rounds(2)
    cut = range(430, 480)
    engine, kept = drive(truth, cut, np.array([1.0, -2.0, 0.5]))
    return engine, truth[kept], kept


def test_a_piece_after_a_gap_is_found_though_odometry_is_off_by_metres_and_half_a_radian(drives):
    engine, truth, _ = drives
    engine.finish()
    error = between(compose(truth[0], between(engine.trajectory()[0], engine.trajectory())), truth)
    assert engine.losses == 0
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.3
    assert np.abs(error[:, 2]).max() < 0.05


def test_a_stretch_is_what_was_seen_on_the_last_metres_of_its_piece(drives):
    engine, _, _ = drives
    graph = engine._global.graph
    nodes = np.array([node.pose_local for node in graph.nodes])
    first = graph.pieces.first_node(len(nodes) - 1)
    assert first > 0
    alone, longer = len(stretch(graph, first)), len(stretch(graph, first + 30))
    assert alone <= len(graph.nodes[first].points)
    assert longer > 1.5 * alone
    way = np.hypot(*np.diff(nodes[:, :2], axis=0).T)
    assert way[first : first + 30].sum() > STRETCH / 2.0


def test_a_piece_agrees_with_the_map_where_it_lies_and_not_across_its_walls(drives):
    engine, _, _ = drives
    graph = engine._global.graph
    last = len(graph.nodes) - 1
    first = graph.pieces.first_node(last)
    before = [s for s in range(len(graph.submaps) - 2) if max(graph.drawn[s]) < first]
    pose = graph.node_poses[last]
    assert agrees(graph, before, last, pose, 15.0)
    for off in ((3.0, 3.0, 0.0), (0.0, 0.0, 1.57), (-4.0, 2.0, 0.8)):
        assert not agrees(graph, before, last, compose(pose, np.array(off)), 15.0), off


@pytest.mark.parametrize(("through", "right"), [(4, True), (30, False)])
def test_a_piece_of_which_many_beams_come_through_walls_lies_elsewhere(drives, monkeypatch, through, right):
    """At right places 26 and more beams end at walls for each that comes through one, at a wrong one three."""
    graph, told = drives[0]._global.graph, (100, through)
    monkeypatch.setattr("tagalong.slam.graph.loops.piece_fit.ends_and_passes", lambda *_: told)
    last = len(graph.nodes) - 1
    assert agrees(graph, [0, 1], last, graph.node_poses[last], 100.0) == right


def test_beams_that_end_at_a_wall_and_beams_that_come_through_it_are_counted():
    field = np.zeros((40, 40), np.float32)
    field[:, 20] = 1.0  # a wall 1 m ahead of a laser at the left edge
    points = np.array([[1.0, 0.1], [1.02, -0.1], [1.8, 0.0], [0.5, 0.0]])
    told = ends_and_passes(field, np.array([0.0, -1.0]), 0.05, np.zeros(2), points, np.zeros(3))
    assert told == (2, 1)


def test_places_a_metre_or_a_third_of_a_radian_apart_are_different():
    pose = np.array([2.0, 1.0, 3.1])
    assert not are_apart(pose, compose(pose, [0.5, 0.5, 0.3]))
    assert are_apart(pose, compose(pose, [0.9, 0.6, 0.0]))
    assert are_apart(pose, compose(pose, [0.0, 0.0, -0.4]))
