"""How far off graph SLAM says that it may be: what the graph knows, what comes after, and whether that is so."""

from types import SimpleNamespace

import numpy as np
import pytest
from long_corridor import LINES, REACH, along, drive
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.engine import Cartographer, CartographerConfig
from tagalong.slam.graph.loops.optimisation import Optimised
from tagalong.slam.graph.loops.pose_uncertainty import PoseUncertainty
from tagalong.slam.graph.loops.slack import Slack
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.pose_graph.adjustment import adjust
from tagalong.slam.pose_graph.marginal import marginal_covariances
from tagalong.slam.pose_graph.normal_equations import block_pattern
from tagalong.slam.pose_graph.pose_graph import PoseGraph
from tagalong.slam.quality.consistency import RARELY, beyond, squared_distances
from tagalong.slam.runner import run_slam
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from walls import cast

SIGMA = np.array([0.02, 0.01])


def chain(steps):
    """Return a graph of poses one after the other, each seen from the one before."""
    poses = [np.zeros(3)]
    for step in steps:
        poses.append(compose(poses[-1], step))
    edges = np.array([(k, k + 1) for k in range(len(steps))])
    information = np.tile(np.diag(SIGMA[[0, 0, 1]] ** -2.0), (len(steps), 1, 1))
    return PoseGraph.of(np.array(poses), edges, np.array(steps), information)


def marginals(graph, *wanted):
    return marginal_covariances(graph, block_pattern(len(graph.poses), graph.edges), wanted)


def test_marginals_are_the_blocks_of_the_whole_inverse():
    rng = np.random.default_rng(1)
    graph = chain(rng.normal(0.0, 1.0, (6, 3)))
    ring = PoseGraph.of(
        graph.poses,
        np.concatenate((graph.edges, [(0, 6)])),
        np.concatenate((graph.measurements, [between(graph.poses[0], graph.poses[6])])),
        np.concatenate((graph.information, [np.eye(3) * 50.0])),
    )
    steps = 1e-6 * np.eye(18).reshape(18, 6, 3)
    roots = np.linalg.cholesky(ring.information)

    def errors(step):
        moved = ring.poses.copy()
        moved[1:] = compose(moved[1:], step)
        return np.einsum("kba,kb->ka", roots, ring.with_poses(moved).errors()).ravel()

    J = np.stack([(errors(step) - errors(-step)) / 2e-6 for step in steps], axis=1)
    whole = np.linalg.inv(J.T @ J)
    found = marginals(ring, 3, 6, 0)
    np.testing.assert_allclose(found[0], whole[6:9, 6:9], rtol=1e-4, atol=1e-9)
    np.testing.assert_allclose(found[1], whole[15:, 15:], rtol=1e-4, atol=1e-9)
    assert not found[2].any()  # the fixed one


def test_what_nothing_ties_to_the_rest_may_be_anywhere():
    graph = chain(np.ones((4, 3)))
    island = graph.with_edges(np.array([True, True, False, True]))  # the last two poses know of each other only
    known, lost = marginals(island, 2, 4)
    assert np.sqrt(known[0, 0]) < 1.0
    assert np.sqrt(lost[0, 0]) > 100.0


def test_what_odometry_adds_step_by_step_is_what_the_graph_says_at_once():
    steps = np.random.default_rng(2).normal(0.0, 1.0, (8, 3))
    uncertainty = PoseUncertainty()
    for step in steps:
        uncertainty._newest = uncertainty._carried(step, SIGMA)
    np.testing.assert_allclose(uncertainty._newest, marginals(chain(steps), 8)[0], rtol=1e-6, atol=1e-9)


def test_an_adjustment_tells_the_pattern_of_its_equations():
    graph = chain(np.ones((3, 3)))
    pattern = adjust(graph).pattern
    assert pattern is not None
    np.testing.assert_array_equal(marginal_covariances(graph, pattern, [3]), marginals(graph, 3))


def test_it_grows_along_a_corridor_and_shrinks_once_the_robot_is_back_where_it_was():
    engine = make_slam("cartographer")
    updates, _, _ = drive(engine, [along(2.0, 32.0), along(32.0, 2.0)], np.zeros(3))
    sigma = np.array([np.sqrt(np.trace(update.covariance[:2, :2])) for update in updates])
    there, back = sigma[:301], sigma[301:]
    assert there[1:].min() > 0.005  # no scan is known better than by its match
    assert there[300] > 5.0 * there[60]
    assert back[-60:].min() < 0.4 * sigma.max()


def test_an_adjustment_that_closes_a_loop_is_what_makes_it_shrink():
    """Seen from its submap the robot is known as well before as after: the submap is what gets its place."""
    engine = make_slam("cartographer")
    assert isinstance(engine, Cartographer)
    assert engine._global
    drive(engine, [along(2.0, 22.0), along(22.0, 4.0)], np.zeros(3))
    uncertainty = engine._global.uncertainty
    uncertainty._newest = 100.0 * np.eye(3)
    engine._global.optimise()
    assert np.trace(uncertainty._newest[:2, :2]) < 1.0
    assert all(covariance is uncertainty._newest for _, covariance in uncertainty._anchors)


