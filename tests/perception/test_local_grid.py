import numpy as np
import pytest
from tagalong.perception.tracking.local_grid import (
    LocalGrid,
    cells_of,
    free_all,
    make_pages,
    mark,
    no_cells,
    stood_for,
    with_more_pages,
)
from tracking_reference import PlainGrid


def test_the_ring_buffer_says_what_a_dictionary_says():
    rng = np.random.default_rng(0)
    grid, plain, robot = LocalGrid(0.05, 0.25, 3.0), PlainGrid(0.05, 0.25, 3.0), np.zeros(2)
    for k in range(60):
        robot = robot + np.array([0.4, -0.2])
        points = robot + np.round(rng.uniform(-2, 2, (40, 2)), 1)
        grid.mark(points, robot, 0.1 * k, 0.1)
        plain.mark(points, 0.1 * k, 0.1)
        asked = robot + np.round(rng.uniform(-2, 2, (30, 2)), 1)
        np.testing.assert_array_equal(grid.is_free(asked, 0.1 * k), plain.is_free(asked, 0.1 * k))


def test_a_cell_is_occupied_while_something_stays_and_free_again_afterwards():
    grid, post = LocalGrid(0.05, 0.25, 3.0), np.array([[1.01, 1.01]])
    assert grid.is_free(post, 0.0).all()
    for k in range(10):
        grid.mark(post, np.zeros(2), 0.1 * k, 0.1)
    assert not grid.is_free(post, 1.0).any()
    assert not grid.is_free(post + 0.05, 1.0).any()
    assert grid.is_free(post + 0.2, 1.0).all()
    assert grid.is_free(post, 10.0).all()


def test_however_long_something_stood_it_is_forgotten_in_the_same_time():
    for scans in (3, 200):
        grid, place = LocalGrid(0.05, 0.25, 3.0), np.array([[1.0, 1.0]])
        for k in range(scans):
            grid.mark(place, np.zeros(2), 0.1 * k, 0.1)
        gone = 0.1 * (scans - 1) + 3.0
        assert not grid.is_free(place, gone - 0.05)[0]
        assert grid.is_free(place, gone + 0.05)[0]


def test_how_long_something_stood_is_counted_while_it_is_hit_and_anew_after_it_was_gone():
    cells, post, robot = cells_of(no_cells(1), 0), np.array([[1.01, 1.01]]), np.zeros(2)
    assert make_pages(cells, post, robot, 0.05, 0.0, 3.0)
    for k in range(100):
        mark(cells, post, robot, 0.05, 0.1 * k, 0.1, 3.0)
    mark(cells, post, robot, 0.05, 12.0, 0.1, 3.0)  # hidden for two seconds
    assert stood_for(cells, post, 0.05, 12.0, 3.0) == pytest.approx(10.1, abs=1e-3)
    mark(cells, post, robot, 0.05, 16.0, 0.1, 3.0)
    assert stood_for(cells, post, 0.05, 16.0, 3.0) == pytest.approx(0.1, abs=1e-6)


def test_points_beyond_the_grid_leave_it_alone():
    grid = LocalGrid(0.05, 0.25, 3.0)
    near = np.array([[0.51, 0.51]])
    grid.mark(near + np.array([25.6, 0.0]), np.zeros(2), 0.0, 1.0)  # would fall on the same slot
    assert grid.is_free(near, 0.0).all()


def test_what_stood_there_before_there_was_more_room_still_stands_there():
    rng, robot = np.random.default_rng(1), np.zeros(2)
    crowded, roomy, points = no_cells(1, room=8), no_cells(1, room=4000), []
    for k in range(12):
        points.append(np.round(rng.uniform(-8.0, 8.0, (30, 2)), 1))
        while not make_pages(cells_of(crowded, 0), points[-1], robot, 0.05, 0.1 * k, 3.0):
            crowded = with_more_pages(crowded)
        assert make_pages(cells_of(roomy, 0), points[-1], robot, 0.05, 0.1 * k, 3.0)
        for cells in (crowded, roomy):
            mark(cells_of(cells, 0), points[-1], robot, 0.05, 0.1 * k, 0.1, 3.0)
    asked = np.concatenate((*points, rng.uniform(-9.0, 9.0, (500, 2))))
    told = [stood_for(cells_of(cells, 0), asked, 0.05, 1.1, 3.0) for cells in (crowded, roomy)]
    np.testing.assert_array_equal(*told)
    assert 0 < (told[0] > 0.0).sum() < len(asked)
    assert crowded.cells.shape[1] < roomy.cells.shape[1] / 2


def test_pages_are_there_where_things_are_and_nowhere_else():
    cells = cells_of(no_cells(1), 0)
    wall = np.stack((np.full(200, 5.0), np.linspace(-5.0, 5.0, 200)), axis=1)
    assert make_pages(cells, wall, np.zeros(2), 0.05, 5.0, 3.0)
    count = int(cells.pages[-1])
    assert 10.0 / 0.4 <= count <= 10.0 / 0.4 + 1  # pages are 0.4 m wide
    assert make_pages(cells, wall, np.zeros(2), 0.05, 5.0, 3.0)
    assert make_pages(cells, np.array([[30.0, 0.0], [np.nan, 0.0]]), np.zeros(2), 0.05, 5.0, 3.0)
    assert int(cells.pages[-1]) == count


