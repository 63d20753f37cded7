"""The immobile-area grid: eq. 4 and 5, lambda by likelihood, late results, movable things."""

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, transform_points
from tagalong.slam.grid import GridConfig, OccupancyGrid
from tagalong.slam.grid_kernels import write_observation, write_observation_reference
from tagalong.slam.immobile.grid import UNKNOWN, ImmobileConfig, ImmobileGrid, PoseHistory, moving_lambda, still_lambda
from tagalong.slam.scan import LaserScan

ORIGIN = np.zeros(3)


def wall_scan(distance, time_s=0.0):
    bearings = np.linspace(-0.2, 0.2, 81)
    return LaserScan(distance / np.cos(bearings), bearings, 0.1, 30.0, time_s)


def value_at(occupancy_map, x, y):
    col, row = ((np.array([x, y]) - occupancy_map.origin) / occupancy_map.resolution).astype(int)
    return float(occupancy_map.probability[row, col])


def odds(probability):
    return probability / (1.0 - probability)


def test_lambda_is_ten_for_a_certain_wall_half_for_a_certain_person_and_two_for_what_is_not_recognised():
    assert still_lambda([0.0, 0.5, 1.0]) == pytest.approx([2.0, 6.0, 10.0])
    assert moving_lambda([0.0, 0.5, 1.0]) == pytest.approx([2.0, 1.25, 0.5])
    for wrong in (-0.1, 1.1, float("nan")):
        with pytest.raises(InputError, match="likelihood"):
            still_lambda(wrong)


@pytest.mark.parametrize("lam", [0.5, 1.25, 2.0, 6.0, 10.0])
@pytest.mark.parametrize("hit", [0.51, 0.6, 0.7])
def test_one_observation_multiplies_the_odds_by_lambda_times_the_probability(lam, hit):
    grid = ImmobileGrid(ImmobileConfig(hit=hit))
    grid.write(ORIGIN, wall_scan(3.02), lam)
    assert odds(value_at(grid.to_map(), 3.02, 0.0)) == pytest.approx(lam * hit, rel=1e-4)
    assert odds(value_at(grid.to_map(), 1.5, 0.0)) == pytest.approx(2.0 * 0.35, rel=1e-4)


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


def test_walls_enter_faster_than_in_the_conventional_grid_and_people_never():
    conventional, wall, person = OccupancyGrid(GridConfig()), ImmobileGrid(), ImmobileGrid()
    for _ in range(2):
        conventional.write(ORIGIN, wall_scan(3.02))
        wall.write(ORIGIN, wall_scan(3.02), still_lambda(1.0))
    for _ in range(50):
        person.write(ORIGIN, wall_scan(3.02), moving_lambda(1.0))
    assert value_at(wall.to_map(), 3.02, 0.0) > value_at(conventional.to_map(), 3.02, 0.0) > 0.5
    assert value_at(person.to_map(), 3.02, 0.0) < 0.05


def test_somebody_taken_for_a_thing_vanishes_as_soon_as_they_are_recognised():
    immobile, conventional = ImmobileGrid(), OccupancyGrid()
    for _ in range(100):
        immobile.write(ORIGIN, wall_scan(3.02))
        conventional.write(ORIGIN, wall_scan(3.02))
    for _ in range(8):
        immobile.write(ORIGIN, wall_scan(3.02), moving_lambda(0.9))
        conventional.write(ORIGIN, wall_scan(3.02))
    assert value_at(immobile.to_map(), 3.02, 0.0) < 0.5
    assert value_at(conventional.to_map(), 3.02, 0.0) > 0.9


def test_an_opened_door_is_cleared_within_two_seconds_of_scans_and_stays_in_the_movable_layer():
    grid = ImmobileGrid()
    for _ in range(200):
        grid.write(ORIGIN, wall_scan(2.02))
    assert grid.movable().probability[np.isfinite(grid.movable().probability)].max() == 0.0
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(5.02))
    assert value_at(grid.to_map(), 2.02, 0.0) < 0.3
    assert value_at(grid.movable(), 2.02, 0.0) == 1.0
    assert value_at(grid.movable(), 5.02, 0.0) == 0.0
    assert grid.movable().probability.shape == grid.to_map().probability.shape


def test_whoever_stands_before_a_wall_keeps_their_cell_from_being_written():
    grid = ImmobileGrid()
    points = np.array([[2.01, 0.01], [2.02, 0.02], [4.0, 1.0]])
    grid.write_points(ORIGIN, points, [10.0, 0.5, 10.0], [True, True, False])
    assert value_at(grid.to_map(), 2.01, 0.01) < 0.5
    assert value_at(grid.to_map(), 3.0, 0.75) < 0.5


def test_a_result_that_comes_three_tenths_late_is_placed_where_the_robot_was_at_the_exposure():
    history, grid = PoseHistory(), ImmobileGrid()
    wall = np.array([[4.02, y] for y in np.arange(-0.5, 0.5, 0.05)])
    seen: list[tuple[float, np.ndarray]] = []
    for step in range(40):
        time_s = 0.1 * step
        pose = np.array([0.5 * time_s, 0.1 * np.sin(time_s), 0.4 * time_s - 0.8])
        history.add(time_s, pose)
        seen.append((time_s, transform_points(between(pose, ORIGIN), wall)))
        if step >= 3:
            exposed_s, points = seen[step - 3]
            grid.write_points(history.at(exposed_s), points, np.full(len(points), 10.0), np.full(len(points), True))
    occupied = grid.to_map().occupied_points
    assert len(occupied) >= 18
    assert np.abs(occupied[:, 0] - 4.02).max() < 0.06


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


def test_the_grid_grows_in_all_its_layers():
    grid = ImmobileGrid()
    for x in (0.0, 30.0, -25.0):
        for _ in range(10):
            grid.write([x, 0.0, 0.0], wall_scan(3.02), 10.0)
        for _ in range(40):
            grid.write([x, 0.0, 0.0], wall_scan(4.02), 10.0)
    for x in (0.0, 30.0, -25.0):
        assert value_at(grid.movable(), x + 3.02, 0.0) == 1.0
        assert value_at(grid.to_map(), x + 4.02, 0.0) > 0.9


def test_wrong_inputs_are_errors():
    with pytest.raises(InputError, match="firm"):
        ImmobileConfig(firm=9.0)
    with pytest.raises(InputError, match="length"):
        ImmobileGrid().write_points(ORIGIN, np.zeros((2, 2)), [2.0], [True])
    with pytest.raises(InputError, match="positive"):
        ImmobileGrid().write(ORIGIN, wall_scan(3.0), 0.0)
    with pytest.raises(InputError, match="longest_s"):
        PoseHistory(longest_s=0.0)
