"""Immobile area in layers of height: a laser and a camera write one map."""

import numpy as np
import pytest
from immobile_reference import write_view_reference
from tagalong.slam.errors import InputError
from tagalong.slam.immobile.layer_kernels import Layers, Rays, write_view
from tagalong.slam.immobile.layers import ImmobileLayers, LayersConfig
from tagalong.slam.scan import LaserScan

ORIGIN = np.zeros(3)
CAMERA_HEIGHT = 1.0
NOTHING_GRAZED = -np.inf


def wall_scan(distance):
    bearings = np.linspace(-0.3, 0.3, 241)
    return LaserScan(distance / np.cos(bearings), bearings, 0.1, 30.0)


def value_at(occupancy_map, x, y):
    col, row = np.floor((np.array([x, y]) - occupancy_map.origin) / occupancy_map.resolution).astype(int)
    return float(occupancy_map.probability[row, col])


def wall_points(x, heights):
    return np.array([(x, side, height) for side in np.arange(-0.5, 0.5, 0.02) for height in heights])


def look(grid, points, lam, times=1, graze=NOTHING_GRAZED, level=False):
    for _ in range(times):
        count = len(points)
        grid.write_view(ORIGIN, CAMERA_HEIGHT, points, np.full(count, float(lam)), np.full(count, graze), level)


def test_the_kernel_does_what_its_reference_does():
    rng = np.random.default_rng(0)
    ends = np.concatenate((rng.uniform(1.0, 39.0, (80, 2)), rng.uniform(0.0, 3.0, (80, 1))), axis=1)
    beta = np.where(rng.random(80) < 0.4, np.nan, rng.normal(0.0, 1.0, 80))
    above = np.where(rng.random(80) < 0.3, ends[:, 2] + 0.1, -np.inf)
    edges = np.array([0.06, 0.25, 0.4, 0.8, 1.3, 2.0, 3.0])
    results = []
    for kernel in (write_view, write_view_reference):
        log_odds = np.random.default_rng(1).normal(0.0, 2.0, (6, 40, 40)).astype(np.float32)
        stamps = np.zeros((6, 40, 40), np.int32)
        spans = np.zeros((2, 6, 40, 40), np.float32)
        spans[:, :, 10:20] = np.array([0.5, 0.6])[:, None, None, None]
        tops = np.zeros((6, 40, 40), np.bool_)
        origin, known = np.array([20.3, 18.7, 1.0]), (beta > 0.0).astype(np.int8) + (beta > 0.5)
        layers = Layers(edges, log_odds, stamps, spans, tops)
        kernel(Rays(origin, ends, beta, above, known), layers, 3, -0.4, 5.0, 1)
        results.append((log_odds, stamps, spans, tops))
    np.testing.assert_allclose(results[0][0], results[1][0], atol=1e-5)
    assert np.array_equal(results[0][1], results[1][1])
    np.testing.assert_allclose(results[0][2], results[1][2])
    assert np.array_equal(results[0][3], results[1][3])
    assert results[0][3].sum() > 5
    assert (results[0][1] > 0).sum() > 300


def test_a_desk_top_stays_in_the_map_while_the_laser_looks_below_it():
    grid = ImmobileLayers()
    top = np.array([(x, y, 0.72) for x in np.arange(2.0, 2.6, 0.02) for y in np.arange(-0.3, 0.3, 0.02)])
    look(grid, top, 10.0, times=3, graze=0.82)
    for _ in range(300):
        grid.write(ORIGIN, wall_scan(5.02))
    assert value_at(grid.to_map(), 2.33, 0.02) > 0.9
    assert value_at(grid.to_map(), 1.52, 0.02) < 0.4
    assert value_at(grid.to_map(), 5.02, 0.02) > 0.9


def test_rays_just_above_a_desk_do_not_free_it_and_rays_through_where_it_was_do():
    grid = ImmobileLayers()
    top = np.array([(x, y, 0.72) for x in np.arange(2.0, 2.6, 0.02) for y in np.arange(-0.3, 0.3, 0.02)])
    look(grid, top, 10.0, graze=0.82)
    look(grid, wall_points(5.02, (0.46, 0.5)), 10.0, times=40)  # they pass at 0.75 to 0.77 m
    assert value_at(grid.to_map(), 2.33, 0.02) > 0.7
    look(grid, wall_points(5.02, np.arange(0.26, 0.40, 0.002)), 10.0, times=40)
    assert value_at(grid.to_map(), 2.33, 0.02) < 0.5


