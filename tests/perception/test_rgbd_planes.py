"""Clouds, normals, planes and clusters on rooms whose planes are known."""

import numpy as np
import pytest
from cloud_rgbd_reference import surface_normals_reference
from clusters_rgbd_reference import connect_reference
from growing_rgbd_reference import settle_reference
from tagalong.perception.rgbd.cloud import cloud, surface_normals
from tagalong.perception.rgbd.clusters import ClusterConfig, connect, find_clusters
from tagalong.perception.rgbd.frame import Pinhole, RgbdFrame
from tagalong.perception.rgbd.growing import settle
from tagalong.perception.rgbd.planes import PlaneConfig, PlaneFinder, Surface
from tagalong.slam import InputError

CAMERA = Pinhole(width=128, height=106, horizontal_fov=np.radians(70.0), vertical_fov=np.radians(60.0))
HEIGHT, CEILING, AHEAD, SIDE = 1.0, 2.6, 5.0, 2.0


def turned(pitch=0.0, roll=0.0):
    cp, sp, cr, sr = np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    return np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])


def room(pitch=0.0, roll=0.0, noise=0.0, boxes=()):
    """A frame in a room with walls ahead and to both sides, and what truly is at each pixel.

    0 floor, 1 ceiling, 2 wall, 3 + i box i of (x, y, z low, x, y, z high).
    """
    rays = CAMERA.rays @ turned(pitch, roll).T
    with np.errstate(divide="ignore"):
        candidates = [
            np.where(rays[..., 2] < 0, -HEIGHT / rays[..., 2], np.inf),
            np.where(rays[..., 2] > 0, (CEILING - HEIGHT) / rays[..., 2], np.inf),
            np.minimum(np.where(rays[..., 0] > 0, AHEAD / rays[..., 0], np.inf), SIDE / np.abs(rays[..., 1])),
        ]
        for box in boxes:
            low, high = np.array(box[:3]) - (0, 0, HEIGHT), np.array(box[3:]) - (0, 0, HEIGHT)
            near = np.minimum(low / rays, high / rays).max(axis=-1)
            far = np.maximum(low / rays, high / rays).min(axis=-1)
            candidates.append(np.where((near < far) & (near > 0), near, np.inf))
    truth = np.argmin(candidates, axis=0)
    depth = np.min(candidates, axis=0)
    depth = depth + noise * (0.0015 + 0.0003 * depth**2) * np.random.default_rng(0).standard_normal(depth.shape)
    frame = RgbdFrame(depth.astype(np.float32), np.zeros((106, 128, 3), np.uint8), CAMERA, 0.0, camera_height=HEIGHT)
    return frame, truth


def normals_of(frame, kernel=surface_normals):
    points = cloud(frame)
    normals, flatness = np.empty_like(points), np.empty(points.shape[:2])
    kernel(points, 1.0 / np.array(CAMERA.focal), normals, flatness)
    return normals, flatness


def test_the_cloud_is_where_the_walls_are():
    frame, truth = room()
    points = cloud(frame)
    assert points[truth == 0][:, 2] == pytest.approx(-HEIGHT, abs=1e-5)
    assert points[truth == 1][:, 2] == pytest.approx(CEILING - HEIGHT, abs=1e-5)
    x, y = points[truth == 2][:, :2].T
    assert np.minimum(np.abs(x - AHEAD), np.abs(np.abs(y) - SIDE)).max() < 1e-5


def test_normals_look_to_the_camera_and_are_exact_on_planes():
    frame, truth = room()
    normals, flatness = normals_of(frame)
    inner = flatness < 1e-6
    assert inner.mean() > 0.7
    assert normals[inner & (truth == 0)][:, 2].min() > 1.0 - 1e-6
    assert normals[inner & (truth == 1)][:, 2].max() < 1e-6 - 1.0
    points = cloud(frame)
    assert (normals[inner] * points[inner]).sum(axis=1).max() < 0.0


