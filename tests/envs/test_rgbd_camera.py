"""The RGB-D camera: geometry, noise, looks, both back ends, snapshots."""

import json
import os
import pickle
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.envs.appearance.looks import dress
from tagalong.envs.appearance.pattern import SurfacePattern
from tagalong.envs.physics.mj import mujoco
from tagalong.envs.scenes.lab import CEILING
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.camera.noise import depth_sigma, measure_depth, on_edge
from tagalong.envs.sensors.camera.opengl import open_renderer
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError

EXACT = RgbdConfig(noise=0.0, edge_missing=0.0, missing=0.0)


def make(seed=0, camera=EXACT, **options):
    defaults = {"scene": "lab", "route": "operator", "people": 0, "leader": False, "lidar": LidarConfig(beams=61)}
    return World(WorldConfig(**{**defaults, "camera": camera, **options}), np.random.default_rng(seed))


def points_of(frame):
    """(h, w, 3) what each pixel measured, in the camera frame."""
    return frame.camera.rays * frame.depth[..., None]


def test_the_angles_of_view_are_seventy_by_sixty_degrees():
    rays = EXACT.pinhole.rays
    half_pixel = 0.5
    assert rays.shape == (106, 128, 3)
    assert np.degrees(np.arctan(rays[0, 0, 1])) == pytest.approx(35.0, abs=half_pixel)
    assert np.degrees(np.arctan(rays[0, 0, 2])) == pytest.approx(30.0, abs=half_pixel)
    assert rays[-1, -1, 1:] == pytest.approx(-rays[0, 0, 1:])


def test_floor_and_ceiling_are_where_they_are_built():
    world = make()
    heights = points_of(world.frames[-1])[..., 2] + 1.0
    names = [world.model.geom(int(geom)).name if geom >= 0 else "" for geom in world.frame_geoms().ravel()]
    for name, height in (("floor", 0.0), ("ceiling", CEILING)):
        seen = (np.array(names) == name).reshape(heights.shape) & np.isfinite(heights)
        assert seen.sum() > 300
        assert heights[seen] == pytest.approx(height, abs=1e-4)


def test_depth_is_measured_from_half_a_metre_to_eight():
    camera = RgbdConfig(noise=0.0)
    exact = np.array([[0.3, 0.6, 7.9, 8.1, np.inf] * 3] * 3)
    depth = measure_depth(exact, np.zeros(exact.shape), RgbdConfig(noise=0.0, edge_missing=0.0, missing=0.0), rng())
    assert np.array_equal(np.isfinite(depth[0, :5]), [False, True, True, False, False])
    assert camera.range_min == 0.5


def rng(seed=0):
    return np.random.default_rng(seed)


def test_noise_grows_with_distance_and_at_grazing_angles():
    sigma = depth_sigma(np.array([1.0, 3.0, 6.0]), np.zeros(3))
    assert sigma == pytest.approx([0.0013, 0.0027, 0.0093])
    assert depth_sigma(np.array([3.0]), np.radians([80.0]))[0] > 3.0 * sigma[1]
    wall = np.full((106, 128), 3.0)
    noise = measure_depth(wall, np.zeros(wall.shape), RgbdConfig(), rng()) - wall
    assert np.nanstd(noise) == pytest.approx(sigma[1], rel=0.05)
    assert np.isnan(noise).mean() < 0.01


def test_returns_are_missing_where_depth_jumps_and_not_where_a_floor_runs_away():
    rays = EXACT.pinhole.rays
    floor = np.where(rays[..., 2] < -0.2, 1.0 / np.maximum(-rays[..., 2], 1e-9), 6.0)
    below = rays[..., 2] < -0.25
    assert not on_edge(floor)[below].any()
    box = floor.copy()
    box[50:, 40:60] = np.minimum(box[50:, 40:60], 1.2)
    edge = on_edge(box)
    assert edge[60:70, 39:41].all()
    assert edge[60:70, 59:61].all()
    depth = measure_depth(box, np.zeros(box.shape), RgbdConfig(), rng())
    assert 0.5 < np.isnan(depth[edge]).mean() < 0.9
    assert np.isnan(depth[~edge & (box < 7.5)]).mean() < 0.01


