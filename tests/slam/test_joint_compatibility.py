"""The branch and bound against all assignments that there are."""

from itertools import product

import numpy as np
import pytest
from scipy.stats import chi2
from tagalong.slam.ekf.association import compare, joint_compatibility

GATE = 9.21


def pairs(seed: int):
    """Sightings of clutter whose expected measurements are strongly correlated, as of a robot unsure of its pose."""
    rng = np.random.default_rng(seed)
    k, m = rng.integers(1, 5), rng.integers(1, 5)
    landmarks = rng.uniform(-2.0, 2.0, (k, 2))
    root = rng.normal(size=(2 * k, 2 * k)) * 0.05
    common = np.kron(np.ones((k, k)), np.diag(rng.uniform(0.0, 0.5, 2))) + root @ root.T
    z = landmarks[rng.integers(0, k, m)] + rng.normal(size=(m, 2)) * rng.choice([0.1, 0.5, 1.5])
    return compare(z, np.tile(0.01 * np.eye(2), (m, 1, 1)), landmarks, common)


def joint(found, chosen) -> float:
    rows = [i for i, _ in chosen]
    states = [s for _, j in chosen for s in (2 * j, 2 * j + 1)]
    S = found.HPH[np.ix_(states, states)].copy()
    for place, row in enumerate(rows):
        S[2 * place : 2 * place + 2, 2 * place : 2 * place + 2] += found.R[row]
    y = np.concatenate([found.y[i, j] for i, j in chosen])
    return float(y @ np.linalg.solve(S, y))


def best_of_all(found):
    """The largest set of which each beginning is compatible too, as the search grows it row by row."""
    m, k = found.distance.shape
    best, score = [], (0, 0.0)
    for partners in product(range(-1, k), repeat=m):
        chosen = [(i, j) for i, j in enumerate(partners) if j >= 0]
        if len({j for _, j in chosen}) < len(chosen) or any(found.distance[i, j] > GATE for i, j in chosen):
            continue
        beginnings = [chosen[:n] for n in range(1, len(chosen) + 1)]
        if all(joint(found, part) <= chi2.ppf(0.99, 2 * len(part)) for part in beginnings):
            here = (len(chosen), -joint(found, chosen) if chosen else 0.0)
            if here > score:
                best, score = chosen, here
    return best


@pytest.mark.parametrize("seed", range(120))
def test_the_search_finds_the_best_of_all_assignments(seed):
    found = pairs(seed)
    assert joint_compatibility(found, GATE) == best_of_all(found)


def test_pairs_whose_covariance_is_no_covariance_are_not_taken():
    found = compare(np.zeros((1, 2)), np.zeros((1, 2, 2)), np.zeros((1, 2)), np.diag([1.0, -1e-3]))
    assert joint_compatibility(found, GATE) == []