def test_somebody_empties_all_cells_around_but_those_of_a_wall():
    grid = ImmobileLayers()
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(3.02))
        grid.write(ORIGIN, wall_scan(2.87))
    look(grid, wall_points(3.02, (0.5, 1.2)), 10.0, times=3)
    for _ in range(10):
        grid.write_mobile([2.87, 0.02], 0.25, 0.5)
    assert value_at(grid.to_map(), 2.87, 0.02) < 0.5
    assert value_at(grid.to_map(), 3.02, 0.02) > 0.9
    assert grid.is_recognised(ORIGIN, [[3.02, 0.02], [2.87, 0.02], [np.nan, 0.0], [99.0, 0.0]]).tolist() == [
        True,
        False,
        False,
        False,
    ]


def test_a_low_box_stays_in_the_map_while_the_camera_looks_over_it():
    grid = ImmobileLayers()
    for _ in range(10):
        grid.write(ORIGIN, wall_scan(2.02))
    look(grid, wall_points(5.02, (0.9, 1.2, 1.8)), 10.0, times=100)
    assert value_at(grid.to_map(), 2.02, 0.02) > 0.9
    assert value_at(grid.to_map(), 3.52, 0.02) < 0.5
    assert value_at(grid.overlooked(), 3.52, 0.02) == 1.0
    assert value_at(grid.overlooked(), 1.02, 0.02) == 0.0
    assert value_at(grid.to_map(), 5.02, 0.02) > 0.9


def test_looking_over_says_less_than_looking_through():
    grid = ImmobileLayers()
    look(grid, wall_points(5.02, (1.8,)), 10.0, times=100)
    assert value_at(grid.to_map(), 4.02, 0.02) == pytest.approx(1.0 / (1.0 + np.exp(0.4)), abs=1e-3)


def test_a_lintel_does_not_close_its_doorway_but_a_wall_of_which_only_the_top_is_seen_is_one():
    grid = ImmobileLayers()
    look(grid, wall_points(3.02, (2.2, 2.4)), 10.0, times=10)
    assert value_at(grid.to_map(), 3.02, 0.02) > 0.9
    for _ in range(10):
        grid.write(ORIGIN, wall_scan(6.02))
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5


def test_a_door_that_opens_is_gone_in_all_layers_and_kept_as_movable():
    grid = ImmobileLayers()
    for _ in range(100):
        grid.write(ORIGIN, wall_scan(3.02))
    look(grid, wall_points(3.02, np.arange(0.1, 2.0, 0.1)), 6.0, times=100)
    assert value_at(grid.to_map(), 3.02, 0.02) > 0.9
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(6.02))
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5
    assert value_at(grid.movable(), 3.02, 0.02) == 1.0
    assert value_at(grid.movable(), 6.02, 0.02) == 0.0
    for _ in range(60):
        grid.write(ORIGIN, wall_scan(3.02))
    assert value_at(grid.movable(), 3.02, 0.02) == 0.0


def door_scan(door, wall=3.02, half_width=0.5):
    """A wall with a door of `half_width` [m] in it whose leaf is at the distance `door`."""
    scan = wall_scan(wall)
    leaf = np.abs(wall * np.tan(scan.bearings)) < half_width
    return LaserScan(np.where(leaf, door, wall) / np.cos(scan.bearings), scan.bearings, 0.1, 30.0)


def test_the_ends_of_a_door_go_with_its_leaf_though_they_touch_the_jambs():
    grid = ImmobileLayers()
    for _ in range(100):
        grid.write(ORIGIN, door_scan(3.02))
    sides = np.arange(-0.5, 0.5, 0.02)
    leaf = np.array([(3.02, side, height) for side in sides for height in np.arange(0.1, 2.0, 0.1)])
    look(grid, leaf, 10.0, times=100)
    for _ in range(20):
        grid.write(ORIGIN, door_scan(6.02))
    open_map = grid.to_map()
    for side in (-0.47, 0.02, 0.47):
        assert value_at(open_map, 3.02, side) < 0.5
        assert value_at(grid.movable(), 3.02, side) == 1.0
    for jamb in (-0.57, 0.57):
        assert value_at(open_map, 3.02, jamb) > 0.9
        assert value_at(grid.movable(), 3.02, jamb) == 0.0


def test_what_leaves_with_a_door_does_not_reach_along_the_wall():
    grid = ImmobileLayers()
    for wall in (3.02, 3.07):  # the wall's returns move on by a cell: the first one is firm, and free now
        for _ in range(60):
            grid.write(ORIGIN, door_scan(wall, wall))
    for _ in range(20):
        grid.write(ORIGIN, door_scan(6.02, 3.07))
    movable = grid.movable()
    assert [value_at(movable, 3.02, side) for side in (-0.42, 0.02, 0.42)] == [1.0, 1.0, 1.0]
    assert [value_at(movable, 3.02, side) for side in (-0.72, 0.72)] == [0.0, 0.0]
    assert min(value_at(grid.to_map(), 3.07, side) for side in np.arange(0.57, 0.85, 0.05)) > 0.9