def test_the_kernel_of_normals_does_what_its_reference_does():
    frame, _ = room(noise=1.0)
    depth = frame.depth[30:60, 40:80].copy()
    depth[5:9, 7:20] = np.nan
    part = Pinhole(width=40, height=30, horizontal_fov=0.5, vertical_fov=0.4)
    points = part.rays * depth[..., None].astype(float)
    results = []
    for kernel in (surface_normals, surface_normals_reference):
        normals, flatness = np.empty_like(points), np.empty(points.shape[:2])
        kernel(points, 1.0 / np.array(part.focal), normals, flatness)
        results.append((normals, flatness))
    np.testing.assert_allclose(results[0][0], results[1][0], atol=1e-9)
    np.testing.assert_allclose(results[0][1], results[1][1], atol=1e-7)


def test_the_kernel_that_settles_pixels_does_what_its_reference_does():
    frame, truth = room(noise=1.0)
    points = cloud(frame)
    points[20:25, 30:60] = np.nan
    planes = np.array([[0, 0, 1, -HEIGHT], [0, 0, -1, HEIGHT - CEILING], [-1, 0, 0, -AHEAD], [0, 1, 0, -SIDE]], float)
    region = np.where(truth == 2, 2, truth).astype(np.int32)
    region[np.random.default_rng(1).random(region.shape) < 0.9] = -1  # few neighbours, so that each one matters
    first, second = np.empty_like(region), np.empty_like(region)
    settle(points, planes, region, 2, first)
    settle_reference(points, planes, region, 2, second)
    assert np.array_equal(first, second)


def test_floor_ceiling_and_walls_of_an_empty_room_are_right_everywhere():
    frame, truth = room(noise=1.0)
    planes = PlaneFinder().find(frame)
    for number, surface in enumerate((Surface.FLOOR, Surface.CEILING, Surface.WALL)):
        assert (planes.surface[truth == number] == surface).mean() > 0.98
    assert planes.tilt_known
    assert set(planes.kinds) == {Surface.FLOOR, Surface.CEILING, Surface.WALL}


@pytest.mark.parametrize(("pitch", "roll"), [(3.0, 0.0), (-3.0, 0.0), (0.0, 3.0), (2.0, -2.5), (0.0, 0.0)])
def test_tilt_is_measured_and_corrected_to_a_tenth_of_a_degree(pitch, roll):
    frame, truth = room(np.radians(pitch), np.radians(roll), noise=1.0)
    planes = PlaneFinder().find(frame)
    assert np.degrees(planes.tilt) == pytest.approx([pitch, roll], abs=0.1)
    ceiling = planes.points[truth == 1]
    slope = np.linalg.lstsq(np.column_stack((ceiling[:, :2], np.ones(len(ceiling)))), ceiling[:, 2], rcond=None)[0]
    assert np.degrees(np.hypot(*slope[:2])) < 0.1
    x, y, _ = planes.points[truth == 2].T
    assert np.quantile(np.minimum(np.abs(x - AHEAD), np.abs(np.abs(y) - SIDE)), 0.9) < 0.02
    assert (planes.surface[truth == 0] == Surface.FLOOR).mean() > 0.97


def test_a_table_top_is_a_top_and_a_low_screen_is_a_face_and_neither_is_a_wall():
    frame, truth = room(noise=1.0, boxes=[(2.0, -0.6, 0.69, 3.2, 0.6, 0.72), (3.5, -1.5, 0.0, 3.55, -0.8, 1.3)])
    planes = PlaneFinder().find(frame)
    top = (truth == 3) & (np.abs(planes.points[..., 2] - 0.72) < 0.02)
    assert top.sum() > 100
    assert (planes.surface[top] == Surface.TOP).mean() > 0.85
    assert (planes.surface[truth == 4] == Surface.FACE).mean() > 0.9
    assert (planes.surface[truth == 2] == Surface.WALL).mean() > 0.95


