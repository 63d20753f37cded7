"""What grids of immobile area share: eq. 4 and 5, lambda by likelihood, poses of the recent past."""

import numpy as np
import pytest
from grid_reference import write_observation_reference
from tagalong.slam.errors import InputError
from tagalong.slam.grid_kernels import write_observation
from tagalong.slam.immobile.grid import UNKNOWN, ImmobileConfig, PoseHistory, moving_lambda, still_lambda
from tagalong.slam.immobile.layers import ImmobileLayers, LayersConfig
from tagalong.slam.scan import LaserScan

ORIGIN = np.zeros(3)


def test_lambda_is_ten_for_a_certain_wall_half_for_a_certain_person_and_two_for_what_is_not_recognised():
    assert still_lambda([0.0, 0.5, 1.0]) == pytest.approx([2.0, 6.0, 10.0])
    assert moving_lambda([0.0, 0.5, 1.0]) == pytest.approx([2.0, 1.25, 0.5])
    for wrong in (-0.1, 1.1, float("nan")):
        with pytest.raises(InputError, match="likelihood"):
            still_lambda(wrong)


@pytest.mark.parametrize("lam", [0.5, 1.25, 2.0, 6.0, 10.0])
@pytest.mark.parametrize("hit", [0.51, 0.6, 0.7])
def test_one_observation_multiplies_the_odds_by_lambda_times_the_probability(lam, hit):
    grid, bearings = ImmobileLayers(LayersConfig(hit=hit)), np.linspace(-0.2, 0.2, 81)
    grid.write(ORIGIN, LaserScan(3.02 / np.cos(bearings), bearings, 0.1, 30.0), lam)
    drawn = grid.to_map()
    col, row = ((np.array([3.02, 0.0]) - drawn.origin) / drawn.resolution).astype(int)
    probability = float(drawn.probability[row, col])
    assert probability / (1.0 - probability) == pytest.approx(lam * hit, rel=1e-4)


def test_at_even_odds_of_an_object_what_is_not_recognised_changes_nothing():
    log_odds, stamps = np.zeros((1, 4), np.float32), np.zeros((1, 4), np.int32)
    write_observation(
        0.5, 0.5, np.array([[3.5, 0.5]]), np.array([np.log(UNKNOWN * 0.5)]), -0.1, 5.0, 1, log_odds, stamps
    )
    assert log_odds[0, 3] == 0.0
    assert log_odds[0, 0] == pytest.approx(-0.1)


def test_the_kernel_does_what_its_reference_does():
    rng = np.random.default_rng(2)
    ends = rng.uniform(1.0, 29.0, (60, 2))
    beta = np.where(rng.random(60) < 0.3, np.nan, rng.normal(0.0, 2.0, 60))
    grids = []
    for kernel in (write_observation, write_observation_reference):
        log_odds = np.random.default_rng(3).normal(0.0, 3.0, (30, 30)).astype(np.float32)
        stamps = np.zeros((30, 30), np.int32)
        kernel(14.3, 15.7, ends, beta, -0.4, 5.0, 1, log_odds, stamps)
        grids.append((log_odds, stamps))
    np.testing.assert_allclose(grids[0][0], grids[1][0], atol=1e-5)
    assert np.array_equal(grids[0][1], grids[1][1])


def test_poses_between_two_are_interpolated_the_short_way_round():
    history = PoseHistory(longest_s=2.0)
    history.add(0.0, [0.0, 0.0, 3.1])
    history.add(1.0, [1.0, 2.0, -3.1])
    x, y, theta = history.at(0.5)
    assert (x, y) == pytest.approx((0.5, 1.0))
    assert abs(theta) == pytest.approx(np.pi, abs=1e-6)
    history.add(2.5, [1.0, 2.0, 0.0])
    with pytest.raises(InputError, match="no pose"):
        history.at(0.2)
    with pytest.raises(InputError, match="order"):
        history.add(2.5, ORIGIN)


def test_wrong_inputs_are_errors():
    with pytest.raises(InputError, match="firm"):
        ImmobileConfig(firm=9.0)
    with pytest.raises(InputError, match="longest_s"):
        PoseHistory(longest_s=0.0)
