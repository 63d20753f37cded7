"""Recent scans, asked what stood at a place."""

import numpy as np
import pytest
from tagalong.perception.legs.detector import beams_of
from tagalong.perception.legs.range_view import view_of
from tagalong.perception.legs.recent_views import (
    RecentViewsConfig,
    forget_views,
    keep_view,
    no_views,
    shares_empty,
    shares_empty_now,
    views_of,
)
from tagalong.slam import InputError, LaserScan

BEARINGS = np.linspace(-1.0, 1.0, 201)
PLACES = np.array([[2.0, 0.0], [4.0, 0.0], [6.0, 0.0], [-2.0, 0.0]])


def wall_at(distance, time_s=0.0):
    return LaserScan(np.full(201, distance), BEARINGS, 0.1, 10.0, time_s=time_s)


class Views:
    """Keeps scans of one laser."""

    def __init__(self, config=None, beams=201):
        self.config = config or RecentViewsConfig()
        self.views = views_of(no_views(1, beams, self.config), 0)

    def keep(self, scan, lidar):
        self.last = view_of(scan.ranges, beams_of(scan), lidar)
        keep_view(self.views, self.last, scan.time_s, self.config.spacing_s)

    def look(self, places):
        return shares_empty(self.views, self.last, places, self.config.radius, self.config.margin)


def test_a_place_before_the_wall_was_empty_one_at_it_not_and_of_one_behind_it_nothing_is_known():
    views = Views()
    views.keep(wall_at(4.0), np.zeros(3))
    np.testing.assert_allclose(views.look(PLACES), [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0]])


def test_a_beam_without_return_was_empty_and_one_without_measurement_says_nothing():
    views = Views()
    views.keep(wall_at(np.inf), np.zeros(3))
    assert views.look(PLACES[:1]).tolist() == [[1.0, 0.0]]
    forget_views(views.views)
    views.keep(wall_at(np.nan), np.zeros(3))
    assert views.look(PLACES[:1]).tolist() == [[0.0, 0.0]]


def test_scans_are_kept_by_time_and_the_oldest_go():
    views = Views(RecentViewsConfig(spacing_s=0.2, count=4))
    for k in range(9):
        views.keep(wall_at(2.0 if k < 5 else 4.0, 0.1 * k), np.zeros(3))  # of these 0, 2, 4, 6, 8 are kept, then 2 on
    np.testing.assert_allclose(views.look(PLACES[:1]), [[0.5, 0.5]])


def test_places_are_seen_from_where_the_laser_was():
    views = Views()
    views.keep(wall_at(2.0), np.array([0.0, 3.0, -np.pi / 2.0]))
    np.testing.assert_allclose(views.look(np.array([[0.0, 1.0], [0.0, 2.0]])), [[0.0, 1.0], [1.0, 0.0]])


def test_a_wall_that_is_seen_along_is_met_though_the_beams_go_on_beside_the_place():
    bearings = np.radians(np.arange(2.0, 60.0, 0.5))
    scan = LaserScan(1.0 / np.sin(bearings), bearings, 0.1, 40.0)  # y = 1 m
    views = Views(beams=len(bearings))
    views.keep(scan, np.zeros(3))
    np.testing.assert_allclose(views.look(np.array([[8.0, 0.9], [8.0, 0.6]])), [[0.0, 1.0], [1.0, 0.0]])


def test_of_one_scan_places_are_empty_or_not_or_unknown():
    views = Views()
    views.keep(wall_at(4.0), np.zeros(3))
    np.testing.assert_array_equal(shares_empty_now(views.last, PLACES, 0.04, 0.2), views.look(PLACES))
    few = LaserScan(np.ones(1), np.zeros(1), 0.1, 10.0)
    assert not shares_empty_now(view_of(few.ranges, beams_of(few), np.zeros(3)), PLACES, 0.04, 0.2).any()


def test_numbers_that_make_no_sense_are_refused():
    with pytest.raises(InputError, match="positive"):
        RecentViewsConfig(margin=0.0)
