"""Which detection belongs to which track."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tagalong.perception.tracking.assignment import assigned, near_pairs
from tagalong.perception.tracking.data_association import assign, distances
from tracking_reference import assign_reference


def least_total(cost, gate):
    """By trying everything: the least sum where each row takes a column of its own or pays the gate."""
    rows, columns = cost.shape
    padded = np.concatenate((np.minimum(cost, gate), np.full((rows, rows), gate)), axis=1)
    return min(sum(padded[i, j] for i, j in enumerate(choice)) for choice in permutations(range(columns + rows), rows))


@settings(deadline=None)  # the first call compiles
@given(st.integers(0, 3), st.integers(0, 3), st.integers(0, 10_000))
def test_the_assignment_costs_no_more_than_the_best_of_all(rows, columns, seed):
    rng = np.random.default_rng(seed)
    cost, gate = rng.uniform(0, 1, (rows, columns)), 0.5
    i, j = assign(cost, gate)
    assert len(set(i)) == len(i)
    assert len(set(j)) == len(j)
    assert (cost[i, j] < gate).all()
    assert cost[i, j].sum() + gate * (rows - len(i)) <= least_total(cost, gate) + 1e-12 if columns else len(i) == 0


def test_a_near_pair_is_not_broken_to_match_one_more_track():
    # the second track lost its detection; it must not push the first one to a far detection
    cost = distances(np.array([[0.0, 0.0], [0.3, 0.0]]), np.array([[0.05, 0.0], [-0.45, 0.0]]))
    rows, columns = assign(cost, 0.5)
    assert (0, 0) in zip(rows, columns, strict=True)


def test_forbidden_pairs_are_never_taken():
    rows, _ = assign(np.full((2, 2), np.inf), 0.5)
    assert len(rows) == 0


@pytest.mark.parametrize("seed", range(4))
def test_pairs_nearer_than_their_limit(seed):
    rng = np.random.default_rng(seed)
    cost, limit = rng.uniform(0, 1, (5, 4)), rng.uniform(0, 0.5, 5)
    near = cost < limit[:, None]
    rows, columns, alone = near_pairs(cost, limit)
    assert alone == (near.sum(axis=0).max() <= 1 and near.sum(axis=1).max() <= 1)
    np.testing.assert_array_equal(rows, np.flatnonzero(near.any(axis=1)))
    np.testing.assert_array_equal(np.sort(columns), np.flatnonzero(near.any(axis=0)))
    assert not alone or near[rows, columns].all()


@pytest.mark.parametrize("seed", range(40))
def test_the_assignment_is_scipys_ties_and_all(seed):
    rng = np.random.default_rng(seed)
    for _ in range(25):
        rows, columns = rng.integers(0, 9, 2)
        cost = rng.integers(0, 6, (rows, columns)) / 5.0 if seed % 2 else rng.uniform(0.0, 1.0, (rows, columns))
        cost[rng.random((rows, columns)) < 0.3] = np.inf
        limit = rng.choice((0.5, 0.8, 1.1), rows)
        for ours, theirs in zip(assigned(cost, limit), assign_reference(cost, limit), strict=True):
            assert ours.tolist() == theirs.tolist()
