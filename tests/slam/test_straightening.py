"""Submaps that local SLAM has bent are drawn anew as the adjusted graph has them, and loops closed on those."""

from dataclasses import replace

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose, inverse
from tagalong.slam.graph.engine import Cartographer, CartographerConfig
from tagalong.slam.graph.loops.constraints import Constraint, ConstraintBuilder, ConstraintConfig, Kind
from tagalong.slam.graph.loops.global_config import GlobalSlamConfig
from tagalong.slam.graph.loops.slack import Slack
from tagalong.slam.local.submap import Submap, SubmapConfig
from tagalong.slam.local.sweep import Sweep
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from walls import cast

ROOM = np.array([(0, 0, 6, 0), (6, 0, 6, 4), (6, 4, 0, 4), (0, 4, 0, 0), (2, 2, 2.5, 2), (2.5, 2, 2.5, 2.6)], float)
HALL = np.array([(0, 0, 12, 0), (12, 0, 12, 9), (12, 9, 0, 9), (0, 9, 0, 0), (4, 3.5, 4.5, 3.5), (8, 5, 8, 5.5)], float)
PLACES = np.array([(1.0, 1.0, 0.3), (1.4, 1.1, 0.2), (1.8, 1.1, 0.4)])


def scans(places=PLACES):
    rng = np.random.default_rng(0)
    return [cast(ROOM, place, rng) for place in places]


def drawn(turn=0.0, places=PLACES):
    """Return the finished submap of the room, all turned about its origin by `turn` [rad]."""
    submap, turned = Submap(SubmapConfig(), np.zeros(3)), compose([0.0, 0.0, turn], places)
    for scan, place in zip(scans(places), turned, strict=True):
        submap.insert(Sweep.of(scan, 0.05, 5.0).at(place))
    submap.finish()
    return submap


def test_a_submap_drawn_anew_from_the_same_sweeps_is_the_same():
    submap = Submap(SubmapConfig(), np.array([0.5, 0.2, 0.7]))
    sweeps = [Sweep.of(scan, 0.05, 5.0).at(place) for scan, place in zip(scans(), PLACES, strict=True)]
    for sweep in sweeps:
        submap.insert(sweep)
    again = submap.redrawn(sweeps)
    np.testing.assert_array_equal(again.field, submap.field)
    np.testing.assert_array_equal(again.corner, submap.corner)
    np.testing.assert_array_equal(again.pose_local, [0.5, 0.2, 0.0])
    np.testing.assert_allclose(again.centre, submap.centre, atol=1e-12)


def test_a_sweep_holds_the_feet_and_ends_of_a_mounted_laser():
    scan = replace(cast(ROOM, PLACES[0], np.random.default_rng(1), reach=3.0), T_robot_lidar=(0.2, 0.1, np.pi / 2))
    sweep = Sweep.of(scan, 0.05, 2.0).at(np.array([5.0, 6.0, 0.0]))
    np.testing.assert_allclose(sweep.sensor, [5.2, 6.1])
    assert sweep.returns <= len(sweep.surface)
    ends = sweep.points[1 + len(sweep.surface) :]
    np.testing.assert_allclose(np.hypot(*(ends - sweep.sensor).T), 2.0)  # the shorter of length and range
    ahead = 0.5 * np.pi + scan.bearings[scan.is_open]
    free = 2.0 * np.stack((np.cos(ahead), np.sin(ahead)), axis=-1)
    np.testing.assert_allclose(ends - sweep.sensor, free, atol=1e-9)
    near = scan.points_robot + np.array([5.0, 6.0])
    away = np.hypot(*(sweep.surface[: sweep.returns, None] - near[None]).transpose(2, 0, 1)).min(axis=1)
    assert away.max() < 0.05


@pytest.mark.parametrize("turn", [-0.02, 0.015])
def test_a_closure_turns_with_the_submap_that_was_straightened(turn):
    builder, place = ConstraintBuilder(ConstraintConfig()), np.array([3.0, 1.2, 0.5])
    points = cast(ROOM, place, np.random.default_rng(2)).points_robot
    builder.typical_score = 0.6
    bent = builder.rematch(Constraint(3, 7, place, np.eye(3), Kind.INTER, searched=True), drawn(), points)
    assert bent is not None
    straight = builder.rematch(bent, drawn(turn), points)
    assert straight is not None
    assert np.all(np.abs(between(place, bent.pose)) < [0.01, 0.01, 0.003])
    assert np.all(np.abs(between(compose([0.0, 0.0, turn], place), straight.pose)) < [0.01, 0.01, 0.003])
    assert (straight.submap, straight.node, straight.kind, straight.searched) == (3, 7, Kind.INTER, True)


def test_a_submap_that_was_drawn_anew_is_searched_anew():
    builder, place = ConstraintBuilder(ConstraintConfig()), np.array([3.0, 1.2, 0.5])
    points = cast(ROOM, place, np.random.default_rng(2)).points_robot
    for turn in (0.0, 0.3):
        (found,) = builder.places(drawn(turn), points, place, Slack(), np.inf)
        assert np.all(np.abs(between(compose([0.0, 0.0, turn], place), found.pose)) < [0.05, 0.05, 0.02]), turn