def test_after_a_gap_the_odometry_may_be_off_by_far_more():
    engine = make_slam("cartographer")
    updates, _, _ = drive(engine, [along(2.0, 8.0), along(14.0, 17.0)], np.zeros(3))
    sigma = np.array([np.sqrt(np.trace(update.covariance[:2, :2])) for update in updates])
    assert sigma[62] > 5.0 * sigma[60]
    assert sigma[62] < 3.0  # of six metres
    assert sigma[-1] > 5.0 * sigma[60]


def test_each_submap_hangs_on_the_node_that_began_it(monkeypatch):
    engine = make_slam("cartographer")
    assert isinstance(engine, Cartographer)
    monkeypatch.setattr(engine._global, "optimise", lambda: None)
    updates, _, _ = drive(engine, [along(2.0, 32.0)], np.zeros(3))
    sigma = np.array([np.sqrt(np.trace(update.covariance[:2, :2])) for update in updates])
    assert sigma[-1] > 3.0 * sigma[60]


def test_the_covariance_is_in_the_frame_of_the_map():
    def last(heading):
        engine, rng = make_slam("cartographer"), np.random.default_rng(0)
        for pose in along(2.0, 6.0):
            update = engine.update(compose(np.array([0.0, 0.0, heading]), pose), cast(LINES, pose, rng, REACH))
        return update.covariance

    ahead, left = last(0.0), last(0.5 * np.pi)
    assert abs(ahead[0, 0] - ahead[1, 1]) > 0.2 * ahead[0, 0]  # a corridor is not the same along and across
    np.testing.assert_allclose([left[1, 1], left[0, 0], left[2, 2]], np.diag(ahead), rtol=0.05)


@pytest.mark.parametrize(("motion", "least", "most"), [((0.05, 0.01), 0.9, 1.1), ((30.0, 3.0), 29.0, 31.0)])
def test_a_piece_is_tied_as_loosely_as_its_slack_says_and_a_segment_not_at_all(motion, least, most):
    graph = chain([np.zeros(3), np.array([0.5, 0.0, 0.0])])  # a submap, its node, and the next node
    nodes = [SimpleNamespace(pose_local=np.zeros(3), motion=Prediction(np.zeros(3), np.array(motion)))] * 2
    made = SimpleNamespace(nodes=nodes, pieces=SimpleNamespace(ties=[(1, Slack(1.0, 0.1))]))
    uncertainty = PoseUncertainty()
    done = Optimised(0, graph, block_pattern(3, graph.edges))
    uncertainty.renew(made, done)  # pyright: ignore[reportArgumentType]
    assert least < np.sqrt(uncertainty._newest[0, 0]) < most


def test_a_run_keeps_what_the_engine_said_and_nothing_where_it_said_none():
    truth, rng = along(2.0, 4.0), np.random.default_rng(0)
    recording = RecordedDrive(truth, [cast(LINES, pose, rng, REACH) for pose in truth], truth, "corridor")
    assert np.isfinite(run_slam(Cartographer(), recording).covariances).all()
    assert np.isnan(run_slam(Cartographer(CartographerConfig(global_=None)), recording).covariances).all()


def test_across_the_motion_lies_what_the_heading_may_be_off():
    uncertainty = PoseUncertainty()
    uncertainty._newest = np.diag([1e-6, 1e-6, 0.01])
    far = uncertainty._carried(np.array([10.0, 0.0, 0.5]), np.zeros(2))
    cos, sin = np.cos(0.5), np.sin(0.5)
    aside = np.array([sin, cos])  # left of the way, in the frame at its end
    assert aside @ far[:2, :2] @ aside == pytest.approx(1.0, rel=1e-3)
    assert np.array([cos, -sin]) @ far[:2, :2] @ np.array([cos, -sin]) == pytest.approx(1e-6, rel=1e-3)


def test_who_has_no_graph_or_no_place_says_none():
    local = Cartographer(CartographerConfig(global_=None))
    updates, _, _ = drive(local, [along(2.0, 3.0)], np.zeros(3))
    assert {update.covariance for update in updates} == {None}


def test_a_segment_without_a_place_may_be_anywhere():
    uncertainty = PoseUncertainty()
    loose = Prediction(np.array([0.1, 0.0, 0.0]), np.array([30.0, 3.0]))
    far = uncertainty._carried(loose.pose, loose.sigma)
    assert far[0, 0] >= 900.0


def test_poses_drawn_by_their_covariance_are_as_far_off_as_it_says():
    rng, n = np.random.default_rng(3), 4000
    truth = rng.normal(0.0, 5.0, (n, 3))
    root = rng.normal(0.0, 0.1, (n, 3, 3)) + 0.2 * np.eye(3)
    frame = np.array([3.0, -2.0, 1.0])
    poses = compose(frame, truth)
    poses[1:] += (root @ rng.normal(0.0, 1.0, (n, 3, 1)))[1:, :, 0]
    poses[:, 2] += 2.0 * np.pi * rng.integers(-1, 2, n)
    poses[0] = compose(frame, truth[0])
    covariances = root @ root.swapaxes(1, 2)
    distances = squared_distances(poses, covariances, truth)
    assert distances.mean() == pytest.approx(3.0, rel=0.05)
    assert beyond(distances) == pytest.approx(RARELY, abs=0.005)
    assert beyond(squared_distances(poses, 0.25 * covariances, truth)) > 0.2
    assert beyond(np.zeros(0)) == 0.0
