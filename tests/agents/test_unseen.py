"""Where new ground comes into sight: drawn maps, a plain reference, and drives."""

import math

import gymnasium as gym
import numpy as np
import pytest
from tagalong.agents import make_follower
from tagalong.agents.planned import unseen
from tagalong.agents.planned.fields import value_at
from tagalong.agents.planned.unseen import CELL_M, FREE, HALF_M, PLACES_M, UNKNOWN, WALL, unseen_field
from tagalong.envs.task import FollowInterface, OwnMap
from tagalong.slam import InputError, OccupancyMap


def drawn(shape_m, resolution=0.05, free=(), walls=(), known=True):
    """Return a map of boxes (x0, y0, x1, y1) [m] that are free or, drawn later, occupied; else unknown."""
    cols, rows = (round(side / resolution) for side in shape_m)
    probability = np.full((rows, cols), np.nan, dtype=np.float32)
    for boxes, value in ((free, 0.1), (walls, 0.9)):
        for x0, y0, x1, y1 in boxes:
            r, c = (slice(round(a / resolution), round(b / resolution)) for a, b in ((y0, y1), (x0, x1)))
            probability[r, c] = value
    return OccupancyMap(probability, resolution, (0.0, 0.0))


def field_of(own, *way):
    """Return the field of a robot that goes nowhere, or along `way`, robot frame [m]."""
    return unseen_field(own, np.array(way, dtype=np.float64).reshape(-1, 2))


def at(field, x, y):
    return value_at(field, x, y, HALF_M, PLACES_M)


def test_what_is_looked_at_in_vain_draws_nobody_and_where_all_is_known_there_is_nothing():
    closed = drawn(
        (10.0, 10.0),
        free=[(2.0, 2.0, 8.0, 8.0)],
        walls=[(2.0, 2.0, 2.1, 8.0), (7.9, 2.0, 8.0, 8.0), (2.0, 2.0, 8.0, 2.1), (2.0, 7.9, 8.0, 8.0)],
    )
    assert field_of(OwnMap(closed, np.array((5.0, 5.0, 0.3)))).max() == 0.0
    holes = np.array(closed.probability)
    holes[80:90, 110:120] = np.nan  # unknown, in the middle of what is seen
    full = OccupancyMap(holes, 0.05, (0.0, 0.0))
    assert field_of(OwnMap(full, np.array((5.0, 5.0, 0.0)))).max() == 0.0


def test_a_corner_is_worth_to_look_round():
    ahead, behind = (1.0, 0.9, 10.0, 1.0), (0.9, 0.9, 1.0, 3.1)
    left = (1.0, 3.0, 4.0, 3.1), (6.0, 3.0, 10.0, 3.1)  # with a room behind the gap, hardly known
    side = drawn((12.0, 12.0), free=[(1.0, 1.0, 10.0, 3.0), (4.0, 3.0, 6.0, 4.0)], walls=[ahead, behind, *left])
    field = field_of(OwnMap(side, np.array((2.5, 2.0, 0.0))))
    assert at(field, 2.2, 0.0) > at(field, 1.0, 0.0) + 0.3
    assert at(field, 1.0, 0.0) >= at(field, 0.0, 0.0)
    assert at(field, 0.0, 0.0) < 0.2
    gone = field_of(OwnMap(side, np.array((2.5, 2.0, 0.0))), (1.2, 0.0), (2.4, 0.0))
    assert at(gone, 2.2, 0.0) < 0.2  # its way leads past the gap anyway
    turned = field_of(OwnMap(side, np.array((2.5, 2.0, math.pi / 2.0))))
    assert at(turned, 0.0, -2.2) == pytest.approx(at(field, 2.2, 0.0), rel=0.1)


