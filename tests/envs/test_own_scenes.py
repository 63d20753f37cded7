"""Scenes of one's own: a function draws them, and what cannot be used is refused in one line."""

from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.scenes import SCENES, Door, Scene, SceneRequest, Walk, box, make_scene, post, room
from tagalong.envs.scenes.scene_check import checked_scene
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError


def hall(rng, request):
    """A hall with one pillar at a drawn place."""
    return Scene(
        name="hall",
        solids=(*room((0.0, -2.5), (16.0, 2.5)), post("pillar", float(rng.uniform(4.0, 12.0)), -1.8, 0.25, 2.5)),
        floor=np.array([(0.0, -2.5), (16.0, -2.5), (16.0, 2.5), (0.0, 2.5)]),
        routes={"along": np.array([(1.0, 0.0), (15.0, 0.0)]), "back": np.array([(15.0, 0.0), (1.0, 0.0)])},
        route_name=request.route or "along",
        half_width=1.2,
    )


def test_a_function_is_a_scene_in_the_simulator_and_its_draws_are_the_seeds():
    config = WorldConfig(scene=hall, people=3, lidar=LidarConfig(beams=61))
    one, same, other = (World(config, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert one.scene.solids == same.scene.solids
    assert one.scene.solids != other.scene.solids
    assert len(one.truth.people) == 3
    for _ in range(20):
        one.step((0.3, 0.0))
    assert not one.truth.contact_static


def test_the_environment_takes_it_by_name_of_the_setting_and_for_one_episode():
    env = gym.make("tagalong/Corridor-v0", scene=hall, slam=None, people="truth")
    env.reset(seed=0)
    assert env.unwrapped.world.scene.name == "hall"
    env.reset(seed=0, options={"scene": hall, "route": "back"})
    assert env.unwrapped.world.scene.route[0, 0] == 15.0
    env.reset(seed=0, options={"scene": "plain_corridor"})
    assert env.unwrapped.world.scene.name == "plain_corridor"
    env.close()


@pytest.mark.parametrize("name", SCENES)
def test_the_scenes_of_the_table_pass_the_check_of_ones_own(name):
    request = SceneRequest()
    scene = make_scene(name, np.random.default_rng(0), request=request)
    assert checked_scene(scene, request) is scene


FLAT = box("wall", (0.0, 0.0), (0.0, 1.0))
MALFORMED = {
    "solids, none": ({"solids": ()}, "the `solids` of scene 'hall'"),
    "solids, no tuple": ({"solids": 3}, "the `solids` of scene 'hall'"),
    "solids, flat": ({"solids": (FLAT,)}, "none of them flat"),
    "solids, far away": ({"solids": (box("wall", (0.0, 0.0), (1e4, 1.0)),)}, "within 500 m"),
    "floor": ({"floor": np.zeros((2, 2))}, "the `floor` of scene 'hall' must have at least 3 points"),
    "routes": ({"routes": {}}, "the `routes` of scene 'hall'"),
    "route, unknown": ({"route_name": "up"}, "unknown route 'up'"),
    "route, short": ({"routes": {"along": np.array([(1.0, 0.0), (4.0, 0.0)])}}, "at least 5 m long"),
    "route, through a wall": ({"routes": {"along": np.array([(1.0, 0.0), (15.0, 2.5)])}}, "0.3 m from everything"),
    "route, not finite": ({"routes": {"along": np.full((3, 2), np.nan)}}, "finite numbers"),
    "half width": ({"half_width": 0.0}, "positive `half_width`"),
    "lap": ({"lap": 99.0}, "`lap` no longer than its tour"),
    "standing places": ({"standing_places": np.zeros(3)}, "the `standing_places` of scene 'hall'"),
    "walks": ({"walks": (Walk(points=np.zeros((1, 2))),)}, "a walk of scene 'hall'"),
    "doors": ({"doors": [Door(hinge=(0.0, 0.0), yaw=0.0, swing=1.0, width=1.0)]}, "must be a tuple of Door"),
}


@pytest.mark.parametrize("what", MALFORMED)
def test_a_scene_that_cannot_be_used_is_refused_in_one_line(what):
    fields, rule = MALFORMED[what]
    with pytest.raises(InputError, match=r"^[^\n]*$") as error:
        make_scene(lambda rng, request: replace(hall(rng, request), **fields), np.random.default_rng(0))
    assert rule in str(error.value)


def test_a_function_that_returns_no_scene_and_what_is_no_scene_are_refused():
    with pytest.raises(InputError, match="must return a Scene, got None"):
        make_scene(lambda rng, request: None, np.random.default_rng(0))
    with pytest.raises(InputError, match="unknown scene 5; scenes: busy_crossing, clutter, "):
        WorldConfig(scene=5)
