"""The floor first, from any mount: tilt and height by the frame itself, however high and tilted the camera is."""

import numpy as np
import pytest
from tagalong.perception.rgbd.frame import Pinhole, RgbdFrame, grey
from tagalong.perception.rgbd.mount import MountConfig, believed
from tagalong.perception.rgbd.noise import DepthNoise, depth_noise
from tagalong.perception.rgbd.planes import PlaneConfig, PlaneFinder, Surface
from tagalong.perception.rgbd.reduction import reduced_frame
from tagalong.slam import InputError

CAMERA = Pinhole(width=128, height=106, horizontal_fov=np.radians(70.0), vertical_fov=np.radians(60.0))
TABLE = (1.2, -0.5, 0.7, 2.2, 0.5, 0.74)


def turned(pitch, roll):
    p, r = np.radians((pitch, roll))
    cp, sp, cr, sr = np.cos(p), np.sin(p), np.cos(r), np.sin(r)
    return np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])


def room(pitch=0.0, roll=0.0, height=1.0, told=None, boxes=(), camera=CAMERA, time_s=0.0, floor=True):
    """A frame in a room 6 m long and 4 m wide without a ceiling, and which pixels truly show the floor."""
    rays = camera.rays @ turned(pitch, roll).T
    with np.errstate(divide="ignore", invalid="ignore"):
        ground = (
            np.where(rays[..., 2] < 0, -height / rays[..., 2], np.inf) if floor else np.full(rays.shape[:2], np.inf)
        )
        depths = [
            ground,
            np.minimum(np.where(rays[..., 0] > 0, 6.0 / rays[..., 0], np.inf), 2.0 / np.abs(rays[..., 1])),
        ]
        for box in boxes:
            low, high = np.array(box[:3]) - (0, 0, height), np.array(box[3:]) - (0, 0, height)
            near = np.minimum(low / rays, high / rays).max(axis=-1)
            far = np.maximum(low / rays, high / rays).min(axis=-1)
            depths.append(np.where((near < far) & (near > 0), near, np.inf))
    depth = np.min(depths, axis=0)
    noise = DepthNoise().sigma(depth) * np.random.default_rng(0).standard_normal(depth.shape)
    frame = RgbdFrame((depth + noise).astype(np.float32), grey(camera), camera, time_s, camera_height=told)
    return frame, np.argmin(depths, axis=0) == 0


@pytest.mark.parametrize("told", [None, "right", "5 cm low"])
@pytest.mark.parametrize(
    ("height", "pitch", "roll"),
    [(0.3, 0.0, 0.0), (0.62, 20.0, 10.0), (1.0, -8.0, 3.0), (1.3, 15.0, -20.0), (1.8, 45.0, 5.0)],
)
def test_tilt_and_height_are_told_by_the_floor_whatever_is_told_of_them(height, pitch, roll, told):
    frame, truth = room(pitch, roll, height, {None: None, "right": height, "5 cm low": height - 0.05}[told])
    planes = PlaneFinder().find(frame)
    assert planes.mount.floor_seen
    assert planes.mount.known
    assert np.degrees(planes.tilt) == pytest.approx((pitch, roll), abs=0.5)
    assert planes.mount.height == pytest.approx(height, abs=0.02)
    near = truth & (frame.depth < 5.0)
    assert (planes.surface[near] == Surface.FLOOR).mean() > 0.95
    assert (truth | (frame.depth > 5.0))[planes.surface == Surface.FLOOR].mean() > 0.98
    assert Surface.TOP not in planes.kinds


def test_a_table_is_a_top_over_the_floor_though_nothing_is_told_of_the_camera():
    frame, truth = room(20.0, 0.0, 1.3, boxes=[TABLE])
    planes = PlaneFinder().find(frame)
    assert planes.mount.height == pytest.approx(1.3, abs=0.02)
    assert (planes.surface[truth & (frame.depth < 5.0)] == Surface.FLOOR).mean() > 0.95
    top = ~truth & (np.abs(planes.points[..., 2] - 0.74) < 0.02) & (planes.points[..., 0] < 2.2)
    assert (planes.surface[top] == Surface.TOP).mean() > 0.9


def test_a_table_that_fills_most_of_the_picture_is_no_floor():
    frame, _ = room(25.0, 0.0, 1.2, boxes=[(0.3, -0.7, 0.7, 1.6, 0.7, 0.74)])
    planes = PlaneFinder().find(frame)
    assert planes.mount.height == pytest.approx(1.2, abs=0.03)


def test_where_there_is_no_floor_none_is_found_and_nothing_is_known_unless_it_is_told():
    frame, _ = room(floor=False)
    mount = PlaneFinder().find(frame).mount
    assert not mount.floor_seen
    assert not mount.known
    told = RgbdFrame(frame.depth, frame.colour, CAMERA, camera_height=1.0, tilt=(0.1, 0.0))
    mount = PlaneFinder().find(told).mount
    assert mount.known
    assert (mount.pitch, mount.height) == (0.1, 1.0)


def test_what_the_last_frame_told_holds_where_this_one_shows_no_floor_and_fades():
    finder = PlaneFinder()
    first = finder.find(room(20.0, 5.0, 1.3)[0]).mount
    blind = [room(20.0, 5.0, 1.3, floor=False, time_s=t)[0] for t in (0.5, 9.0, 30.0)]
    soon, late, never = (finder.find(frame, first).mount for frame in blind)
    assert (soon.pitch, soon.roll, soon.height) == (first.pitch, first.roll, first.height)
    assert not soon.floor_seen
    assert soon.known
    assert not late.known
    assert np.all(np.diag(late.covariance) > np.diag(soon.covariance))
    assert never.pitch == 0.0
    again = finder.find(room(22.0, 5.0, 1.3, time_s=0.5)[0], first).mount
    assert np.degrees(again.pitch) == pytest.approx(22.0, abs=0.5)