@pytest.mark.parametrize("resolution", [0.02, 0.05, 0.1, 0.2, 0.25])
def test_coarse_cells_are_walls_where_any_is_and_know_the_place_of_things(resolution):
    known = drawn((8.0, 6.0), resolution, free=[(1.0, 1.0, 7.0, 5.0)], walls=[(4.0, 2.0, 4.0 + resolution, 4.0)])
    states = unseen.coarse_states(known.probability, 0.5, 0.5, resolution, np.zeros(2), np.array((-1.0, -1.0)), 100)

    def state(x, y):
        return states[int((x + 1.0) / CELL_M), int((y + 1.0) / CELL_M)]

    assert state(4.0 + resolution / 2.0, 3.0) == WALL
    assert state(2.5, 3.0) == FREE
    assert state(4.5, 3.0) == FREE
    assert state(0.4, 3.0) == state(-0.5, 0.0) == state(8.9, 8.9) == UNKNOWN


def plain_look(states, x, y, looked, rays):
    area = 0.0
    for angle in 2.0 * np.pi * np.arange(rays) / rays:
        through = 0
        for step in range(1, int(unseen.SIGHT_M / CELL_M)):
            i, j = int(x + step * math.cos(angle)), int(y + step * math.sin(angle))
            if not (0 <= i < len(states) and 0 <= j < len(states)) or states[i, j] == WALL:
                break
            through += states[i, j] == UNKNOWN
            if through > round(unseen.BEYOND_M / CELL_M):
                break
            if states[i, j] == UNKNOWN and not looked[i, j]:
                area += step * CELL_M**2 * 2.0 * np.pi / rays
    return area


def test_the_kernel_looks_as_its_plain_reference_does():
    rng = np.random.default_rng(0)
    for _ in range(5):
        states = rng.choice(np.array((UNKNOWN, FREE, FREE, FREE, WALL), dtype=np.int8), size=(60, 60))
        looked = rng.random((60, 60)) < 0.3
        x, y = rng.uniform(10.0, 50.0, 2)
        before = looked.copy()
        assert unseen.look(states, x, y, looked, 90, False) == pytest.approx(plain_look(states, x, y, looked, 90))
        assert np.array_equal(looked, before)
        unseen.look(states, x, y, looked, 720, True)
        assert unseen.look(states, x, y, looked, 720, False) == 0.0


def test_a_map_smaller_than_the_view_or_none_at_all_is_no_trouble():
    speck = OccupancyMap(np.full((1, 1), np.nan, dtype=np.float32), 0.05, (0.0, 0.0))
    assert field_of(OwnMap(speck, np.array((50.0, -3.0, 1.0)))).max() == 0.0
    hall = drawn((12.0, 12.0), free=[(1.0, 4.0, 7.0, 6.0)])
    assert field_of(OwnMap(hall, np.array((300.0, 0.0, 0.0)))).max() == 0.0


def test_a_robot_that_is_nowhere_yet_looks_for_nothing():
    hall = drawn((12.0, 12.0), free=[(1.0, 4.0, 7.0, 6.0)])
    assert field_of(OwnMap(hall, np.full(3, np.nan))).max() == 0.0


def test_who_maps_on_needs_a_map_and_is_told_so():
    with pytest.raises(InputError, match="needs the robot's own map: an environment with `slam`"):
        make_follower("mapper", FollowInterface())


def test_over_some_tours_it_brings_more_of_the_building_home_than_pid_does():
    """A single tour may go either way: by less than a thousandth, or by three per cent."""
    env = gym.make("tagalong/Office-v0", slam="cartographer", beams=361, split="train")
    seen = {"pid": 0, "mapper": 0}
    for seed in range(3):
        for who in seen:
            follower = make_follower(who, env.unwrapped.interface)
            observation, _ = env.reset(seed=seed)
            for _ in range(250):
                observation, _, over, cut, _ = env.step(follower.act(observation))
                if over or cut:
                    break
            seen[who] += int(np.isfinite(env.unwrapped.own_map().map.probability).sum())
    assert seen["mapper"] > 1.002 * seen["pid"]
