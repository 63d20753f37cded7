"""A robot that is not where its filter believes finds itself by the distances between landmarks."""

import numpy as np
import pytest
from landmark_worlds import cast, circle_path, draw_posts
from tagalong.slam.ekf.engine import EkfSlam
from tagalong.slam.ekf.models import measure
from tagalong.slam.ekf.slip import find_slip
from tagalong.slam.geometry import between, compose

POSTS = np.array([(3.0, 1.0), (4.5, -2.0), (6.0, 0.5), (2.0, 4.0), (7.0, 4.5)])


@pytest.mark.parametrize("slip", [(0.5, -0.3, 0.2), (1.0, 0.2, -0.4), (0.1, 0.0, 0.05)])
def test_a_slip_is_found_by_three_landmarks(slip):
    true = compose(np.zeros(3), np.array(slip))
    found = find_slip(measure(true, POSTS)[:3], POSTS, np.zeros(3), 3)
    assert found is not None
    np.testing.assert_allclose(found.pose, true, atol=1e-6)


@pytest.mark.parametrize(
    ("slip", "two", "three"),
    [
        ((0.28, 0.0, 0.0), True, True),
        ((0.32, 0.0, 0.0), False, True),
        ((0.0, 0.0, 0.14), True, True),
        ((0.0, 0.0, -0.16), False, True),
        ((1.45, 0.0, 0.0), False, True),
        ((1.55, 0.0, 0.0), False, False),
        ((0.0, 0.0, 0.65), False, False),
    ],
)
def test_two_sightings_agree_on_small_slips_only_and_three_on_larger_ones(slip, two, three):
    seen = measure(np.array(slip), POSTS)
    assert (find_slip(seen[:2], POSTS, np.zeros(3), 2) is not None) == two
    assert (find_slip(seen[:3], POSTS, np.zeros(3), 2) is not None) == three


def test_too_few_too_far_and_ambiguous_are_no_slips():
    assert find_slip(measure(np.zeros(3), POSTS)[:2], POSTS, np.array([1.0, 0.0, 0.0]), 2) is None
    assert find_slip(measure(np.array([4.0, 0.0, 0.0]), POSTS)[:3], POSTS, np.zeros(3), 3) is None
    row = np.array([(3.0 + 0.5 * k, 0.0) for k in range(6)])
    assert find_slip(measure(np.zeros(3), row[1:4]), row, np.zeros(3), 3) is None


def test_the_engine_comes_back_from_a_slip_that_no_covariance_knows_of():
    rng = np.random.default_rng(2)
    path = circle_path(laps=1.5)
    posts, truth, jump = draw_posts(rng, 24, path), between(path[0], path), np.array([0.3, -0.2, 0.15])
    odometry, slipped, errors, engine = truth.copy(), False, [], EkfSlam()
    odometry[450:] = compose(compose(truth[449], jump), between(truth[449], truth[450:]))
    for i, pose in enumerate(path):
        update = engine.update(odometry[i], cast(pose, posts if not 430 <= i < 470 else posts[:0], rng))
        slipped |= update.diagnostics["slipped"] > 0.0
        errors.append(float(np.hypot(*(engine.pose - truth[i])[:2])))
    assert slipped
    assert max(errors[450:470]) > 0.3
    assert max(errors[520:]) < 0.1