def test_surfaces_seen_edge_on_return_nothing():
    wall = np.full((4, 4), 2.0)
    assert np.isnan(measure_depth(wall, np.full(wall.shape, np.radians(87.0)), EXACT, rng())).all()


def test_vibration_tilts_single_frames_only():
    world = make(camera=RgbdConfig(noise=0.0, edge_missing=0.0, missing=0.0, vibration=np.radians(1.5)))
    tilts = []
    for _ in range(12):
        world.step([0.0, 0.0])
        heights = points_of(world.frames[-1])[..., 2] + 1.0
        seen = (world.frame_geoms() == world.model.geom("ceiling").id) & np.isfinite(heights)
        tilts.append(heights[seen].mean() - CEILING)
    assert np.std(tilts) > 0.01
    assert make().frames[-1].camera_height == 1.0


def test_people_wear_different_clothes_on_different_seeds_and_faces_have_hair():
    world, other = make(0), make(1)
    torsos = [w.model.geom_rgba[w.model.geom_bodyid == w.model.body("person 0 torso").id][0] for w in (world, other)]
    assert np.abs(torsos[0] - torsos[1]).max() > 0.05
    looks = dress(world.model, rng(4))
    heads = np.flatnonzero(looks.pattern == SurfacePattern.HEAD)
    assert len(heads) == 4
    assert np.abs(looks.first[heads] - looks.second[heads]).max() > 0.1


def test_pictures_tell_people_from_walls_by_their_true_labels():
    world = make()
    world.data.qpos[:3] = (6.0, 1.2, 0.0)
    world.step([0.0, 0.0])
    people = world.people_of(world.frame_geoms())
    assert set(np.unique(people)) >= {-1, 2}
    assert (people == 2).sum() > 60
    x, y = world.truth.people.positions[2] - world.truth.robot_pose[:2] - (0.1, 0.0)
    seen = points_of(world.frames[-1])[(people == 2) & np.isfinite(world.frames[-1].depth)]
    assert np.median(seen, axis=0)[:2] == pytest.approx([x, y], abs=0.25)


BOTH = """
import json
import numpy as np
from tagalong.envs.appearance.looks import dress
from tagalong.envs.appearance.pattern import SurfacePattern
from tagalong.envs.physics.mj import mujoco
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.sensors.camera.opengl import OpenGlCamera
from tagalong.envs.sensors.camera.rays import RayCamera
from tagalong.envs.world.world import World, WorldConfig

world = World(WorldConfig(scene="lab", route="operator", people=0, leader=False), np.random.default_rng(0))
looks = dress(world.model, np.random.default_rng(5))
looks.pattern[:] = SurfacePattern.PLAIN
mujoco.mj_forward(world.model, world.data)
camera = RgbdConfig().pinhole
opengl = OpenGlCamera(camera, world.model)
origin = np.array([1.5, 1.2, 1.0])
ray = RayCamera(camera, world.model, looks).cast(world.data, origin, np.eye(3))
drawn = opengl.cast(world.data, origin, np.eye(3))
opengl.close()
same = ray.geom == drawn.geom
print(json.dumps({
    "same": same.mean(),
    "depth": np.quantile(np.abs(ray.depth - drawn.depth)[same], 0.99),
    "colour": np.abs(ray.colour[same].astype(float) - drawn.colour[same]).mean(),
    "incidence": np.median(np.abs(ray.incidence - drawn.incidence)[same]),
}))
"""


def test_a_picture_too_large_for_opengl_is_not_called_a_lack_of_it():
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    with pytest.raises(InputError, match="at most 640 x 480 pixels, got 2000 x 240"):
        open_renderer(model, 240, 2000)