def test_a_closure_that_fits_no_more_is_dropped():
    builder, place = ConstraintBuilder(ConstraintConfig()), np.array([3.0, 1.2, 0.5])
    points = cast(ROOM, place, np.random.default_rng(2)).points_robot
    builder.typical_score = 0.6
    tie = Constraint(0, 0, place, np.eye(3), Kind.INTER, searched=True)
    assert builder.rematch(tie, drawn(1.0), points) is None


def twice_around(threads=2, seed=0):
    """Return an engine after two rounds of an ellipse through the hall, with poor odometry."""
    rng, t = np.random.default_rng(seed), np.linspace(0.0, 4.0 * np.pi, 260)
    ellipse = 6.0 + 4.0 * np.cos(t), 4.5 + 3.0 * np.sin(t), np.arctan2(3.0 * np.cos(t), -4.0 * np.sin(t))
    truth = np.stack(ellipse, axis=-1)
    engine = Cartographer(CartographerConfig(global_=GlobalSlamConfig(threads=threads)))
    odometry = truth[0]
    engine.update(odometry, cast(HALL, truth[0], rng, 5.0))
    for motion, place in zip(between(truth[:-1], truth[1:]), truth[1:], strict=True):
        odometry = compose(odometry, motion * [1.05, 1.0, 1.05] + rng.normal(0.0, 1.0, 3) * [0.01, 0.005, 0.01])
        engine.update(odometry, cast(HALL, place, rng, 5.0))
    return engine


def test_closures_that_fit_no_more_count_as_rejected(monkeypatch):
    engine = twice_around()
    graph = engine._global  # pyright: ignore[reportPrivateUsage]
    assert graph is not None
    graph.graph.constraints = [replace(tie, searched=tie.kind is Kind.INTER) for tie in graph.graph.constraints]
    found, before = sum(tie.searched for tie in graph.graph.constraints), engine.rejected
    monkeypatch.setattr(ConstraintBuilder, "rematch", lambda *_: None)
    engine.finish()
    assert found > 0
    assert engine.rejected - before >= found
    assert not any(tie.searched for tie in engine.constraints)


def test_finished_submaps_get_the_shape_that_the_graph_gives_them():
    spreads = []
    for seed in range(2):
        engine = twice_around(seed=seed)
        before = [dict(nodes) for nodes in engine.submap_nodes]
        engine.finish()
        after = engine.submap_nodes
        assert [list(nodes) for nodes in after] == [list(nodes) for nodes in before]
        for was, now in list(zip(before, after, strict=True))[-2:]:  # local SLAM still matches on these
            np.testing.assert_array_equal(list(was.values()), list(now.values()))
        spreads.append([np.mean([spread(engine, nodes) for nodes in of[:-2]]) for of in (before, after)])
    bent, straight = np.mean(spreads, axis=0)
    assert straight < 0.6 * bent


def test_the_final_optimisation_does_not_depend_on_the_threads():
    one, three = twice_around(1), twice_around(3)
    for engine in (one, three):
        engine.finish()
    np.testing.assert_array_equal(one.trajectory(), three.trajectory())
    ties = [[(c.submap, c.node, *c.pose, c.score) for c in engine.constraints] for engine in (one, three)]
    assert ties[0] == ties[1]
    assert any(tie.kind is Kind.INTER for tie in one.constraints)


def test_no_node_is_matched_with_a_submap_that_it_stands_in():
    engine = twice_around()
    engine.finish()
    ties = [tie for tie in engine.constraints if tie.kind is Kind.INTER]
    assert ties
    assert not any(tie.node in engine.submap_nodes[tie.submap] for tie in ties)


def test_a_wrong_tie_is_dropped_and_leaves_no_trace_but_a_slip_of_the_wheels_is_kept():
    engines, dropped = (twice_around(), twice_around()), []
    for engine in engines:
        engine.finish()
        graph = engine._global  # pyright: ignore[reportPrivateUsage]
        assert graph is not None
        slip = Prediction(compose(graph.graph.nodes[30].motion.pose, [1.0, 0.5, 0.4]), np.array([0.001, 0.001]))
        graph.graph.nodes[30] = replace(graph.graph.nodes[30], motion=slip)
        if engine is engines[1]:
            wrong = Constraint(0, 90, np.array([1.0, 2.0, 0.5]), 1e4 * np.eye(3), Kind.INTER)
            graph.graph.constraints.insert(3, wrong)
        before, ties = graph.rejected, len(graph.graph.constraints)
        graph.optimise(final=True)
        dropped.append(ties - len(graph.graph.constraints))
        assert graph.rejected - before == dropped[-1]
        assert all(tie.information[0, 0] != 1e4 for tie in graph.graph.constraints)
    assert dropped[1] == dropped[0] + 1
    np.testing.assert_allclose(engines[1].node_poses, engines[0].node_poses, atol=1e-4)


def test_at_least_one_thread_is_needed():
    with pytest.raises(InputError, match="threads"):
        GlobalSlamConfig(threads=0)


def spread(engine, nodes):
    """Return how far [m] the nodes of a submap are from where a rigid drawing of it has them, on the final map."""
    origins = compose(engine.node_poses[list(nodes)], inverse(np.array(list(nodes.values()))))
    return np.linalg.norm(origins[:, :2] - np.median(origins[:, :2], axis=0), axis=1).mean()
