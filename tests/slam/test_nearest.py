"""The nearest points: the same answers as the search tree of scipy, to the last bit."""

import numpy as np
import pytest
from scipy.spatial import KDTree
from tagalong.slam.quality.nearest import NearestPoints


@pytest.mark.parametrize("count", [1, 7, 8, 9, 500])
@pytest.mark.parametrize("spread", [0.0, 1.0, 300.0])
def test_answers_are_those_of_the_tree(count: int, spread: float):
    rng = np.random.default_rng(count)
    points = rng.normal(size=(count, 2)) * (5.0, 0.3)
    queries = rng.normal(size=(400, 2)) * spread
    distances, nearest = NearestPoints(points).query(queries)
    expected, which = KDTree(points).query(queries)
    assert distances.tobytes() == np.asarray(expected).tobytes()
    np.testing.assert_array_equal(nearest, which)


def test_of_points_that_are_equally_near_the_tree_chooses():
    lattice = np.stack(np.meshgrid(np.arange(30.0), np.arange(20.0)), axis=-1).reshape(-1, 2)
    points = np.concatenate((lattice, lattice[::3]))
    queries = np.concatenate((lattice + 0.5, lattice - np.array((0.5, 0.0)), lattice, lattice * 10.0))
    distances, nearest = NearestPoints(points).query(queries)
    expected, which = KDTree(points).query(queries)
    assert distances.tobytes() == np.asarray(expected).tobytes()
    np.testing.assert_array_equal(nearest, which)


def test_no_questions_have_no_answers():
    distances, nearest = NearestPoints(np.zeros((3, 2))).query(np.empty((0, 2)))
    assert len(distances) == len(nearest) == 0