def test_no_page_is_made_beyond_the_room_that_there_is():
    cells, posts = cells_of(no_cells(1, room=3), 0), np.array([[0.1, 0.1], [1.1, 0.1], [2.1, 0.1]])
    assert make_pages(cells, posts[:2], np.zeros(2), 0.05, 5.0, 3.0)
    assert not make_pages(cells, posts, np.zeros(2), 0.05, 5.0, 3.0)
    assert int(cells.pages.max()) == 2


def test_pages_that_are_used_anew_are_free():
    cells, posts = cells_of(no_cells(1), 0), np.array([[0.1, 0.1], [1.2, 0.1], [2.3, 0.1]])
    for place in (posts[:1], posts[1:2]):
        assert make_pages(cells, place, np.zeros(2), 0.05, 5.0, 3.0)
        mark(cells, place, np.zeros(2), 0.05, 5.0, 1.0, 3.0)
    free_all(cells)
    offsets = np.stack(np.meshgrid(np.arange(8), np.arange(8)), axis=-1).reshape(-1, 2) * 0.05 + 0.025
    anew = np.concatenate([np.array([x, 4.0]) + offsets for x in (4.0, 4.4)])
    assert make_pages(cells, anew, np.zeros(2), 0.05, 5.0, 3.0)
    assert (stood_for(cells, anew, 0.05, 5.0, 3.0) == 0.0).all()


def test_pages_of_what_is_forgotten_give_way_to_new_ones_and_all_that_is_remembered_stays():
    """A robot drives for a minute along walls: the room does not grow, and what is told is the same to the digit."""
    rng, small, roomy = np.random.default_rng(2), no_cells(1, room=120), no_cells(1, room=4000)
    dropped = heard = 0
    for k in range(600):
        robot, now = np.array([0.1 * k, 0.0]), 0.1 * k
        points = robot + np.round(rng.uniform((-4.0, 1.9), (4.0, 2.1), (60, 2)), 2)
        before = int(small.pages[0, -1])
        for cells in (small, roomy):
            assert make_pages(cells_of(cells, 0), points, robot, 0.05, now, 3.0)
            mark(cells_of(cells, 0), points, robot, 0.05, now, 0.1, 3.0)
        dropped += int(small.pages[0, -1]) < before
        asked = robot + rng.uniform((-9.0, 1.5), (9.0, 2.5), (200, 2))
        told = [stood_for(cells_of(cells, 0), asked, 0.05, now, 3.0) for cells in (small, roomy)]
        np.testing.assert_array_equal(*told)
        heard += int((told[0] > 0.0).sum())
    assert dropped > 3
    assert heard > 10_000
    assert int(small.pages[0, -1]) < 120 < int(roomy.pages[0, -1])


def test_where_little_is_forgotten_there_is_to_be_more_room():
    cells, rng = cells_of(no_cells(1, room=30), 0), np.random.default_rng(3)
    for k in range(28):
        post = np.array([[0.1 + 0.4 * k, 0.1]])
        assert make_pages(cells, post, np.zeros(2), 0.05, 5.0, 3.0)
        mark(cells, post, np.zeros(2), 0.05, 5.0 if k else 1.0, 0.1, 3.0)
    more = rng.uniform(-8.0, -1.0, (2, 2))
    assert not make_pages(cells, more, np.zeros(2), 0.05, 5.0, 3.0)  # one of 28 is forgotten
    assert make_pages(cells, more, np.zeros(2), 0.05, 9.0, 3.0)


def test_pages_that_gave_way_are_free_for_a_clock_that_begins_anew():
    cells, offsets = cells_of(no_cells(1, room=12), 0), np.stack(np.meshgrid(np.arange(8), np.arange(8)), axis=-1)
    fields = [np.array([0.4 * k, 4.0]) + offsets.reshape(-1, 2) * 0.05 + 0.025 for k in range(12)]
    for k in range(11):
        assert make_pages(cells, fields[k], np.zeros(2), 0.05, 5.0, 3.0)
        mark(cells, fields[k], np.zeros(2), 0.05, 5.0, 1.0, 3.0)
    assert make_pages(cells, fields[11], np.zeros(2), 0.05, 50.0, 3.0)
    assert int(cells.pages[-1]) == 1
    free_all(cells)
    for field in fields[:11]:
        assert make_pages(cells, field, np.zeros(2), 0.05, 0.1, 3.0)
        assert (stood_for(cells, field, 0.05, 0.1, 3.0) == 0.0).all()
    assert make_pages(cells, fields[11], np.zeros(2), 0.05, 0.1, 3.0)  # nothing was marked in any of them since
