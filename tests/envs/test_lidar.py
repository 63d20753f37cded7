"""The laser scanner against an independent ray cast."""

import numpy as np
import pytest
from tagalong.envs.sensors.lidar import LidarConfig
from tagalong.envs.world.world import World, WorldConfig
from tagalong.slam import InputError
from tagalong.slam.geometry import compose, transform_points

CLEAN = LidarConfig(sigma_near=0.0, sigma_far=0.0, dropout=0.0)


def make(seed=0, **options):
    return World(WorldConfig(**{"lidar": CLEAN, **options}), np.random.default_rng(seed))


def cast_in_plane(solids, origin, angles):
    """Ranges by clipping each ray against boxes and circles: slow, and nothing of MuJoCo in it."""
    rays = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    best = np.full(len(angles), np.inf)
    for solid in solids:
        offset = origin - np.array([solid.x, solid.y])
        if solid.is_round:
            b = rays @ offset
            root = b**2 - offset @ offset + solid.radius**2
            hit = np.where(root > 0.0, -b - np.sqrt(np.maximum(root, 0.0)), np.inf)
        else:
            cos, sin = np.cos(solid.yaw), np.sin(solid.yaw)
            turn = np.array([[cos, sin], [-sin, cos]])
            start, ray = turn @ offset, rays @ turn.T
            half = np.array([solid.half_length, solid.half_width])
            with np.errstate(divide="ignore", invalid="ignore"):
                one, two = (-half - start) / ray, (half - start) / ray
            entry, leave = np.minimum(one, two).max(axis=1), np.maximum(one, two).min(axis=1)
            hit = np.where(entry <= leave, entry, np.inf)
        best = np.minimum(best, np.where(hit > 0.0, hit, np.inf))
    return best


@pytest.mark.parametrize("scene", ["corridor", "meeting_room"])
def test_ranges_in_an_empty_building_are_those_of_a_plane_ray_cast(scene):
    world = make(2, scene=scene, people=0)
    laser = compose(world.truth.robot_pose, world.config.lidar.mount)
    solids = [solid for solid in world.scene.solids if solid.at_height(0.2)]
    expected = cast_in_plane(solids, laser[:2], laser[2] + world.config.lidar.bearings)
    expected = np.where(expected > 30.0, np.inf, expected)
    assert world.scan().ranges == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("scene", ["office", "lab", "landmarks"])
@pytest.mark.parametrize(("beams", "fov"), [(91, 3.0), (360, 2.0 * np.pi)])
def test_the_kernel_gives_the_bytes_of_mujocos_rays(scene, beams, fov):
    world = make(1, scene=scene, people=3, lidar=LidarConfig(beams=beams, field_of_view=fov, mount=(0.1, 0.0, 0.3)))
    lidar, rng = world._lidar, np.random.default_rng(0)
    assert lidar._plain
    for _ in range(30):
        world.step([0.6, 0.4])
        pose = world.truth.robot_pose + rng.uniform(-3.0, 3.0, 3)
        ranges, labels = lidar.cast(world.data, pose)
        lidar._plain = False
        reference, reference_labels = lidar.cast(world.data, pose)
        lidar._plain = True
        assert ranges.tobytes() == reference.tobytes()
        assert labels.tobytes() == reference_labels.tobytes()


def test_every_person_near_is_seen_as_two_legs():
    world = make(5, people=2)
    seen = []
    for _ in range(40):
        world.step([0.6, 0.0])
        truth, scan, labels = world.truth, world.scan(), world.scan_labels()
        points = transform_points(truth.robot_pose, scan.beam_points + np.array(scan.T_robot_lidar[:2]))
        on_leader = points[labels == 0]
        legs = truth.people.legs[0]
        nearest = np.hypot(*(on_leader[:, None] - legs[None]).transpose(2, 0, 1))
        assert nearest.min(axis=1).max() < 0.09
        seen.append((nearest.argmin(axis=1) == 0).any() and (nearest.argmin(axis=1) == 1).any())
    assert np.mean(seen) > 0.7


def test_labels_tell_legs_from_walls():
    world = make(5, people=3)
    truth, labels = world.truth, world.scan_labels()
    assert set(np.unique(labels)) <= {-1, 0, 1, 2}
    points = transform_points(truth.robot_pose, world.scan().beam_points + np.array([0.1, 0.0]))
    static = points[(labels == -1) & np.isfinite(points[:, 0])]
    assert world.scene.clearance(static).max() < 1e-6


def test_noise_has_the_size_of_the_data_sheet_and_some_beams_fail():
    noisy = make(2, people=0, lidar=LidarConfig())
    exact = make(2, people=0).scan().ranges
    errors, failed = [], []
    for _ in range(100):
        noisy.step([0.0, 0.0])
        with np.errstate(invalid="ignore"):
            errors.append(noisy.scan().ranges - exact)
        failed.append(np.isnan(noisy.scan().ranges))
    errors = np.array(errors)[10:]
    with np.errstate(invalid="ignore"):
        near, far = exact < 9.0, (exact > 11.0) & (exact < 25.0)
    assert np.nanmedian(np.nanstd(errors[:, near], axis=0)) == pytest.approx(0.01, rel=0.1)
    assert np.nanmedian(np.nanstd(errors[:, far], axis=0)) == pytest.approx(0.03, rel=0.1)
    assert np.mean(failed) == pytest.approx(0.002, rel=0.3)


def test_nothing_within_the_range_is_no_return():
    world = make(1, people=0, lidar=LidarConfig(range_max=5.0, sigma_near=0.0, dropout=0.0))
    scan = world.scan()
    assert scan.is_no_return.any()
    assert np.isinf(scan.ranges[scan.is_no_return]).all()
    assert scan.ranges[scan.is_return].max() <= 5.0


def test_a_faster_laser_gives_several_scans_a_control_step_and_a_slower_one_keeps_the_last():
    fast = make(0, people=1, lidar=LidarConfig(rate_hz=40.0, beams=31))
    fast.step([0.2, 0.0])
    assert [scan.time_s for scan in fast.scans] == pytest.approx([0.025, 0.05, 0.075, 0.1])
    slow = make(0, people=1, control_hz=20.0, lidar=LidarConfig(rate_hz=10.0, beams=31))
    slow.step([0.2, 0.0])
    assert slow.scan().time_s == 0.0
    slow.step([0.2, 0.0])
    assert slow.scan().time_s == pytest.approx(0.1)


def test_impossible_lasers_are_errors():
    with pytest.raises(InputError, match="beams"):
        LidarConfig(beams=1)
    with pytest.raises(InputError, match="height"):
        LidarConfig(height=1.0)
    with pytest.raises(InputError, match="multiple"):
        WorldConfig(lidar=LidarConfig(rate_hz=11.0))
