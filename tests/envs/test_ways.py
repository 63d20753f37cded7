"""Cells, boxes and ways, against scipy and by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra
from tagalong.envs.scenes.cells import FreeSpace, merged_boxes, walls_around
from tagalong.envs.scenes.solids import box, post
from tagalong.envs.scenes.way_kernel import apart, nearest, smooth
from tagalong.envs.scenes.ways import WayPlanner, WaySearch, folds


@settings(max_examples=40, deadline=None)
@given(arrays(bool, st.tuples(st.integers(1, 9), st.integers(1, 9))))
def test_boxes_cover_exactly_the_cells_and_never_each_other(cells):
    covered = np.zeros(cells.shape, dtype=int)
    for solid in merged_boxes(cells, 0.5, (2.0, -1.0)):
        col0, col1 = (round((solid.x + side * solid.half_length - 2.0) / 0.5) for side in (-1, 1))
        row0, row1 = (round((solid.y + side * solid.half_width + 1.0) / 0.5) for side in (-1, 1))
        covered[row0:row1, col0:col1] += 1
    assert np.array_equal(covered, cells.astype(int))


def reference_search(cost, row, col):
    """Prices by scipy."""
    rows, cols = cost.shape
    starts, ends, prices = [], [], []
    for r in range(rows):
        for c in range(cols):
            for i in range(max(0, r - 1), min(rows, r + 2)):
                for j in range(max(0, c - 1), min(cols, c + 2)):
                    if (i, j) != (r, c) and np.isfinite(cost[r, c]) and np.isfinite(cost[i, j]):
                        starts.append(r * cols + c)
                        ends.append(i * cols + j)
                        prices.append(np.hypot(i - r, j - c) * 0.5 * (cost[r, c] + cost[i, j]))
    graph = coo_matrix((prices, (starts, ends)), shape=(cost.size, cost.size)).tocsr()
    return dijkstra(graph, indices=row * cols + col).reshape(cost.shape)


@pytest.mark.parametrize("seed", range(5))
def test_the_cheapest_ways_are_those_of_scipy(seed):
    rng = np.random.default_rng(seed)
    cost = np.where(rng.random((12, 17)) < 0.25, np.inf, rng.uniform(1.0, 4.0, (12, 17)))
    row, col = np.argwhere(np.isfinite(cost))[0]
    whole, lazy, truth = WaySearch(cost, row, col), WaySearch(cost, row, col), reference_search(cost, row, col)
    whole.settle()
    price, before = whole.price, whole.before
    assert np.allclose(price, truth)
    lazy.settle(limit=8.0)
    assert np.allclose(lazy.price[truth <= 8.0], truth[truth <= 8.0])
    assert (lazy.price[truth > 8.0] > 8.0).all()
    for goal in np.flatnonzero(np.isfinite(truth))[::9]:
        lazy.settle(goal=int(goal))
        assert lazy.price.flat[goal] == price.flat[goal]
        assert lazy.before.flat[goal] == before.flat[goal]
    reached = np.isfinite(price)
    reached[row, col] = False
    assert np.all((before >= 0) == reached)
    assert np.all(price.flat[before[reached]] < price[reached])


def test_distances_to_places_are_those_of_numpy():
    rng = np.random.default_rng(0)
    spots, points = rng.normal(size=(20, 2)), rng.normal(size=(30, 2))
    away = np.hypot(*(spots[:, None] - points).transpose(2, 0, 1))
    assert np.allclose(apart(spots, points), away.min(axis=1))
    assert [nearest(points, x, y) for x, y in spots] == away.argmin(axis=1).tolist()
    assert nearest(points[:0], 0.0, 0.0) == -1


def reference_smooth(points, space, least, rounds):
    points = points.copy()
    for _ in range(rounds):
        moved = points.copy()
        moved[1:-1] = 0.25 * points[:-2] + 0.5 * points[1:-1] + 0.25 * points[2:]
        allowed = space.clearance_at(moved) >= least
        points[allowed] = moved[allowed]
    return points


def room_with_a_pillar():
    space = FreeSpace(np.ones((80, 100), dtype=bool), 0.05, (0.0, 0.0))
    return space.without((post("pillar", 2.5, 2.0, 0.4, 1.0),))


def test_smoothing_is_that_of_the_reference():
    space = room_with_a_pillar()
    rough = np.array([(1.0, 2.0), (1.5, 2.5), (2.0, 2.9), (2.5, 2.9), (3.0, 2.9), (3.5, 2.2), (4.0, 2.0)])
    fast = smooth(rough, space.clearance, *space.origin, space.resolution, 0.3, 30)
    assert np.allclose(fast, reference_smooth(rough, space, 0.3, 30))


def test_a_way_leads_round_what_stands_there_and_keeps_clear():
    planner = WayPlanner(room_with_a_pillar(), 0.45)
    way = planner.way([(1.0, 2.0), (4.0, 2.0)])
    assert way is not None
    assert way.points[[0, -1]] == pytest.approx(np.array([(1.0, 2.0), (4.0, 2.0)]), abs=0.12)
    assert np.hypot(*(way.points - (2.5, 2.0)).T).min() > 0.4 + 0.42
    assert way.length < 4.0


def test_there_is_no_way_through_a_wall():
    space = FreeSpace(np.ones((40, 80), dtype=bool), 0.05, (0.0, 0.0)).without((box("wall", (1.9, 0.0), (2.1, 2.0)),))
    planner = WayPlanner(space, 0.2)
    assert planner.way([(0.6, 1.0), (3.4, 1.0)]) is None
    assert planner.regions.max() == 2


def test_clearance_is_the_distance_to_the_next_edge():
    space = FreeSpace(np.ones((20, 60), dtype=bool), 0.1, (-1.0, 3.0))
    assert space.clearance_at([(2.0, 3.45)])[0] == pytest.approx(0.45)
    assert walls_around(np.pad(space.free, 2), 1).sum() == 2 * (22 + 60)


def test_a_hairpin_folds_and_a_wide_turn_does_not():
    out = np.stack((np.arange(0.0, 4.0, 0.1), np.zeros(40)), axis=-1)
    hairpin = np.concatenate((out, out[::-1] + np.array([0.0, 0.3])))
    angles = np.linspace(-np.pi / 2.0, np.pi / 2.0, 32)
    turn = np.concatenate((out, np.stack((4.0 + np.cos(angles), 1.0 + np.sin(angles)), axis=-1)))
    assert folds(hairpin)
    assert not folds(turn)


def test_a_search_carried_on_bit_by_bit_finds_what_one_in_a_go_finds():
    cost = 1.0 + np.random.default_rng(0).integers(0, 3, (60, 60)) / 2.0  # many ways that cost the same
    whole, lazy = WaySearch(cost, 3, 4), WaySearch(cost, 3, 4)
    whole.settle()
    lazy.settle(goal=30 * 60 + 20)
    for limit in (7.5, 8.0, 40.0, np.inf):
        lazy.settle(limit=limit)
    assert np.array_equal(whole.price, lazy.price)
    assert np.array_equal(whole.before, lazy.before)