def test_a_door_that_somebody_walks_through_while_it_is_let_go_stays_movable():
    grid = ImmobileLayers()
    for _ in range(100):
        grid.write(ORIGIN, wall_scan(3.02))
    somebody = np.abs(wall_scan(3.02).bearings) < 0.05
    for step in range(40):
        passes = somebody & (8 <= step < 14)
        grid.write(ORIGIN, passer(passes), np.where(passes, 0.5, 2.0))
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5
    assert value_at(grid.movable(), 3.02, 0.02) == 1.0


def passer(passes):
    """Scan through an open door at 3.02 m in which somebody is met by the beams that `passes` (n,) says."""
    scan = wall_scan(6.02)
    return LaserScan(np.where(passes, 3.02 / np.cos(scan.bearings), scan.ranges), scan.bearings, 0.1, 30.0)


def test_what_the_camera_saw_of_the_door_in_the_next_cell_goes_with_it():
    grid = ImmobileLayers()
    for _ in range(100):
        grid.write(ORIGIN, wall_scan(3.02))
    look(grid, wall_points(3.07, np.arange(0.5, 2.0, 0.1)), 10.0, times=3)
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(6.02))
    assert value_at(grid.to_map(), 3.07, 0.02) < 0.5


def test_a_desk_top_stays_when_its_leg_turns_out_to_be_in_the_next_cell():
    for level, stays in ((True, True), (False, False)):
        grid = ImmobileLayers()
        for _ in range(100):
            grid.write(ORIGIN, wall_scan(3.02))
        look(grid, wall_points(3.02, (0.72,)), 10.0, times=3, graze=0.82, level=level)
        for _ in range(20):
            grid.write(ORIGIN, wall_scan(6.02))
        assert value_at(grid.laser_map(), 3.02, 0.02) < 0.5
        assert (value_at(grid.to_map(), 3.02, 0.02) > 0.9) == stays


def test_one_look_at_something_in_the_air_is_not_believed_where_the_laser_sees_nothing():
    grid = ImmobileLayers()
    back = wall_points(3.02, (1.2,))
    look(grid, back, 6.0)
    assert value_at(grid.to_map(), 3.02, 0.02) > 0.6
    for _ in range(10):
        grid.write(ORIGIN, wall_scan(6.02))
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5
    look(grid, back, 6.0)
    assert value_at(grid.to_map(), 3.02, 0.02) > 0.6


def test_people_are_not_kept_as_movable_things():
    grid = ImmobileLayers()
    for _ in range(100):
        grid.write(ORIGIN, wall_scan(3.02))
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(3.02), 0.5)
    for _ in range(20):
        grid.write(ORIGIN, wall_scan(6.02))
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5
    assert value_at(grid.movable(), 3.02, 0.02) == 0.0


def test_a_wall_whose_returns_jitter_between_two_cells_has_not_left():
    grid = ImmobileLayers()
    for step in range(400):
        grid.write(ORIGIN, wall_scan(3.02 if step < 100 else 3.07))
    assert np.nanmax(grid.movable().probability) == 0.0


def test_floor_and_ceiling_stand_in_nobodys_way():
    grid = ImmobileLayers()
    floor = np.array([(x, 0.02, 0.0) for x in np.arange(2.0, 4.0, 0.05)])
    look(grid, floor, np.nan, times=3)
    look(grid, floor + np.array([0.0, 0.0, 2.6]), np.nan, times=3)
    assert value_at(grid.to_map(), 3.02, 0.02) < 0.5
    assert not grid.to_map().occupied.any()


def test_heights_decide_what_is_around():
    grid = ImmobileLayers()
    look(grid, wall_points(2.02, (0.72,)), 10.0, times=3)
    around = grid.log_odds_around(ORIGIN, [[2.02, 0.02], [2.02, 0.02], [50.0, 0.0]], [0.72, 0.32, 0.72])
    assert around[0] > 2.0
    assert around[1:].tolist() == [0.0, 0.0]


def test_wrong_inputs_are_errors():
    with pytest.raises(InputError, match="rising"):
        LayersConfig(edges=(0.1, 0.5, 0.4, 2.0))
    with pytest.raises(InputError, match="laser_height"):
        LayersConfig(laser_height=2.5)
    with pytest.raises(InputError, match="together"):
        LayersConfig(together=-1)
    with pytest.raises(InputError, match="overlooked"):
        LayersConfig(overlooked=0.1)
    with pytest.raises(InputError, match="believed"):
        LayersConfig(believed=-1.0)
    with pytest.raises(InputError, match="differ"):
        ImmobileLayers().write_view(ORIGIN, 1.0, np.zeros((2, 3)), [2.0], [0.0])
    with pytest.raises(InputError, match="positive"):
        look(ImmobileLayers(), wall_points(2.0, (0.5,)), 0.0)
