"""The buildings."""

import numpy as np
import pytest
from tagalong.envs.scenes.catalogue import SCENES, make_scene
from tagalong.envs.scenes.occupancy import true_map
from tagalong.envs.scenes.polyline import arc_lengths, resample, rounded, tangents
from tagalong.envs.scenes.scene import RUN_OUT
from tagalong.envs.scenes.solids import Solid, box
from tagalong.slam import InputError
from tagalong.slam.geometry import compose, transform_points

NAMES = sorted(SCENES)
TIGHT = {"narrow_doors", "tight_doorway", "tight_office"}
"""Their doors are 0.9 m wide."""
SIZED = {"busy_crossing", "wide_corridor"}
"""Their sizes are what they are named by."""


@pytest.mark.parametrize("name", NAMES)
def test_a_robot_can_drive_every_route(name):
    for seed in range(30):
        scene = make_scene(name, np.random.default_rng(seed))
        for route in scene.routes.values():
            assert scene.clearance(resample(route, 0.1)).min() > (0.35 if name in TIGHT else 0.45)


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"floor_plan"} - SIZED))
def test_sizes_and_clutter_come_from_the_seed(name):
    scene, again, other = (make_scene(name, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert scene.solids == again.solids
    assert scene.solids != other.solids


@pytest.mark.parametrize("name", sorted(set(NAMES) - {"narrow_corridor", "tight_doorway"}))
def test_there_is_room_to_stand_beside_the_route(name):
    for seed in range(20):
        scene = make_scene(name, np.random.default_rng(seed))
        points = resample(scene.route, 0.1)
        ahead = tangents(points)
        at = np.round(scene.standing_places[:, 0] / 0.1).astype(int)
        spots = points[at] + scene.standing_places[:, 1:] * np.stack((-ahead[at, 1], ahead[at, 0]), axis=-1)
        assert len(spots) > 5
        assert scene.clearance(spots, of_people=True).min() > 0.25


def test_corridor_sizes_stay_within_a_quarter_of_the_usual():
    for seed in range(20):
        x0, y0, x1, y1 = make_scene("corridor", np.random.default_rng(seed)).bounds
        assert 30.0 <= x1 - x0 <= 50.0 + 1.0
        assert 7.5 + 1.8 <= y1 - y0 <= 12.5 + 3.0 + 4.0


def test_laps_of_the_meeting_room_close():
    scene = make_scene("meeting_room", np.random.default_rng(0), "clockwise")
    route = resample(scene.route, 0.01)
    lap = round(scene.lap / 0.01)
    assert np.abs(route[lap] - route[0]).max() < 0.03
    assert scene.tour_length == pytest.approx(2.0 * scene.lap, abs=1e-6)
    assert arc_lengths(scene.route)[-1] == pytest.approx(scene.tour_length + RUN_OUT)


def test_unknown_names_are_answered_with_the_known_ones():
    with pytest.raises(
        InputError,
        match="busy_crossing, clutter, corridor, doorway, floor_plan, intersection, lab, landmarks, meeting_room",
    ):
        make_scene("plasa", np.random.default_rng(0))
    with pytest.raises(InputError, match="back, forward"):
        make_scene("corridor", np.random.default_rng(0), "sideways")


def test_the_distance_to_a_turned_box_is_that_to_its_outline():
    solid = Solid(kind="box", x=1.0, y=2.0, yaw=0.5, half_length=0.6, half_width=0.2)
    corners = solid.outline()
    assert solid.distance(corners) == pytest.approx(np.zeros(4), abs=1e-12)
    assert solid.distance([1.0, 2.0]) == pytest.approx(-0.2)
    assert box("wall", (0.0, 0.0), (2.0, 1.0)).distance([3.0, 0.5]) == pytest.approx(1.0)


def test_rounded_corners_are_tangent_arcs():
    curve = rounded([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0)], radius=1.0, spacing=0.01)
    arc = curve[(curve[:, 0] > 3.0 + 1e-9) & (curve[:, 1] < 1.0 - 1e-9)]
    assert np.hypot(arc[:, 0] - 3.0, arc[:, 1] - 1.0) == pytest.approx(1.0)
    assert arc_lengths(curve)[-1] == pytest.approx(3.0 + np.pi / 2.0 + 3.0, abs=1e-3)


def test_the_true_map_shows_the_surfaces_that_the_laser_can_see():
    scene = make_scene("meeting_room", np.random.default_rng(3))
    truth = true_map(scene, 0.05, 0.2)
    seen = [solid for solid in scene.solids if solid.at_height(0.2)]
    distance = np.min([np.abs(solid.distance(truth.occupied_points)) for solid in seen], axis=0)
    assert distance.max() < 0.08
    for kind, found in (("table leg", True), ("chair", False), ("table", False)):
        solid = next(solid for solid in scene.solids if solid.kind == kind)
        near = np.hypot(*(truth.occupied_points - (solid.x, solid.y)).T).min() < 0.06
        assert near == found, kind
    assert truth.free[truth.known].mean() > 0.9


def test_the_true_map_can_be_drawn_in_the_frame_of_the_robots_start():
    scene = make_scene("meeting_room", np.random.default_rng(3))
    T_world_map = np.array([1.0, -2.0, 0.6])
    turned = transform_points(T_world_map, true_map(scene, 0.05, 0.2, T_world_map).occupied_points)
    plain = true_map(scene, 0.05, 0.2).occupied_points
    nearest = np.hypot(*(turned[:, None] - plain[None]).transpose(2, 0, 1)).min(axis=1)
    assert nearest.max() < 0.1
    assert compose(T_world_map, [0.0, 0.0, 0.0]) == pytest.approx(T_world_map)
