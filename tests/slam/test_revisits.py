"""Laps of one room: what every engine keeps stops growing, and where the robot was stays known."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose
from tagalong.slam.gmapping.paths import PathTree
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.graph.loops.constraints import Constraint, Kind
from tagalong.slam.graph.loops.node import Node
from tagalong.slam.graph.loops.trimming import Renumbering, TrimmedNodes
from tagalong.slam.pose_log import PoseLog
from tagalong.slam.revisits import KeptScans, RevisitConfig, superseded
from tagalong.slam.scan import LaserScan
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from walls import cast

ROOM = np.array(
    [(0.0, 0.0, 6.0, 0.0), (6.0, 0.0, 6.0, 4.0), (6.0, 4.0, 0.0, 4.0), (0.0, 4.0, 0.0, 0.0), (2.0, 2.0, 3.0, 2.0)]
)
LAPS, STEPS = 22, 40


def laps(rng):
    """Return (n, 3) true poses round the room and (n, 3) odometry that slips."""
    turn = np.linspace(0.0, 2.0 * np.pi * LAPS, STEPS * LAPS)
    truth = np.stack((3.0 + 1.8 * np.cos(turn), 2.0 + 1.2 * np.sin(turn), turn + 0.5 * np.pi), axis=-1)
    truth[:, 2] = np.arctan2(np.sin(truth[:, 2]), np.cos(truth[:, 2]))
    odometry = [truth[0]]
    for motion in between(truth[:-1], truth[1:]):
        odometry.append(compose(odometry[-1], motion + rng.normal(0.0, 1.0, 3) * [0.005, 0.005, 0.003]))
    return truth, np.array(odometry)


@pytest.fixture(scope="module")
def lapped():
    """Return an engine after many laps, how many nodes it had after each scan, and the truth."""
    rng = np.random.default_rng(3)
    truth, odometry = laps(rng)
    engine, nodes = Cartographer(), []
    for pose, place in zip(odometry, truth, strict=True):
        engine.update(pose, cast(ROOM, place, rng, 10.0))
        nodes.append(len(engine.node_scans))
    return engine, nodes, truth


def test_laps_of_one_room_leave_a_graph_that_grows_no_more(lapped):
    engine, nodes, _ = lapped
    assert max(nodes[len(nodes) // 2 :]) <= 1.1 * max(nodes[: len(nodes) // 2])
    assert nodes[-1] < 0.8 * len(engine._record)
    assert len(engine._record.scans) == len(engine.node_scans) == len(engine.node_poses)
    assert len(engine.submap_nodes) == len(engine._mapping.local.submaps)


def test_the_trajectory_keeps_every_scan_of_what_has_left_the_graph(lapped):
    engine, _, truth = lapped
    engine.finish()
    error = between(truth, engine.trajectory())
    assert len(error) == len(truth)
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.06
    assert np.abs(error[:, 2]).max() < 0.03
    assert engine.losses == 0


def test_what_is_left_of_a_graph_hangs_together(lapped):
    engine, _, _ = lapped
    graph = engine._global.graph
    for s, nodes in enumerate(graph.drawn):
        assert all(s in graph.nodes[k].submaps for k in nodes)
    for tie in graph.constraints:
        assert tie.submap < len(graph.drawn)
        assert tie.node < len(graph.nodes)
        assert (tie.kind is Kind.INTRA) == (tie.node in graph.drawn[tie.submap])
    inserted = np.array(engine.node_scans)
    assert (np.diff(inserted) > 0).all()
    assert not set(engine._record._trimmed) & set(inserted.tolist())


def test_a_pose_is_superseded_by_later_ones_of_the_same_view_only():
    config = RevisitConfig(views=2)
    same = np.zeros((4, 3))
    assert superseded(same, config).tolist() == [True, True, False, False]
    turned = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, np.pi], [0.0, 0.0, 1.0], [0.6, 0.0, 0.0]])
    assert not superseded(turned, config).any()
    across = np.array([[0.0, 0.0, np.pi - 0.1], [0.0, 0.0, -np.pi + 0.1], [0.1, 0.0, np.pi]])
    assert superseded(across, config).tolist() == [True, False, False]
    assert superseded(np.zeros((0, 3)), config).tolist() == []


@pytest.mark.parametrize("wrong", [{"views": 0}, {"distance": 0.0}, {"angle": 4.0}, {"angle": float("nan")}])
def test_a_view_that_makes_no_sense_is_refused(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        RevisitConfig(**wrong)


def test_the_scans_of_a_map_stop_growing_and_the_newest_stay():
    kept, scan = KeptScans(), LaserScan(np.ones(3), np.arange(3.0), 0.0, 2.0)
    assert scan.points.shape == (3, 2)
    for number in range(5000):
        kept.append(number, scan)
        if kept.due:
            kept.thin(np.zeros((len(kept), 3)))
    assert len(kept) < 300
    assert kept.numbers[-12:] == list(range(4988, 5000))
    assert "points" not in vars(kept.scans[-1])  # what was computed from it would be seven times as large


def test_poses_in_a_log_are_those_that_were_put_in():
    log = PoseLog()
    assert log.array().shape == (0, 3)
    for k in range(5):
        log.append([k, 0.5, -k])
    log[1] = np.array([9.0, 9.0, 9.0])
    assert (len(log), log[-1].tolist(), log[1].tolist()) == (5, [4.0, 0.5, -4.0], [9.0, 9.0, 9.0])
    log.array()[0] = 7.0
    log.extend(np.arange(12.0).reshape(4, 3))
    log.cut(5, 7)
    assert log.take(np.array([6, 0])).tolist() == [[9.0, 10.0, 11.0], [0.0, 0.5, 0.0]]
    log.cut(5, 7)
    assert log[0].tolist() == [0.0, 0.5, 0.0]
    with pytest.raises(IndexError):
        log[5]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_paths_through_the_trunk_are_those_through_all_layers(seed):
    rng, tree, paths = np.random.default_rng(seed), PathTree(), np.zeros((6, 0, 3))
    for layer in range(200):
        poses = rng.normal(size=(6, 3))
        tree.append(poses)
        paths = np.concatenate((paths, poses[:, None]), axis=1)
        if rng.random() < 0.4 or layer == 150:
            parents = np.sort(rng.integers(0, 6, 6)) if layer != 150 else np.full(6, 3)  # all others die out
            tree.resample(parents)
            paths = paths[parents]
        assert len(tree) == layer + 1
    for particle in range(6):
        np.testing.assert_array_equal(tree.path(particle), paths[particle])
    assert len(tree._poses) < 6 * 120  # the rest is the same for all


def test_a_layer_of_paths_without_resampling_takes_the_memory_of_its_poses_alone():
    tree, rng, layers, particles = PathTree(), np.random.default_rng(0), 4000, 30
    tracemalloc.start()
    for _ in range(layers):
        tree.append(rng.normal(size=(particles, 3)))
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held / layers < 1.1 * 24 * particles  # bytes; lists of arrays took 1.7 times that


def test_nodes_that_leave_hang_on_the_nearest_submap_that_stays_wherever_that_moves():
    node_poses = np.array([[0.0, 1.0, 0.0], [5.0, 1.0, 1.0], [9.0, 0.0, 0.0]])
    submap_poses = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.5], [9.0, 0.0, 0.0]])
    stay = Renumbering(np.array([False, True, True]), np.array([False, True, True]))
    trimmed = TrimmedNodes.none().after(stay, node_poses, submap_poses, np.array([1, 2]))
    left = submap_poses[1:]
    np.testing.assert_allclose(trimmed.on(left), node_poses[:1], atol=1e-12)
    moved = compose(np.array([1.0, 2.0, 0.3]), left)
    np.testing.assert_allclose(trimmed.on(moved), compose(np.array([1.0, 2.0, 0.3]), node_poses[:1]), atol=1e-12)
    again = Renumbering(np.array([False, True]), np.array([False, True]))
    rest = trimmed.after(again, node_poses[1:], left, np.array([1]))
    np.testing.assert_allclose(rest.on(left[1:]), node_poses[:2], atol=1e-12)


def test_the_odometry_leads_over_nodes_that_have_left():
    step = Prediction(np.array([1.0, 0.0, 0.5 * np.pi]), np.array([0.3, 0.04]))
    scan = LaserScan(np.ones(3), np.arange(3.0), 0.0, 2.0)
    nodes = [Node(np.zeros(3), np.zeros((0, 2)), (0, 1), step, scan) for _ in range(4)]
    stay = Renumbering(np.array([True, False, False, True]), np.array([False, True]))
    first, last = stay.chain(nodes)
    np.testing.assert_allclose(first.motion.pose, step.pose)
    np.testing.assert_allclose(last.motion.pose, [0.0, 1.0, -0.5 * np.pi], atol=1e-12)
    np.testing.assert_allclose(last.motion.sigma, np.sqrt(3.0) * step.sigma)
    assert last.submaps == (0,)
    ties = [Constraint(s, k, np.zeros(3), np.eye(3), Kind.INTRA) for s, k in [(0, 0), (1, 0), (1, 2), (1, 3)]]
    assert [(c.submap, c.node) for c in stay.constraints(ties)] == [(0, 0), (0, 1)]
