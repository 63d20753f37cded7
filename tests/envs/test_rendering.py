"""Pictures without a display and without OpenGL."""

import sys

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.topview import palette
from tagalong.envs.topview.canvas import Camera
from tagalong.envs.topview.map_panel import sample_map
from tagalong.envs.topview.rendering import CameraRenderer, make_renderer
from tagalong.slam import InputError, OccupancyMap


def make(scene="Corridor", **arguments):
    settings = {"people": "truth", "slam": None, "beams": 361, "render_mode": "rgb_array", **arguments}
    return gym.make(f"tagalong/{scene}-v0", disable_env_checker=True, **settings)


@pytest.mark.parametrize("scene", ["Corridor", "MeetingRoom"])
def test_the_top_view_shows_robot_and_leader_in_their_colours(scene):
    env = make(scene, slam="truth")
    env.reset(seed=0)
    first = env.render()
    env.step(np.array([0.5, 0.0]))
    second = env.render()
    assert first.shape == (540, 960, 3)
    assert first.dtype == np.uint8
    assert not np.array_equal(first, second)
    for colour in (palette.LEADER, palette.ROBOT):
        assert (np.abs(first.astype(int) - colour).sum(axis=2) < 30).sum() > 20, colour


def test_a_picture_depends_on_the_state_alone():
    pictures = []
    for _ in range(2):
        env = make()
        env.reset(seed=2)
        env.step(np.array([0.5, 0.1]))
        pictures.append(env.render())
    assert np.array_equal(*pictures)


def test_the_map_panel_shows_cells_where_they_are():
    probability = np.full((10, 10), 0.1, dtype=np.float32)
    probability[2, 7] = 0.9
    probability[8] = np.nan
    grid = OccupancyMap(probability, 1.0, (0.0, 0.0))
    picture = sample_map(grid, np.zeros(3), Camera((5.0, 5.0), 4.0, (40, 40)))
    assert tuple(picture[39 - (2 * 4 + 1), 7 * 4 + 1]) == palette.MAP_OCCUPIED
    assert tuple(picture[39 - (8 * 4 + 1), 5]) == palette.MAP_UNKNOWN
    assert tuple(picture[39 - 5 * 4 - 1, 5]) == palette.MAP_FREE


def test_without_a_render_mode_nothing_is_drawn():
    env = make(render_mode=None).unwrapped
    env.reset(seed=0)
    assert env.render() is None


def test_unknown_modes_and_back_ends_are_refused():
    with pytest.raises(InputError, match="render modes: human, rerun, rgb_array"):
        make_renderer("ascii", "topview")
    with pytest.raises(InputError, match="render back ends: mujoco, topview"):
        make_renderer("rgb_array", "cairo")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="a window may open")
def test_a_viewer_without_a_display_says_so(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError, match="needs a display"):
        make(render_mode="human")


def test_the_camera_of_mujoco_draws_where_opengl_is_there():
    env = make(render_backend="mujoco").unwrapped
    env.reset(seed=0)
    try:
        picture = env.render()
    except InputError as error:
        pytest.skip(str(error))
    assert picture.shape == (480, 640, 3)
    assert picture.std() > 5.0
    env.close()


def test_a_renderer_leaves_nothing_open_behind_when_pickled():
    assert CameraRenderer().__getstate__() == {"_of": None, "_renderer": None}


def test_record_video_writes_a_film(tmp_path):
    pytest.importorskip("moviepy")
    env = gym.wrappers.RecordVideo(make(), str(tmp_path), disable_logger=True)
    env.reset(seed=0)
    for _ in range(5):
        env.step(np.zeros(2))
    env.close()
    assert [path.stat().st_size > 1000 for path in tmp_path.glob("*.mp4")] == [True]


def test_the_picture_shows_the_way_that_the_robot_came():
    env = make(beams=8).unwrapped
    env.reset(seed=0)
    places = [env.truth.robot_pose[:2]]
    for _ in range(5):
        env.step([0.5, 0.2])
        places.append(env.truth.robot_pose[:2])
    shown = []
    env._renderer.draw = lambda world, truth, belief, trail: shown.append(trail)
    env.render()
    np.testing.assert_array_equal(shown[0], places)
