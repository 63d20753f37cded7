"""A doubt where the robot is: refuted only by what the map knows, settled only by what it knows."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.slam.geometry import compose
from tagalong.slam.graph.engine import Cartographer
from tagalong.slam.graph.recovery.doubt import Doubt
from tagalong.slam.grid import GridConfig, render_map
from tagalong.slam.localization.place_map import PlaceMap
from walls import cast


def ring(*corners):
    return [(*a, *b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


ROOM = np.array(ring((-4.0, -3.0), (5.0, -3.0), (5.0, 4.0), (-4.0, 4.0)) + ring((1.0, 1.5), (2.2, 1.5), (2.2, 2.5)))
HALL = np.array(ring((-12.0, -1.0), (12.0, -1.0), (12.0, 1.2), (-12.0, 1.2)) + ring((3.0, 0.6), (4.0, 0.6), (4.0, 1.2)))


@pytest.fixture(scope="module")
def mapped():
    """Return the map of the room, and the scans and poses that it is of."""
    rng = np.random.default_rng(0)
    poses = np.array([[x, y, h] for x in (-2.0, 0.0, 3.0) for y in (-1.5, 0.5) for h in (0.0, 2.0)])
    scans = [cast(ROOM, pose, rng) for pose in poses]
    place = PlaceMap(render_map(poses, scans, GridConfig()))
    return place, list(zip(scans, poses, strict=True))


def weighed(mapped, believed, true, lines=ROOM, scans=12, closable=(1.0, 0.5)):
    """Return a doubt after a drive ahead from `true`, which local SLAM takes for one from `believed`."""
    place, known = mapped
    doubt, rng = Doubt(place, lambda: place, known, closable), np.random.default_rng(1)
    for k in range(scans):
        step = np.array([0.1 * k, 0.0, 0.0])
        doubt.weigh(step, cast(lines, compose(np.array(true), step), rng), step, np.array(believed))
    return doubt


def test_where_scans_fit_the_map_the_doubt_is_settled(mapped):
    doubt = weighed(mapped, (-2.0, -1.0, 0.1), (-2.0, -1.0, 0.1))
    assert doubt.settled
    assert doubt.possible
    assert not doubt.refuted
    doubt.elsewhere = np.zeros(3)  # found in another place, too: two places that look alike
    assert doubt.settled
    briefly = weighed(mapped, (-2.0, -1.0, 0.1), (-2.0, -1.0, 0.1), scans=6)
    assert briefly.settled
    briefly.elsewhere = np.zeros(3)
    assert not briefly.settled


def test_local_slam_may_have_drifted_a_little(mapped):
    assert weighed(mapped, (-1.9, -1.15, 0.12), (-2.0, -1.0, 0.1)).settled


def test_a_robot_that_is_elsewhere_on_the_map_is_found_there(mapped):
    doubt = weighed(mapped, (-2.0, -1.0, 0.1), (2.0, -2.0, 1.9), scans=16)
    assert doubt.refuted
    assert not doubt.possible
    assert doubt.elsewhere is not None
    np.testing.assert_allclose(
        doubt.elsewhere, compose(np.array([2.0, -2.0, 1.9]), np.array([1.5, 0.0, 0.0])), atol=0.1
    )
    assert doubt.followed
    assert not doubt.found  # not yet: a little more of the way


def test_a_robot_is_told_elsewhere_only_after_three_scans_that_find_it_there(mapped):
    place, known = mapped
    doubt, rng, told = Doubt(place, lambda: place, known, (1.0, 0.5)), np.random.default_rng(1), {}
    for k in range(16):
        step = np.array([0.1 * k, 0.0, 0.0])
        scan = cast(ROOM, compose(np.array([2.0, -2.0, 1.9]), step), rng)
        doubt.weigh(step, scan, step, np.array([-2.0, -1.0, 0.1]))
        told[len(doubt._there)] = doubt.elsewhere is not None
    assert {found: told[found] for found in (1, 2, 3, 4)} == {1: False, 2: False, 3: True, 4: True}


def test_what_a_loop_search_finds_by_itself_is_not_elsewhere(mapped):
    doubt = weighed(mapped, (-2.0, -1.0, 0.1), (2.0, -2.0, 1.9), closable=(8.0, 3.2))
    assert doubt.refuted
    assert doubt.elsewhere is None
    assert not doubt.possible


def test_where_the_map_knows_nothing_nothing_is_refuted_nor_settled(mapped):
    doubt = weighed(mapped, (30.0, 0.0, 0.0), (-8.0, 0.0, 0.0), HALL)
    assert not doubt.refuted
    assert not doubt.settled
    assert doubt.possible


def test_a_scan_of_a_place_of_which_the_map_knows_nothing_does_not_vouch_where_scans_usually_fit_badly(mapped):
    place, known = mapped
    rng = np.random.default_rng(2)
    people = [(replace(s, ranges=np.where(rng.random(len(s)) < 0.3, 0.5 * s.ranges, s.ranges)), p) for s, p in known]
    doubt = weighed((place, people), (30.0, 0.0, 0.0), (-8.0, 0.0, 0.0), HALL)
    assert not doubt.vouched
    assert not doubt.settled


@pytest.mark.parametrize(("known", "vouches"), [(0.9, True), (0.3, False)])
def test_a_scan_vouches_for_a_place_only_where_the_map_knows_most_of_what_it_sees(mapped, monkeypatch, known, vouches):
    monkeypatch.setattr(Doubt, "_fits", lambda *_: (0.0, known))
    assert weighed(mapped, (-2.0, -1.0, 0.1), (-2.0, -1.0, 0.1)).vouched == vouches


def test_what_was_refuted_stays_so_where_the_map_knows_nothing(mapped):
    place, known = mapped
    doubt, rng = Doubt(place, lambda: place, known, (8.0, 3.2)), np.random.default_rng(1)  # found nowhere else
    for k in range(12):
        step = np.array([0.3 * k, 0.0, 0.0])
        doubt.weigh(step, cast(HALL, compose(np.array([-9.0, 0.0, 0.0]), step), rng), step, np.array([-3.0, -1.0, 0.1]))
    assert doubt.impossible
    against, known = doubt._against, doubt._known
    for k in range(12, 40):  # local SLAM has left the map
        step = np.array([30.0 + 0.3 * k, 0.0, 0.0])
        doubt.weigh(step, cast(HALL, np.array([-9.0 + 0.3 * k, 0.0, 0.0]), rng), step, np.array([-3.0, -1.0, 0.1]))
    assert doubt._against == pytest.approx(against, rel=0.05)
    assert doubt._known == pytest.approx(known, rel=0.05)
    assert doubt.refuted
    assert doubt.elsewhere is None
    assert doubt.impossible
    assert not doubt.vouched
    assert not doubt.possible


def test_in_another_building_where_local_slam_has_the_robot_is_impossible_and_no_other_place_is_found(mapped):
    doubt = weighed(mapped, (-3.0, -1.0, 0.1), (-9.0, 0.0, 0.0), HALL, scans=40)
    assert doubt.impossible
    assert doubt.elsewhere is None


@pytest.mark.parametrize(("hidden", "possible"), [(0.35, True), (0.9, False)])
def test_people_around_the_laser_hide_a_part_of_what_fits_but_not_most_of_it(mapped, hidden, possible):
    place, known = mapped
    doubt, rng, start = Doubt(place, lambda: place, known, (8.0, 3.2)), np.random.default_rng(1), (-2.0, -1.0, 0.1)
    for k in range(12):
        step = np.array([0.1 * k, 0.0, 0.0])
        scan = cast(ROOM, compose(np.array(start), step), rng)
        ranges = np.where(rng.random(len(scan)) < hidden, scan.ranges * rng.uniform(0.3, 0.7, len(scan)), scan.ranges)
        doubt.weigh(step, replace(scan, ranges=ranges), step, np.array(start))
    assert doubt.refuted  # far worse than usual
    assert not doubt.vouched
    assert doubt.possible == possible


def test_scans_without_returns_follow_a_robot_nowhere(mapped):
    blind = cast(ROOM, np.zeros(3), np.random.default_rng(0), reach=0.5)
    doubt = weighed(mapped, (-2.0, -1.0, 0.1), (2.0, -2.0, 1.9), scans=9)
    followed = len(doubt._there)
    assert 3 < followed < 10
    for k in range(9, 30):
        step = np.array([0.1 * k, 0.0, 0.0])
        doubt.weigh(step, blind, step, np.array([-2.0, -1.0, 0.1]))
    assert len(doubt._there) == followed
    assert not doubt.found


def test_where_the_map_knows_nothing_nothing_speaks_for_local_slam_when_it_is_asked_since_when_it_was_wrong(mapped):
    place, known = mapped
    doubt, rng, start = Doubt(place, lambda: place, known, (1.0, 0.5)), np.random.default_rng(1), (2.0, -2.0, 1.9)
    for k in range(30):
        step = np.array([0.1 * k, 0.0, 0.0])
        scan = cast(ROOM, compose(np.array(start), step), rng)
        noisy = replace(scan, ranges=np.where(rng.random(len(scan)) < 0.2, 0.5 * scan.ranges, scan.ranges))
        local = step + np.array([0.0 if k < 2 else 30.0, 0.0, 0.0])  # local SLAM soon has it off the map
        doubt.weigh(step, noisy, local, np.array([-2.0, -1.0, 0.1]))
    doubt.elsewhere = compose(np.array(start), step)
    assert doubt.changed == 0


def test_without_a_map_nothing_can_be_said():
    doubt = Doubt(None, lambda: None, [], (1.0, 0.5))
    doubt.weigh(np.zeros(3), cast(ROOM, np.zeros(3), np.random.default_rng(0)), np.zeros(3), np.zeros(3))
    assert not (doubt.refuted)
    assert not (doubt.settled)
    assert not (doubt.found)


def test_when_the_robot_was_carried_is_told_by_the_scans(mapped):
    place, known = mapped
    doubt, rng, believed = (
        Doubt(place, lambda: place, known, (1.0, 0.5)),
        np.random.default_rng(1),
        np.array([-2.0, -1.0, 0.1]),
    )
    for k in range(24):
        step = np.array([0.1 * k, 0.0, 0.0])
        true = believed if k < 2 else np.array([2.0, -2.0, 1.9])
        doubt.weigh(step, cast(ROOM, compose(true, step), rng), step, believed)
    assert doubt.followed
    assert doubt.changed == 2


def test_a_robot_whose_turn_its_odometry_does_not_tell_is_not_found_there(mapped):
    place, known = mapped
    doubt, rng, true = (
        Doubt(place, lambda: place, known, (1.0, 0.5)),
        np.random.default_rng(1),
        np.array([0.0, -2.0, 0.6]),
    )
    for k in range(40):
        step = np.array([0.1 * k, 0.0, 0.0])
        doubt.weigh(step, cast(ROOM, compose(true, step), rng), step, np.array([-2.0, -1.0, 2.5]))
    assert doubt.found
    fits, badly = doubt._there[-1], (3.0, 1.0)
    doubt._there.extend([badly, *[fits] * 3])  # one of ten fits nowhere there
    assert doubt.found
    doubt._there.extend([*[badly] * 4, *[fits] * 3])
    assert not doubt.found  # half of them do, and the last again
    doubt._there.extend([(0.0, 0.3)] * 10)  # where the map knows hardly anything
    assert not doubt.found
    doubt._there.extend([fits] * 10)
    assert doubt.found
    turned = compose(step, np.array([0.15, 0.0, 1.2]))  # as local SLAM sees by the scans
    doubt.weigh(
        compose(step, np.array([0.15, 0.0, 0.0])),
        cast(ROOM, compose(true, turned), rng),
        turned,
        np.array([-2.0, -1.0, 2.5]),
    )
    assert not doubt.found


@pytest.mark.parametrize(
    ("travelled", "impossible", "ends"), [(30.0, False, True), (30.0, True, False), (19.0, False, False)]
)
def test_a_doubt_is_given_up_after_a_while_unless_it_stands(travelled, impossible, ends):
    recovery, result = Cartographer()._recovery, object()
    recovery._doubt = SimpleNamespace(settled=False, found=False, impossible=impossible, travelled=travelled, scans=20)
    assert recovery._concluded(recovery._doubt, result) is result
    assert (recovery._doubt is None) == ends


def test_a_settled_doubt_ends_whatever_other_place_was_found(monkeypatch):
    recovery, result = Cartographer()._recovery, object()
    monkeypatch.setattr(recovery, "_found", lambda doubt, result: None)
    doubt = SimpleNamespace(settled=True, found=True, changed=0, scans=20, impossible=False, travelled=3.0)
    recovery._doubt = doubt
    assert recovery._concluded(doubt, result) is result
    assert recovery._doubt is None
    doubt.settled = False
    recovery._doubt = doubt
    assert recovery._concluded(doubt, result) is None
    assert recovery._doubt is doubt
