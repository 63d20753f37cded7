"""A robot that is found elsewhere on its map: the map has drifted, and a loop is closed, or the robot was carried."""

from types import SimpleNamespace

import numpy as np
import pytest
from long_corridor import LINES, REACH, along, drive
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.local.local_slam import LocalResult
from walls import cast


@pytest.fixture
def engine():
    """Return an engine that has mapped 26 m of a corridor and driven back, in doubt where it is."""
    engine = make_slam("cartographer")
    assert isinstance(engine, Cartographer)
    drive(engine, [along(2.0, 28.0), along(28.0, 12.0)], np.zeros(3))
    recovery = engine._recovery
    recovery._mark = engine._mapping.mark()
    recovery._doubt = SimpleNamespace(
        found=True, changed=0, scans=12, elsewhere=None, vouched=False, settled=False, travelled=3.0
    )
    return engine


def found(engine, moved):
    """Let the robot be found where the graph has it, but for a motion (3,); return the last scan's result."""
    recovery, graph = engine._recovery, engine._global
    pose_local = engine.local_trajectory()[-1]
    here = compose(graph.local_to_global, pose_local)
    recovery._doubt.elsewhere = compose(here, np.array(moved))
    result = SimpleNamespace(pose=pose_local)
    recovery._scans = [(np.zeros(3), cast(LINES, here, np.random.default_rng(0), REACH), pose_local)]
    return recovery._concluded(recovery._doubt, result), recovery._doubt, result


def test_where_the_graph_agrees_the_loop_is_closed_and_nothing_is_taken_back(engine):
    graph = engine._global.graph
    nodes = len(graph.nodes)
    result, doubt, given = found(engine, (0.1, 0.05, 0.0))
    assert result is given
    assert doubt is None
    assert (engine.losses, engine.relocalizations, len(graph.nodes)) == (0, 0, nodes)
    closure = graph.constraints[-1]
    assert closure.searched
    assert closure.node == nodes - 1
    assert closure.submap not in graph.nodes[-1].submaps


def test_where_the_graph_contradicts_the_place_the_robot_was_carried(engine):
    before, ties = engine.node_poses.copy(), len(engine.constraints)
    assert not engine._global.close_at(compose(before[-1], np.array([-9.0, 0.5, 2.0])), engine.local_trajectory()[-1])
    assert len(engine.constraints) == ties
    assert np.abs(engine.node_poses - before).max() < 0.05


def test_a_closure_that_the_graph_meets_only_roughly_is_taken_back(engine, monkeypatch):
    monkeypatch.setattr(engine._global.graph, "meets", lambda *_: False)
    ties, pose = len(engine.constraints), engine.node_poses[-1]
    assert not engine._global.close_at(pose, engine.local_trajectory()[-1])
    assert len(engine.constraints) == ties


def test_a_closure_has_time_to_tell_that_the_map_has_drifted(engine, monkeypatch):
    monkeypatch.setattr(engine._global, "close_at", lambda *_: False)
    result, doubt, given = found(engine, (-5.0, 0.0, 0.0))
    assert result is given
    assert doubt is not None
    assert engine.losses == 0


def test_where_local_slam_has_left_its_submap_no_loop_is_closed(engine, monkeypatch):
    pieces, node = engine._global.graph.pieces, len(engine._global.graph.nodes) - 1
    monkeypatch.setattr(pieces, "first_node", lambda _: node + 1)  # begun since
    monkeypatch.setattr(engine._global, "close_at", lambda *_: pytest.fail("asked"))
    place, apart = [], []
    monkeypatch.setattr(engine._global, "place_segment", lambda pose, _: place.append(pose))
    monkeypatch.setattr(engine._recovery, "_set_apart", lambda first: apart.append(first) or SimpleNamespace(pose=0))
    found(engine, (-5.0, 0.0, 0.0))
    assert apart == [0]
    assert len(place) == engine.relocalizations == 1


def test_a_map_without_a_finished_submap_closes_no_loop():
    engine = make_slam("cartographer")
    assert isinstance(engine, Cartographer)
    drive(engine, [along(2.0, 3.0)], np.zeros(3))
    assert not engine._global.close_at(np.zeros(3), np.zeros(3))


def test_where_no_closure_tells_so_for_long_the_robot_was_carried(engine, monkeypatch):
    place = []
    monkeypatch.setattr(engine._global, "close_at", lambda *_: False)
    monkeypatch.setattr(engine._recovery, "_set_apart", lambda first: SimpleNamespace(pose=first))
    monkeypatch.setattr(engine._global, "place_segment", lambda pose, _: place.append(pose))
    engine._recovery._doubt.travelled = 21.0
    _, doubt, _ = found(engine, (-5.0, 0.0, 0.0))
    assert doubt is None
    assert len(place) == 1


@pytest.mark.parametrize("fault", [False, True])
def test_odometry_that_is_not_believed_raises_a_doubt(engine, fault):
    recovery, pose = engine._recovery, engine.local_trajectory()[-1]
    recovery._forget()
    scan = cast(LINES, pose, np.random.default_rng(0), REACH)
    result = LocalResult(pose, None, None, contradicts=False, odometry_fault=fault)
    assert recovery.review(result, pose, scan) is result
    assert (recovery._doubt is not None) == fault


@pytest.mark.parametrize("sign", ["contradicts", "odometry_fault", "jumped"])
def test_one_scan_with_any_sign_asks_the_map_and_one_that_fits_there_ends_it(sign):
    engine = make_slam("cartographer")
    assert isinstance(engine, Cartographer)
    drive(engine, [along(2.0, 10.0)], np.zeros(3))
    recovery, place = engine._recovery, engine.local_trajectory()[-1]
    assert recovery is not None
    scan = cast(LINES, engine.pose, np.random.default_rng(0), REACH)
    recovery.review(LocalResult(place, None, None), np.zeros(3), scan)
    assert recovery._doubt is None
    recovery.review(LocalResult(place, None, None, **{sign: True}), np.zeros(3), scan)
    assert recovery._doubt is not None
    for _ in range(5):
        recovery.review(LocalResult(place, None, None), np.zeros(3), scan)
    assert recovery._doubt is None
