"""Adjustment, initialisation and files of pose graphs."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, compose, wrap_angle
from tagalong.slam.logs.g2o import read_g2o, write_g2o
from tagalong.slam.pose_graph.adjustment import adjust
from tagalong.slam.pose_graph.initialisation import initialise
from tagalong.slam.pose_graph.normal_equations import block_pattern, fill
from tagalong.slam.pose_graph.pose_graph import PoseGraph

# Optima found by gtsam 4.3 (dogleg with QR on the Intel graph, Levenberg-Marquardt on M3500b, chordal start).
OPTIMA = {"intel": 215.8381, "M3500b": 2055.379}


def ring(rng, n=40, noise=0.0):
    """Return true poses (n, 3) on a ring and a graph of steps and chords with noisy measurements."""
    phase = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    truth = np.stack((5.0 * np.cos(phase), 5.0 * np.sin(phase), wrap_angle(phase + np.pi / 2.0)), axis=-1)
    i = np.concatenate((np.arange(n - 1), np.arange(0, n - 10, 3), [n - 1]))
    j = np.concatenate((np.arange(1, n), np.arange(10, n, 3), [0]))
    z = compose(between(truth[i], truth[j]), rng.normal(0.0, 1.0, (len(i), 3)) * noise)
    root = rng.normal(0.0, 1.0, (len(i), 3, 3)) + 4.0 * np.eye(3)
    return truth, PoseGraph.of(truth, np.stack((i, j), axis=-1), z, root @ root.swapaxes(1, 2))


def cost(graph):
    return 0.5 * graph.chi2()


def test_the_gradient_is_that_of_numerical_differences():
    rng = np.random.default_rng(0)
    truth, graph = ring(rng, n=12, noise=0.1)
    pattern = block_pattern(12, graph.edges)
    data, gradient = np.empty(len(pattern.indices)), np.empty(36)
    measured = (graph.measurements, graph.information, graph.kernel_width)
    where = (pattern.place, pattern.base, pattern.stride, pattern.edge_blocks)
    total = fill(graph.poses, graph.edges, *measured, -1, *where, data, gradient)
    assert total == pytest.approx(cost(graph))
    for pose in range(12):
        for axis in range(3):
            step = np.zeros((2, 12, 3))
            step[:, pose, axis] = 1e-6, -1e-6
            up, down = (cost(graph.with_poses(compose(truth, s))) for s in step)
            assert gradient[3 * pattern.place[pose] + axis] == pytest.approx((up - down) / 2e-6, abs=1e-4)


def test_exact_measurements_are_met_from_a_far_start_and_the_first_pose_stays():
    rng = np.random.default_rng(1)
    truth, graph = ring(rng)
    start = truth + rng.normal(0.0, 1.0, truth.shape) * [0.5, 0.5, 0.2]
    start[0] = truth[0]
    result = adjust(graph.with_poses(start))
    assert result.converged
    np.testing.assert_allclose(between(truth, result.poses), 0.0, atol=1e-6)
    first = initialise(graph.with_poses(np.zeros_like(truth) + truth[0]))
    np.testing.assert_allclose(between(truth, first.poses), 0.0, atol=1e-6)


def test_a_wrong_loop_closure_hardly_moves_a_robust_graph():
    rng = np.random.default_rng(2)
    truth, graph = ring(rng, noise=0.01)
    wrong = graph.measurements.copy()
    wrong[-5] = compose(wrong[-5], [2.0, 1.0, 1.0])
    moved = {}
    for width in (np.inf, 3.0):
        bad = PoseGraph(truth, graph.edges, wrong, 100.0 * graph.information, np.full(len(wrong), width))
        error = between(truth, adjust(bad).poses)
        moved[width] = np.hypot(error[:, 0], error[:, 1]).max()
    assert moved[np.inf] > 0.3
    assert moved[3.0] < 0.1


def test_a_graph_without_its_wrong_edge_is_the_graph_that_never_had_it():
    rng = np.random.default_rng(2)
    truth, graph = ring(rng, noise=0.01)
    wrong = graph.measurements.copy()
    wrong[-5] = compose(wrong[-5], [2.0, 1.0, 1.0])
    bad, keep = PoseGraph.of(truth, graph.edges, wrong, graph.information), np.arange(len(wrong)) != len(wrong) - 5
    np.testing.assert_array_equal(adjust(bad.with_edges(keep)).poses, adjust(graph.with_edges(keep)).poses)
    assert bad.with_edges(keep).chi2() < 0.1 * bad.chi2()
    np.testing.assert_array_equal(bad.squared_distances(bad.errors()), bad.squared_distances())


def test_a_g2o_file_comes_back_as_it_was(tmp_path):
    _, graph = ring(np.random.default_rng(3), noise=0.1)
    write_g2o(tmp_path / "ring.g2o", graph)
    again = read_g2o(tmp_path / "ring.g2o")
    for name in ("poses", "edges", "measurements"):
        np.testing.assert_array_equal(getattr(again, name), getattr(graph, name))
    np.testing.assert_allclose(again.information, graph.information, rtol=1e-15)


@pytest.mark.parametrize(
    "line",
    [
        "EDGE_SE2 0 7 1 0 0 1 0 0 1 0 1",
        "EDGE_SE2 0 1 1 0",
        "EDGE_SE2 0 1 1 0 0 inf 0 0 1 0 1",
        "VERTEX_SE2 2 a 0 0",
        "VERTEX_SE2 2 nan 0 0",
        "VERTEX_SE2 1 2 0 0",
    ],
)
def test_a_broken_g2o_line_is_named(tmp_path, line):
    path = tmp_path / "broken.g2o"
    path.write_text(f"VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n{line}\n")
    with pytest.raises(InputError, match=r"broken\.g2o, line 3"):
        read_g2o(path)


def test_a_graph_in_pieces_is_not_initialised():
    ends, seen = np.array([[0, 1], [2, 3]]), np.array([[1.0, 0.0, 0.0]] * 2)
    with pytest.raises(InputError, match="got 2 pieces"):
        initialise(PoseGraph.of(np.zeros((4, 3)), ends, seen, np.tile(np.eye(3), (2, 1, 1))))


@pytest.mark.parametrize("diagonal", [(1.0, 1.0, 0.0), (1.0, 1.0, -1.0), (0.0, 0.0, 1.0), (1.0, -2.0, 1.0)])
def test_measurements_without_information_initialise_nothing(diagonal):
    graph = PoseGraph.of(np.zeros((2, 3)), np.array([[0, 1]]), np.ones((1, 3)), np.diag(diagonal)[None])
    with pytest.raises(InputError, match="positive information"):
        initialise(graph)


def test_a_damaged_gzipped_graph_is_one_clear_error(tmp_path):
    packed = bytearray(gzip.compress(b"VERTEX_SE2 0 0 0 0\n" + b"FIX 0\n" * 1000))
    packed[-20] ^= 0xFF
    (tmp_path / "broken.g2o.gz").write_bytes(packed)
    with pytest.raises(InputError, match="cut or broken"):
        read_g2o(tmp_path / "broken.g2o.gz")


@pytest.mark.parametrize("name", sorted(OPTIMA))
def test_known_graphs_reach_the_known_optimum(name):
    if "TAGALONG_DATA" not in os.environ:
        pytest.skip("set TAGALONG_DATA to the folder with pose_graphs/")
    graph = read_g2o(Path(os.environ["TAGALONG_DATA"]) / "pose_graphs" / f"{name}.g2o.gz")
    found = graph.with_poses(adjust(initialise(graph)).poses).chi2()
    assert found < 1.001 * OPTIMA[name]
