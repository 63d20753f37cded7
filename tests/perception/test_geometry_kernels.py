"""Points of things, and centres of legs, against plain numpy."""

import numpy as np
import pytest
from centres_reference import move_to_centres_reference
from tagalong.perception.legs.centres_kernel import move_to_centres
from tagalong.perception.tracking.geometry_kernels import points_of_things
from tracking_reference import points_of_things as plain_points_of_things

SEEDS = pytest.mark.parametrize("seed", range(4))


@SEEDS
def test_points_of_things_far_from_humans(seed):
    rng = np.random.default_rng(seed)
    points, humans = rng.uniform(0, 4, (60, 2)), rng.uniform(0, 4, (4, 2))
    start, end, thing = np.array([3, 20, 41]), np.array([15, 40, 60]), np.array([True, False, True])
    for people in (humans, humans[:0]):
        arguments = points, start, end, thing, people, 0.7
        np.testing.assert_array_equal(points_of_things(*arguments), plain_points_of_things(*arguments))


@SEEDS
def test_centres_of_legs(seed):
    rng = np.random.default_rng(seed)
    points, start, end = rng.normal(size=(30, 2)), np.array([0, 8, 20]), np.array([5, 20, 30])
    ours, theirs = np.empty((3, 2)), np.empty((3, 2))
    move_to_centres(points, start, end, 0.16, 0.4, ours)
    move_to_centres_reference(points, start, end, 0.16, 0.4, theirs)
    np.testing.assert_allclose(ours, theirs, rtol=1e-14)
