"""Near points, against plain numpy."""

import numpy as np
import pytest
from nearness_reference import near_any_reference
from tagalong.perception.nearness_kernel import near_any


@pytest.mark.parametrize("seed", range(5))
def test_near_points_are_those_of_plain_numpy(seed):
    rng = np.random.default_rng(seed)
    points, others = rng.uniform(-2.0, 2.0, (200, 2)), rng.uniform(-2.0, 2.0, (7, 2))
    points[::9] = np.nan
    near = near_any(points, others, 0.35)
    assert np.array_equal(near, near_any_reference(points, others, 0.35))
    assert 0 < near.sum() < 200


def test_nothing_is_near_to_nobody():
    assert not near_any(np.zeros((5, 2)), np.empty((0, 2)), 1.0).any()
