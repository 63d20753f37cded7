"""Gaps in a log: the first scan after one sees nothing of what was mapped; odometry alone leads there, if anything."""

import numpy as np
import pytest
from long_corridor import LINES, REACH, along, drive
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between
from tagalong.slam.graph.engine import Cartographer
from walls import cast


def errors(engine, truth):
    engine.finish()
    off = between(truth, engine.trajectory())
    return np.hypot(off[:, 0], off[:, 1])


def test_after_a_gap_the_odometry_is_believed_and_not_a_match_on_what_was_never_seen():
    engine, slip = make_slam("cartographer"), np.array([0.3, 0.4, 0.1])
    updates, _, odometry = drive(engine, [along(2.0, 8.0), along(14.0, 17.0)], slip)
    assert isinstance(engine, Cartographer)
    assert engine.losses == 0
    assert all(update.located for update in updates[:61])
    before, after = updates[60].pose, updates[61].pose
    np.testing.assert_allclose(between(before, after), between(odometry[60], odometry[61]), atol=0.05)


def test_what_the_odometry_missed_in_a_gap_is_known_once_the_robot_comes_back():
    engine, slip = make_slam("cartographer"), np.array([0.3, 0.4, 0.1])
    updates, truth, _ = drive(engine, [along(2.0, 8.0), along(14.0, 17.0), along(17.0, 3.0)], slip * 0.5)
    assert errors(engine, truth).max() < 0.2
    located = np.array([update.located for update in updates])
    assert located[:61].all()
    assert not located[61:130].any()  # six metres by odometry of which little is known
    assert located[-15:].all()


def test_after_a_gap_new_submaps_begin_so_that_the_graph_can_move_what_follows():
    engine = make_slam("cartographer")
    drive(engine, [along(2.0, 8.0)], np.zeros(3))
    assert isinstance(engine, Cartographer)
    before = len(engine.submap_nodes)
    drive(engine, [along(14.0, 15.0)], np.zeros(3))
    assert len(engine.submap_nodes) > before
    first = len(engine.node_scans) - sum(k >= 61 for k in engine.node_scans)
    assert all(max(nodes) < first or min(nodes) >= first for nodes in engine.submap_nodes)


def test_a_drive_is_mapped_as_if_nobody_looked_on_where_no_robot_was_carried():
    paths = []
    for recovery in (True, False):
        engine = make_slam("cartographer", recovery=recovery)
        drive(engine, [along(2.0, 8.0), along(14.0, 17.0), along(17.0, 3.0)], np.array([0.15, 0.2, 0.05]))
        engine.finish()
        paths.append(engine.trajectory().tobytes())
    assert paths[0] == paths[1]


def test_a_found_drive_segment_is_tied_to_the_map_around_it_and_not_to_where_the_robot_got_lost():
    engine, slip = make_slam("cartographer"), np.zeros(3)
    assert isinstance(engine, Cartographer)
    drive(engine, [along(2.0, 12.0)], slip)
    graph = engine._global  # pyright: ignore[reportPrivateUsage]
    assert graph is not None
    nodes, ties = len(graph.graph.nodes), len(graph.graph.constraints)
    mapping = engine._mapping  # pyright: ignore[reportPrivateUsage]
    mapping.rewind(mapping.mark())
    rng = np.random.default_rng(1)
    engine.update(np.array([3.0, 0.0, 0.0]), cast(LINES, np.array([4.0, 0.0, 0.0]), rng, REACH))
    graph.place_segment(np.array([4.0, 0.0, 0.0]), engine.local_trajectory()[-1])
    found = [c for c in graph.graph.constraints[ties:] if c.node == nodes and c.searched]
    assert len(found) == 1
    assert np.linalg.inv(found[0].information)[0, 0] == pytest.approx(0.1**2)
    assert (graph.graph.nodes[nodes].motion.sigma > 1.0).all()
