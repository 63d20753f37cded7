import numpy as np
from people_tracker_reference import PlainGrid
from tagalong.perception.tracking.local_grid import OCCUPIED, LocalGrid


def test_the_ring_buffer_says_what_a_dictionary_says():
    rng = np.random.default_rng(0)
    grid, plain, robot = LocalGrid(0.05, 0.3, 3.0), PlainGrid(0.05, 0.3, 3.0), np.zeros(2)
    for k in range(60):
        robot = robot + np.array([0.4, -0.2])
        points = robot + np.round(rng.uniform(-2, 2, (40, 2)), 1)
        grid.mark(points, robot, 0.1 * k, 0.1)
        plain.mark(points, 0.1 * k, 0.1)
        asked = robot + np.round(rng.uniform(-2, 2, (30, 2)), 1)
        np.testing.assert_array_equal(grid.is_free(asked, 0.1 * k), plain.is_free(asked, 0.1 * k))


def test_a_cell_is_occupied_while_something_stays_and_free_again_afterwards():
    grid, post = LocalGrid(0.05, 0.3, 3.0), np.array([[1.01, 1.01]])
    assert grid.is_free(post, 0.0).all()
    for k in range(10):
        grid.mark(post, np.zeros(2), 0.1 * k, 0.1)
    assert not grid.is_free(post, 1.0).any()
    assert not grid.is_free(post + 0.05, 1.0).any()
    assert grid.is_free(post + 0.2, 1.0).all()
    assert grid.is_free(post, 10.0).all()


def test_however_long_something_stood_it_is_forgotten_in_the_same_time():
    grid, place = LocalGrid(0.05, 0.3, 3.0), np.array([[1.0, 1.0]])
    for k in range(200):
        grid.mark(place, np.zeros(2), 0.1 * k, 0.1)
    half = 19.9 + 3.0 * np.log(1.0 / OCCUPIED)
    assert not grid.is_free(place, half - 0.05)[0]
    assert grid.is_free(place, half + 0.05)[0]


def test_points_beyond_the_grid_leave_it_alone():
    grid = LocalGrid(0.05, 0.3, 3.0)
    near = np.array([[0.51, 0.51]])
    grid.mark(near + np.array([25.6, 0.0]), np.zeros(2), 0.0, 1.0)  # would fall on the same slot
    assert grid.is_free(near, 0.0).all()