def test_a_desk_far_away_is_a_top_though_its_depth_runs_off_with_each_row():
    frame, truth = room(noise=1.0, boxes=[(2.2, -0.8, 0.69, 3.0, 0.8, 0.72)])
    planes = PlaneFinder().find(frame)
    top = (truth == 3) & (np.abs(planes.points[..., 2] - 0.72) < 0.02)
    assert 60 < top.sum() < 400
    assert (planes.surface[top] == Surface.TOP).mean() > 0.8


def test_a_wall_goes_on_behind_what_stands_before_it_and_one_without_a_ceiling_in_sight_is_less_sure():
    frame, truth = room(noise=1.0, boxes=[(4.0, -1.99, 1.3, 4.1, 1.99, 1.5)])
    planes = PlaneFinder().find(frame)
    below = (truth == 2) & (planes.points[..., 2] < 1.0) & (planes.points[..., 0] > 4.8)
    assert (planes.surface[below] == Surface.WALL).mean() > 0.95
    near = RgbdFrame(np.full((106, 128), 1.5, np.float32), frame.colour, CAMERA, 0.0, camera_height=HEIGHT)
    alone = PlaneFinder().find(near)
    assert (alone.surface == Surface.WALL).mean() > 0.98
    assert alone.likelihood[alone.kinds == Surface.WALL].max() < 1.0
    assert not alone.tilt_known


def test_a_frame_without_measurements_has_no_planes_and_no_clusters():
    empty = RgbdFrame(np.full((106, 128), np.nan, np.float32), np.zeros((106, 128, 3), np.uint8), CAMERA, 0.0)
    planes = PlaneFinder().find(empty)
    assert len(planes.kinds) == 0
    assert (planes.surface == Surface.NOTHING).all()
    assert len(find_clusters(planes)) == 0


@pytest.mark.parametrize("written", [0.0, -1.0, np.inf])
def test_what_cameras_write_for_no_measurement_is_none(written):
    depth = room()[0].depth.copy()
    depth[40:60, 30:90] = np.nan
    theirs = np.where(np.isnan(depth), np.float32(written), depth)
    kept = theirs.copy()
    known, taken = (
        RgbdFrame(d, np.zeros((106, 128, 3), np.uint8), CAMERA, 0.0, camera_height=HEIGHT) for d in (depth, theirs)
    )
    np.testing.assert_array_equal(taken.depth, known.depth)
    assert taken.depth.dtype == np.float32
    np.testing.assert_array_equal(theirs, kept)
    np.testing.assert_array_equal(PlaneFinder().find(taken).surface, PlaneFinder().find(known).surface)


def test_clusters_are_the_things_in_the_room():
    frame, truth = room(noise=1.0, boxes=[(2.0, -1.0, 0.0, 2.3, -0.6, 1.3), (3.0, 0.5, 0.0, 3.1, 1.1, 1.4)])
    clusters = find_clusters(PlaneFinder().find(frame))
    assert len(clusters) == 2
    for number in range(2):
        mine = np.bincount(truth[clusters.label == number], minlength=5)
        assert mine.argmax() in (3, 4)
        assert mine.max() / mine.sum() > 0.95
    assert np.all(clusters.low <= clusters.centres)
    assert np.all(clusters.centres <= clusters.high)
    assert clusters.count[0] >= clusters.count[1]


def test_the_kernel_of_clusters_does_what_its_reference_does():
    rng = np.random.default_rng(1)
    points = rng.uniform(0.0, 0.4, (14, 16, 3))
    chosen = rng.random((14, 16)) < 0.6
    first, second = np.empty((14, 16), np.int32), np.empty((14, 16), np.int32)
    assert connect(points, chosen, 0.2, 0.0, 2, first) == connect_reference(points, chosen, 0.2, 2, second)
    assert np.array_equal(first, second)


def test_impossible_settings_are_errors():
    with pytest.raises(InputError, match="turn"):
        PlaneConfig(turn=0.0)
    with pytest.raises(InputError, match="reach"):
        ClusterConfig(reach=0)
    with pytest.raises(InputError, match="shapes"):
        RgbdFrame(np.zeros((3, 3), np.float32), np.zeros((106, 128, 3), np.uint8), CAMERA, 0.0)