def test_what_is_told_is_believed_again_when_what_was_seen_has_faded():
    seen = PlaneFinder().find(room(20.0, 0.0, 1.0, told=1.0)[0]).mount
    told = RgbdFrame(np.full((106, 128), 2.0, np.float32), grey(CAMERA), CAMERA, 8.0, tilt=(0.35, 0.0))
    assert believed(told, MountConfig(), seen).pitch == 0.35


@pytest.mark.parametrize("columns", [80, 160, 320, 640, 1280])
def test_the_floor_is_the_same_at_any_resolution(columns):
    camera = Pinhole(
        width=columns, height=columns * 3 // 4, horizontal_fov=np.radians(60.0), vertical_fov=np.radians(46.8)
    )
    frame, _ = room(18.0, 4.0, 1.2, camera=camera)
    planes = PlaneFinder().find(frame)
    assert np.degrees(planes.tilt) == pytest.approx((18.0, 4.0), abs=0.5)
    assert planes.mount.height == pytest.approx(1.2, abs=0.02)
    assert planes.surface.shape[1] <= 213
    assert planes.surface.shape[1] * planes.step <= columns


def test_a_reduced_frame_has_the_same_rays_and_no_depth_between_two_surfaces():
    camera = Pinhole.from_intrinsics((640, 480), (525.0, 520.0), (300.0, 260.0))
    depth = np.full((480, 640), 1.0, np.float32)
    depth[:, 333:] = 3.0
    depth[100:200, 100:200] = np.nan
    small, step = reduced_frame(RgbdFrame(depth, grey(camera), camera))
    assert step == 5
    assert small.depth.shape == (96, 128)
    assert small.camera.rays == pytest.approx(camera.rays[2::5, 2::5])
    assert set(np.unique(small.depth[np.isfinite(small.depth)])) == {1.0, 3.0}
    assert np.isnan(small.depth[20:40, 20:40]).all()
    odd, _ = reduced_frame(
        RgbdFrame(
            depth[:, :320], grey(camera)[:, :320], Pinhole.from_intrinsics((320, 480), (260.0, 260.0), (160.0, 240.0))
        )
    )
    assert odd.depth.shape == (240, 160)


def test_an_axis_that_is_not_in_the_middle_and_distortion_are_taken_into_account():
    plain = Pinhole.from_intrinsics((320, 240), (260.0, 262.0), (150.0, 110.0))
    assert plain.rays[110, 150] == pytest.approx((1.0, 0.0, 0.0))
    assert plain.rays[110, 160] == pytest.approx((1.0, -10.0 / 260.0, 0.0))
    assert plain.rays[120, 150] == pytest.approx((1.0, 0.0, -10.0 / 262.0))
    bent = Pinhole.from_intrinsics((320, 240), (260.0, 262.0), (150.0, 110.0), (-0.3, 0.1, 0.001, -0.002, 0.01))
    x, y = -bent.rays[..., 1], -bent.rays[..., 2]
    r2 = x * x + y * y
    radial = 1.0 - 0.3 * r2 + 0.1 * r2**2 + 0.01 * r2**3
    column = 150.0 + 260.0 * (x * radial + 2.0 * 0.001 * x * y - 0.002 * (r2 + 2.0 * x * x))
    row = 110.0 + 262.0 * (y * radial + 0.001 * (r2 + 2.0 * y * y) - 2.0 * 0.002 * x * y)
    assert column == pytest.approx(np.broadcast_to(np.arange(320.0), (240, 320)), abs=0.01)
    assert row == pytest.approx(np.broadcast_to(np.arange(240.0)[:, None], (240, 320)), abs=0.01)


def test_whole_numbers_are_millimetres_and_floats_that_can_be_nothing_else_are_refused():
    frame, _ = room()
    whole = RgbdFrame((1000.0 * frame.depth).astype(np.uint16), frame.colour, CAMERA)
    assert whole.depth == pytest.approx(frame.depth, abs=1e-3)
    with pytest.raises(InputError, match="divide millimetres by 1000"):
        RgbdFrame(1000.0 * frame.depth, frame.colour, CAMERA)
    with pytest.raises(InputError, match="whole numbers or metres as floats, got bool"):
        RgbdFrame(frame.depth > 1.0, frame.colour, CAMERA)


def test_heights_and_tilts_that_are_no_numbers_are_refused():
    frame, _ = room()
    with pytest.raises(InputError, match="camera_height"):
        RgbdFrame(frame.depth, frame.colour, CAMERA, camera_height=np.nan)
    with pytest.raises(InputError, match="tilt"):
        RgbdFrame(frame.depth, frame.colour, CAMERA, tilt=(np.nan, 0.0))
    with pytest.raises(InputError, match="fx"):
        Pinhole.from_intrinsics((320, 240), (0.0, 262.0), (150.0, 110.0))
    with pytest.raises(InputError, match="lowest"):
        MountConfig(lowest=2.0, highest=1.0)
    with pytest.raises(InputError, match="depth sensors: stereo, structured-light, time-of-flight"):
        depth_noise("sonar")


def test_noise_limits_how_far_depths_tell_something():
    assert DepthNoise(constant=0.0, quadratic=0.0014).depth_of(0.056) == pytest.approx(6.32, abs=0.01)
    assert depth_noise("stereo").depth_of(0.06) < depth_noise("structured-light").depth_of(0.06)
    assert DepthNoise(constant=0.1).depth_of(0.05) == 0.0
    assert DepthNoise(quadratic=0.0).depth_of(0.05) == np.inf
    assert PlaneConfig(noise=depth_noise("stereo")).noise.sigma(2.0) == pytest.approx(0.014)
