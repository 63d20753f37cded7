"""Laser and camera write one immobile-area map: what is recognised decides."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.perception.immobile.mapper import ImmobileMapper, ImmobileMapperConfig
from tagalong.perception.immobile.places import Places
from tagalong.perception.immobile.view import CameraViewMaker, ViewConfig, make_view
from tagalong.perception.rgbd.frame import Pinhole, RgbdFrame
from tagalong.perception.rgbd.people import NoPeopleFinder, RgbdPeople, nobody
from tagalong.perception.rgbd.planes import PlaneFinder, Surface
from tagalong.slam import InputError, LaserScan
from tagalong.slam.geometry import compose, transform_points

CAMERA = Pinhole(width=64, height=53, horizontal_fov=np.radians(70.0), vertical_fov=np.radians(60.0))
BEARINGS = np.linspace(-1.5, 1.5, 601)


def scan_of(wall=4.02, post=None, time_s=0.1):
    """A scan of a wall at x = `wall`, and of a round post of radius 0.15 at `post` (x, y)."""
    ranges = np.minimum(wall / np.maximum(np.cos(BEARINGS), 1e-3), 9.0)
    if post is not None:
        along = post[0] * np.cos(BEARINGS) + post[1] * np.sin(BEARINGS)
        half = 0.15**2 - (post[0] ** 2 + post[1] ** 2 - along**2)
        ranges = np.where(half > 0.0, along - np.sqrt(np.maximum(half, 0.0)), ranges)
    return LaserScan(ranges, BEARINGS, 0.1, 10.0, time_s)


def room_frame(time_s=0.0, board=None):
    """A room of floor, ceiling at 2.6 m and a wall at x = 4; `board` (x, low, high): something narrow in the middle."""
    rays = CAMERA.rays
    with np.errstate(divide="ignore"):
        depth = np.minimum(4.0, np.where(rays[..., 2] < 0.0, -1.0 / rays[..., 2], 1.6 / rays[..., 2]))
    if board is not None:
        x, low, high = board
        up = 1.0 + x * rays[..., 2]
        depth = np.where((np.abs(x * rays[..., 1]) < 0.25) & (low < up) & (up < high) & (x < depth), x, depth)
    colour = np.zeros((*depth.shape, 3), np.uint8)
    return RgbdFrame(depth.astype(np.float32), colour, CAMERA, time_s)


def occupied_at(grid, x, y, reach=0.08):
    points = grid.occupied_points
    return bool((np.hypot(*(points - (x, y)).T) < reach).any())


def person_of(frame, x, likelihood=0.95):
    """The person who is the narrow thing at depth `x`."""
    label = np.where(np.abs(frame.depth - x) < 0.05, 0, -1).astype(np.int32)
    return RgbdPeople(np.array([[x, 0.0]]), np.array([likelihood]), label)


def test_a_view_says_what_is_where():
    frame = room_frame(board=(2.0, 0.0, 1.7))
    view = make_view(frame, PlaneFinder().find(frame), person_of(frame, 2.0))
    assert np.isnan(view.lambdas[np.isin(view.surface, (Surface.FLOOR, Surface.CEILING)) & (view.person < 0)]).all()
    assert (view.lambdas[(view.surface == Surface.WALL) & (view.person < 0)] == 10.0).all()
    assert view.lambdas[view.person == 0] == pytest.approx(2.0 - 1.5 * 0.95)
    assert (view.person == 0).sum() > 100
    assert (view.above[view.surface == Surface.WALL] == -np.inf).all()
    assert (view.above[view.person == 0] == -np.inf).all()
    thing = make_view(frame, PlaneFinder().find(frame), nobody(53, 64), ViewConfig(graze=0.2))
    board = thing.cluster >= 0
    np.testing.assert_allclose(thing.above[board], thing.points[board, 2] + 0.2, atol=0.05)
    with pytest.raises(InputError, match="top"):
        ViewConfig(top=1.5)


def test_somebody_who_stands_still_is_removed_once_the_camera_knows_them_and_stays_so_out_of_its_view():
    mapper, standing = ImmobileMapper(), (2.02, 0.02)
    for step in range(1, 60):
        mapper.add_scan(np.zeros(3), scan_of(post=standing, time_s=0.1 * step))
    assert occupied_at(mapper.grid.to_map(), 1.87, 0.02)
    frame = room_frame(5.9, board=(1.9, 0.0, 1.7))
    mapper.add_view(make_view(frame, PlaneFinder().find(frame), person_of(frame, 1.9)))
    for step in range(60, 260):
        mapper.add_scan(np.zeros(3), scan_of(post=standing, time_s=0.1 * step))
    assert not occupied_at(mapper.grid.to_map(), 1.87, 0.02)
    assert len(mapper.people.moving(26.0)) == 1
    mapper.add_scan(np.zeros(3), scan_of(time_s=26.0))
    assert len(mapper.people.moving(26.0)) == 0


def test_somebody_seen_for_sure_takes_back_what_was_written_of_their_body_and_somebody_doubtful_does_not():
    frame = room_frame(2.0)
    planes = PlaneFinder().find(frame)

    def odds(*likelihood):
        mapper, turned = ImmobileMapper(), (1.0, -2.0, 0.5)
        for step in range(1, 22):
            mapper.add_scan(turned, scan_of(post=(2.02, 0.02), time_s=0.1 * step))
        seen = RgbdPeople(np.tile((1.9, 0.0), (len(likelihood), 1)), np.array(likelihood), nobody(53, 64).label)
        mapper.add_view(make_view(frame, planes, seen))
        return mapper.grid.log_odds_around(turned, np.array([(1.87, 0.02)]), mapper.config.grid.laser_height)[0]

    assert odds() > 1.0
    assert odds(0.45) == odds()
    assert odds(0.55) < odds() - 0.1
    assert odds(0.95) < odds(0.55)


def test_what_comes_into_an_empty_place_is_moving_and_what_was_always_there_is_not():
    mapper = ImmobileMapper()
    for step in range(1, 40):
        mapper.add_scan(np.zeros(3), scan_of(post=(3.0, 1.02), time_s=0.1 * step))
    for step in range(40, 140):
        came = scan_of(post=(2.02, 0.02), time_s=0.1 * step)
        both = np.minimum(came.ranges, scan_of(post=(3.0, 1.02)).ranges)
        mapper.add_scan(np.zeros(3), LaserScan(both, BEARINGS, 0.1, 10.0, 0.1 * step))
    grid = mapper.grid.to_map()
    assert not occupied_at(grid, 1.87, 0.02)
    assert occupied_at(grid, 2.86, 0.97)
    assert occupied_at(grid, 4.02, -1.0)


@pytest.mark.parametrize("came", [True, False])
def test_what_the_laser_saw_come_is_moving_to_the_camera_at_all_heights(came):
    mapper = ImmobileMapper()
    for step in range(1, 60):
        there = (2.02, 0.02) if step > 40 or not came else None
        mapper.add_scan(np.zeros(3), scan_of(post=there, time_s=0.1 * step))
    frame = room_frame(5.9, board=(1.9, 0.0, 1.7))
    mapper.add_view(make_view(frame, PlaneFinder().find(frame), nobody(53, 64)))
    odds = mapper.grid.log_odds_around(np.zeros(3), np.tile((1.9, 0.0), (3, 1)), np.array([0.7, 1.1, 1.5]))
    assert (odds <= 0.0).all() if came else (odds > 0.3).all()


@pytest.mark.parametrize("every", [1, 5])
def test_a_thing_that_was_once_taken_for_somebody_is_forgotten_when_the_camera_sees_no_one_there(every):
    mapper = ImmobileMapper()
    frame = room_frame(0.1, board=(1.9, 0.0, 1.7))
    planes = PlaneFinder().find(frame)
    for step in range(1, 40):
        mapper.add_scan(np.zeros(3), scan_of(post=(2.02, 0.02), time_s=0.1 * step))
        if step == 1 or step % every == 0:
            people = person_of(frame, 1.9) if step == 1 else nobody(53, 64)
            mapper.add_view(make_view(replace(frame, time_s=0.1 * step), planes, people))
        assert len(mapper.people.moving(4.0)) == (1 if step < 17 else 0) or 17 <= step <= 21


def test_nobody_is_doubted_at_the_edge_of_the_picture():
    frame = room_frame(0.1, board=(1.9, 0.0, 1.7))
    view = make_view(frame, PlaneFinder().find(frame), nobody(53, 64))
    mapper = ImmobileMapper()
    mapper.add_scan(np.zeros(3), scan_of(time_s=0.1))
    for place, doubted in (((1.9, 0.0), 1), ((1.9, 1.0), 0)):
        mapper.people.add(np.array([place]), np.array([0.9]), 0.1)
        body = view.points.copy()
        body[(body[:, 0] < 2.0) & (body[:, 2] > 0.3) & (body[:, 2] < 1.8), 1] += place[1]
        shown = replace(view, points=body)
        assert len(mapper._places_without_people(np.zeros(3), shown)) == doubted
        mapper.people.doubt(np.array([place]), 0.0, 0.5)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("distance", [1.5, 3.0])
def test_somebody_is_all_in_the_picture_whose_arms_are(side, distance):
    """The picture ends 35 degrees to either side; a body reaches 0.4 m to the side of its middle."""
    half, body, pose = np.radians(35.0), np.arctan(0.4 / distance), np.array([1.0, -2.0, 0.7])
    view = SimpleNamespace(points=np.array([[np.cos(a), np.sin(a), 1.0] for a in (-half, 0.0, half)]))
    for angle, whole in ((np.radians(34.0) - body, True), (np.radians(36.0) - body, False), (0.0, True)):
        place = transform_points(pose, distance * np.array([[np.cos(angle), side * np.sin(angle)]]))
        assert ImmobileMapper()._whole(pose, view, place).tolist() == [whole]


def test_the_ragged_edge_of_somebody_is_not_written():
    frame = room_frame(0.1, board=(1.9, 0.0, 1.7))
    whole = PlaneFinder().find(frame)
    side = np.where(np.abs(frame.depth - 1.9) < 0.05, CAMERA.rays[..., 1] * 1.9, np.nan)
    ragged = np.where(np.nan_to_num(side) > 0.1, Surface.OTHER, whole.surface).astype(np.int8)
    maps = []
    for known in (True, False):
        mapper, people = ImmobileMapper(), person_of(frame, 1.9) if known else nobody(53, 64)
        people = replace(people, label=np.where(ragged == Surface.OTHER, -1, people.label).astype(np.int32))
        mapper.add_scan(np.zeros(3), scan_of(time_s=0.1))
        for _ in range(10):
            mapper.add_view(make_view(frame, replace(whole, surface=ragged), people))
        maps.append(mapper.grid.to_map())
    assert not occupied_at(maps[0], 1.9, 0.15, reach=0.1)
    assert occupied_at(maps[1], 1.9, 0.15, reach=0.1)


def test_all_of_a_door_that_swings_open_is_moving():
    mapper = ImmobileMapper()
    for step in range(1, 40):
        mapper.add_scan(np.zeros(3), scan_of(time_s=0.1 * step))
    y = BEARINGS * 3.0
    leaf = np.where(np.abs(y) < 0.5, 3.0, 9.0)
    mapper.add_scan(np.zeros(3), LaserScan(np.minimum(leaf, scan_of().ranges), BEARINGS, 0.1, 10.0, 4.0))
    places = mapper.came.moving(4.0)
    for side in (-0.45, 0.0, 0.45):
        assert np.hypot(*(places - (3.0, side)).T).min() < 0.35


def test_what_has_come_and_then_stands_for_long_is_a_thing():
    places = Places(0.35, settles_s=20.0)
    for time_s in np.arange(0.0, 30.0, 0.1):
        places.add(np.array([[2.0, 0.01 * (time_s % 1.0)]]), np.ones(1), time_s)
        places.add(np.array([[5.0, 0.5 * time_s]]), np.ones(1), time_s)
        assert len(places.moving(time_s)) == (2 if time_s < 19.95 else 1)
    assert places.moving(29.9)[0, 0] == 5.0


def test_a_view_that_comes_late_is_written_where_the_robot_was_at_the_exposure():
    maps = []
    for delay in (0, 3):
        mapper, waiting = ImmobileMapper(), []
        for step in range(40):
            time_s, x = 0.1 * step, 0.02 * step
            mapper.add_scan([x, 0.0, 0.0], scan_of(wall=4.02 - x, time_s=time_s))
            frame = room_frame(time_s, board=(2.5 - x, 0.6, 1.6))
            waiting.append(make_view(frame, PlaneFinder().find(frame), nobody(53, 64)))
            if step >= delay:
                mapper.add_view(waiting[step - delay])
        maps.append(mapper.grid.to_map().occupied_points)
    for points in maps:
        board = points[(points[:, 0] > 2.0) & (points[:, 0] < 3.0) & (np.abs(points[:, 1]) < 1.0)]
        assert len(board) > 5
        assert np.abs(board[:, 0] - 2.5).max() < 0.08


def test_legs_that_a_tracker_knows_do_not_enter():
    mapper = ImmobileMapper()
    for step in range(1, 60):
        scan = scan_of(post=(2.02, 0.02), time_s=0.1 * step)
        near = np.hypot(*(np.nan_to_num(scan.beam_points, nan=99.0) - (2.02, 0.02)).T) < 0.3
        mapper.add_scan(np.zeros(3), scan, np.where(near, 0.9, 0.0))
    assert not occupied_at(mapper.grid.to_map(), 1.87, 0.02)
    assert occupied_at(mapper.grid.to_map(), 4.02, 0.52)


def test_a_place_is_as_likely_as_what_is_remembered_nearest_to_it():
    places = Places(0.35)
    assert places.likelihood(np.zeros((2, 2))).tolist() == [0.0, 0.0]
    places.add(np.array([[3.0, 0.0], [5.0, 1.0]]), np.array([0.8, 0.6]), 0.0)
    asked = np.array([[3.1, 0.1], [5.0, 0.7], [4.0, 0.5], [3.0, 0.4]])
    assert places.likelihood(asked).tolist() == [0.8, 0.6, 0.0, 0.0]


def test_a_view_holds_what_was_measured_and_belongs_to_something():
    frame = room_frame(board=(2.0, 0.0, 1.7))
    depth = frame.depth.copy()
    depth[:, :8] = np.nan
    depth[20:23, 12] = 1.2  # three pixels alone in the room
    frame = replace(frame, depth=depth)
    view = CameraViewMaker(config=ViewConfig(graze=0.3)).make(frame)
    assert np.isfinite(view.points).all()
    assert np.abs(view.points[:, 0] - 1.2).min() > 0.05
    board = view.cluster >= 0
    assert board.sum() > 100
    np.testing.assert_allclose(view.above[board], view.points[board, 2] + 0.3, atol=0.05)


def test_places_are_kept_while_somebody_or_something_hides_them():
    places = Places(0.35)
    places.add(np.array([[3.0, 0.0]]), np.array([0.8]), 0.0)
    met = places.update(np.zeros(3), scan_of(post=(1.5, 0.0)))
    assert met.max() == 0.0
    assert len(places.moving(0.1)) == 1
    places.add(np.array([[3.2, 0.0]]), np.array([0.9]), 0.1)
    assert places.moving(0.1).tolist() == [[3.2, 0.0]]
    assert places.update(np.zeros(3), scan_of(post=(3.2, 0.0))).max() == 0.9


def test_somebody_at_the_edge_of_the_scan_is_not_forgotten():
    edge = 1.5 * np.array([np.cos(1.5), np.sin(1.5)])
    for place, kept in ((edge, 1), (np.array([1.5, 0.0]), 0)):
        places = Places(0.35)
        places.add(place[None], np.array([0.9]), 0.0)
        places.update(np.zeros(3), scan_of(wall=4.0))
        assert len(places.moving(0.1)) == kept


def test_wrong_inputs_are_errors():
    for wrong in ({"person_radius": 0.0}, {"appeared_share": 1.2}, {"empty": 0.1}):
        with pytest.raises(InputError, match=next(iter(wrong))):
            ImmobileMapperConfig(**wrong)
    frame = room_frame(9.0)
    mapper = ImmobileMapper()
    mapper.add_scan(np.zeros(3), scan_of())
    planes = PlaneFinder().find(frame)
    with pytest.raises(InputError, match="no pose"):
        mapper.add_view(make_view(frame, planes, NoPeopleFinder().find(frame, planes)))


def test_a_map_whose_robot_was_elsewhere_is_drawn_anew_there():
    away = np.array([1.0, -2.0, 0.0])  # by whole cells: what was recognised is the same then
    frame = room_frame(board=(2.0, 0.0, 1.7))
    view = make_view(frame, PlaneFinder().find(frame), person_of(frame, 2.0))
    path = np.array([(0.02 * k, 0.0, 0.01 * k) for k in range(30)])
    times = 0.1 * np.arange(30) + 0.1
    moved, there = ImmobileMapper(redrawable=True), ImmobileMapper()
    for k in range(30):
        scan = scan_of(post=(2.0, 1.0) if k < 20 else None, time_s=float(times[k]))
        moved.add_scan(path[k], scan)
        there.add_scan(compose(away, path[k]), scan)
        if k == 15:
            late = replace(view, time_s=float(times[k]))
            moved.add_view(late)
            there.add_view(late)
    moved.redraw(times, compose(away, path))
    wanted, got = there.grid.to_map(), moved.grid.to_map()
    assert got.origin == pytest.approx(wanted.origin)
    np.testing.assert_allclose(got.probability, wanted.probability, atol=1e-6)
    np.testing.assert_allclose(moved.people.moving(3.0), there.people.moving(3.0), atol=1e-9)


def test_only_a_map_that_keeps_what_was_written_is_drawn_anew():
    mapper = ImmobileMapper()
    mapper.add_scan(np.zeros(3), scan_of())
    with pytest.raises(InputError, match="redrawable"):
        mapper.redraw([0.1], np.zeros((1, 3)))


def test_laps_of_one_place_do_not_keep_all_that_was_seen():
    mapper = ImmobileMapper(redrawable=True)
    for k in range(1200):
        mapper.add_scan(np.zeros(3), scan_of(time_s=0.1 + 0.1 * k))
    assert len(mapper._written) < 700  # pyright: ignore[reportPrivateUsage]
    mapper.redraw([0.1, 120.0], np.zeros((2, 3)))
    assert occupied_at(mapper.grid.to_map(), 4.02, 0.0)


def test_who_was_remembered_and_what_is_yet_to_come_go_with_the_map_to_where_the_robot_was():
    away, frame = np.array([1.0, -2.0, 0.0]), room_frame(time_s=0.3, board=(2.0, 0.0, 1.7))
    view = make_view(frame, PlaneFinder().find(frame), person_of(frame, 2.0))
    mapper, times = ImmobileMapper(redrawable=True), np.array([0.1, 0.2, 0.3])
    for time_s in times:
        mapper.add_scan(np.zeros(3), scan_of(post=(2.0, 0.0), time_s=float(time_s)))
    mapper.add_view(view)
    (before,) = mapper.people.moving(0.3)
    mapper.redraw(times, np.tile(away, (3, 1)))
    np.testing.assert_allclose(mapper.people.moving(0.3), [before + away[:2]])
    mapper.add_view(view)  # a late one: it is placed where the robot is now known to have been
    np.testing.assert_allclose(mapper.people.moving(0.3), [before + away[:2]], atol=0.02)
    assert len(mapper.people.moving(0.3)) == 1