class PyOpenGlError(Exception):
    """Stands in for `OpenGL.error.Error`, which is loaded only with MuJoCo's EGL or OSMesa."""


@pytest.mark.parametrize("kind", [mujoco.FatalError, ImportError, RuntimeError, PyOpenGlError])
def test_whatever_is_missing_of_opengl_is_called_so(kind, monkeypatch):
    monkeypatch.setitem(sys.modules, "OpenGL.error", SimpleNamespace(Error=PyOpenGlError))
    monkeypatch.setattr(mujoco, "Renderer", lambda *_: (_ for _ in ()).throw(kind("no display")))
    with pytest.raises(InputError, match=r"OpenGL is not present \(no display\).*MUJOCO_GL=egl.*needs nothing of this"):
        open_renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 48, 64)


def test_a_mistake_of_ours_is_not_called_a_lack_of_opengl(monkeypatch):
    monkeypatch.setattr(mujoco, "Renderer", lambda *_: (_ for _ in ()).throw(TypeError("height must be an integer")))
    with pytest.raises(TypeError, match="must be an integer"):
        open_renderer(mujoco.MjModel.from_xml_string("<mujoco/>"), 48, 64)


def test_rays_and_opengl_show_the_same():
    """In an interpreter of its own, since MuJoCo chooses its OpenGL when it is imported."""
    settings = {"MUJOCO_GL": "egl", **os.environ} if sys.platform.startswith("linux") else dict(os.environ)
    done = subprocess.run([sys.executable, "-c", BOTH], env=settings, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"no OpenGL: {done.stderr.strip().splitlines()[-1]}")
    gap = json.loads(done.stdout)
    assert gap["same"] > 0.995
    assert gap["depth"] < 0.01
    assert gap["colour"] < 4.0
    assert gap["incidence"] < 0.01


def test_the_same_seed_gives_the_same_frames_and_the_camera_changes_nothing_else():
    def drive(world):
        for _ in range(5):
            world.step([0.2, 0.1])
        return world

    first, second, without = drive(make()), drive(make()), drive(make(camera=None))
    assert first.frames[-1].depth.tobytes() == second.frames[-1].depth.tobytes()
    assert first.frames[-1].colour.tobytes() == second.frames[-1].colour.tobytes()
    assert first.scan().ranges.tobytes() == without.scan().ranges.tobytes()
    assert without.frames == ()


def test_a_restored_or_pickled_world_goes_on_with_the_same_frames():
    world = make(camera=RgbdConfig(width=32, height=24))
    for _ in range(3):
        world.step([0.2, 0.0])
    state, copied = world.save_state(), pickle.loads(pickle.dumps(world))

    def onward(of):
        for _ in range(3):
            of.step([0.2, 0.0])
        return of.frames[-1].depth.tobytes() + of.frames[-1].colour.tobytes()

    expected = onward(world)
    world.restore_state(state)
    assert onward(world) == expected
    assert onward(copied) == expected


def test_frames_come_at_their_own_rate():
    world = make(camera=RgbdConfig(width=16, height=12, rate_hz=20.0))
    world.step([0.0, 0.0])
    assert [frame.time_s for frame in world.frames] == pytest.approx([0.05, 0.1])


def test_impossible_cameras_are_errors():
    for options, word in (
        ({"backend": "film"}, "opengl, rays"),
        ({"range_min": 9.0}, "range_min"),
        ({"missing": 1.0}, "missing"),
        ({"width": 1}, "width"),
        ({"horizontal_fov": 4.0}, "horizontal_fov"),
        ({"rate_hz": 0.0}, "rate_hz"),
        ({"vibration": -1.0}, "vibration"),
    ):
        with pytest.raises(InputError, match=word):
            RgbdConfig(**options)
    with pytest.raises(InputError, match="camera's period"):
        make(camera=RgbdConfig(rate_hz=30.0))
