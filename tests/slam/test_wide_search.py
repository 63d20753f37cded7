"""A scan sought all around is found at the places where it fits, the best first."""

from types import SimpleNamespace

import numpy as np
from tagalong.slam.geometry import transform_points
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridMatch, GridScanMatcher, GridScanMatcherConfig
from tagalong.slam.scan_to_grid.wide_search import search_widely

SIDE = 0.05


def corner_of_walls(field, row, col):
    """Draw two walls of unequal length that meet at a cell of `field`; return their cells (N, 2) as (x, y) [m]."""
    cells = [(row + k, col) for k in range(20)] + [(row, col + k) for k in range(1, 40)]
    for r, c in cells:
        field[r, c] = 1.0
    return SIDE * np.array([(c, r) for r, c in cells], dtype=np.float64)


def found(field, points, least=0.0):
    """Return the places where `points` (N, 2) are found around a pose 0.8 m and 0.3 rad off."""
    return search_widely(field, np.zeros(2), SIDE, points, np.array([0.6, -0.5, 0.3]), 3.0, 0.6, 0.02, least)


def test_one_place_that_fits_is_found():
    field = np.zeros((200, 200), np.float32)
    points = corner_of_walls(field, 60, 60)
    np.testing.assert_allclose(found(field, points), [np.zeros(3)], atol=0.06)


def test_two_places_that_look_alike_are_found_both():
    field = np.zeros((200, 200), np.float32)
    points = corner_of_walls(field, 60, 60)
    corner_of_walls(field, 95, 60)
    np.testing.assert_allclose(sorted(place[1] for place in found(field, points)), [0.0, 35 * SIDE], atol=0.06)


def test_a_place_that_explains_too_little_is_none():
    field = np.zeros((200, 200), np.float32)
    points = corner_of_walls(field, 60, 60)
    half = np.concatenate((points, points + np.array([20.0, 0.0])))
    np.testing.assert_allclose(found(field, half, 0.4), [np.zeros(3)], atol=0.06)
    assert found(field, half, 0.6) == []


def test_a_scan_that_fits_a_tenth_better_elsewhere_does_not_outweigh_odometry_that_was_sound():
    matcher = GridScanMatcher(GridScanMatcherConfig())
    usual, better = (GridMatch(np.zeros(3), np.eye(3), score, searched=True) for score in (0.4, 0.5))
    many = matcher.independent(10.0 * np.random.default_rng(0).random((180, 2)))
    gain = matcher.cost(usual, many) - matcher.cost(better, many)
    assert 0.0 < gain < -np.log(0.001)  # the probability that sound odometry fails with a scan


def test_walls_sixty_metres_away_are_sought_too():
    field = np.zeros((200, 200), np.float32)
    far = np.array([60.0, -5.0])
    points = corner_of_walls(field, 100, 60) + far
    walls = SimpleNamespace(field=field, corner=far, resolution=SIDE)
    around = Prediction(np.array([0.2, -0.1, 0.01]), np.array([0.5, 0.02]))
    (match, *_) = GridScanMatcher(GridScanMatcherConfig()).search(walls, points, around)
    np.testing.assert_allclose(transform_points(match.pose, points), points, atol=0.1)
