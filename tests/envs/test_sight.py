"""What the environment's mind makes of the camera: people who never move are tracked and kept out of the scans."""

import copy

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.episode_setup import OnboardStackFactory
from tagalong.envs.follow_config import make_config
from tagalong.envs.onboard.camera_pipeline import SIGHT_DELAY_S, NoCamera, RgbdPipeline
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.envs.world.config import WorldConfig
from tagalong.envs.world.world import World
from tagalong.perception.immobile import CameraViewMaker
from tagalong.perception.rgbd import RgbdFrame, RgbdPeople
from tagalong.slam import InputError
from tagalong.slam.geometry import compose, inverse, transform_points

AHEAD = np.array([[2.0, 0.5]])


class SomebodyAhead:
    """A finder of people that sees one at the same place before the robot in every frame."""

    def find(self, frame, planes):
        return RgbdPeople(AHEAD, np.array([0.9]), np.full(frame.depth.shape, -1, dtype=np.int32))


def frame_at(time_s):
    camera = RgbdConfig(width=32, height=27)
    shape = camera.height, camera.width
    depth, colour = np.full(shape, 3.0, dtype=np.float32), np.zeros((*shape, 3), dtype=np.uint8)
    return RgbdFrame(depth, colour, camera.pinhole, time_s, camera.mount, camera.camera_height)


def test_a_sighting_comes_late_and_lies_where_the_robot_was_at_the_exposure():
    sight = RgbdPipeline(CameraViewMaker(SomebodyAhead()))
    poses = {0.1 * k: np.array([0.2 * k, 0.0, 0.1 * k]) for k in range(6)}
    known = []
    for time_s, pose in poses.items():
        known += [(time_s, sighting) for sighting in sight.update(time_s, pose)]
        if time_s == 0.1:
            sight.look((frame_at(0.0), frame_at(time_s)))  # only the latest counts
            sight.look((frame_at(time_s),))  # and only once
    ((when, sighting),) = known
    assert when == pytest.approx(0.1 + SIGHT_DELAY_S)
    assert sighting.people.time_s == sighting.view.time_s == 0.1
    np.testing.assert_allclose(sighting.people.positions, transform_points(poses[0.1], AHEAD))


def test_without_a_camera_nothing_is_seen():
    sight = NoCamera()
    sight.look(())
    assert sight.update(0.0, np.zeros(3)) == ()


def watched(world, seconds=3.0, **given):
    """The mind's last belief after standing still in the lab before people who stand still."""
    config = make_config({"scene": "lab", "leader": False, "slam": None, **given})
    mind = OnboardStackFactory(config).make(world, np.random.default_rng(0))
    believed = mind.update(world.scan(), world.odometry)
    mind.look(world.frames)
    while world.time_s < seconds:
        world.step(np.zeros(2))
        believed = mind.update(world.scan(), world.odometry)
        mind.look(world.frames)
    return believed


def lab_with_a_camera(seed):
    """A lab; two of its people never move, and some stand in the camera's sight at the start."""
    config = WorldConfig(
        scene="lab", route="operator", people=0, leader=False, camera=RgbdConfig(mount=(0.0, 0.0, 0.0))
    )
    return World(config, np.random.default_rng(seed))


def is_near(place, tracks):
    return bool((np.hypot(*(tracks - place).T) < 0.3).any())


def test_somebody_who_never_moves_is_tracked_and_kept_out_of_the_scan_by_the_camera():
    world = lab_with_a_camera(6)
    state = world.save_state()
    seen, beams = {}, {}
    for name, given in {
        "laser": {},
        "camera": {"camera": "kinect-v2", "people": "camera"},
        "both": {"camera": "kinect-v2"},
    }.items():
        world.restore_state(copy.deepcopy(state))
        believed = watched(world, **given)
        truth, labels = world.truth, world.scan_labels()
        tracks = transform_points(compose(truth.robot_pose, inverse(believed.odometry)), believed.people.positions)
        seen[name] = [k for k, place in enumerate(truth.people.positions) if is_near(place, tracks)]
        theirs = np.isin(labels, seen[name]) & believed.scan.is_return
        beams[name] = (np.count_nonzero(theirs & believed.filtered.is_return), np.count_nonzero(theirs))
    assert set(seen["laser"]) < set(seen["both"])
    assert set(seen["camera"]) <= set(seen["both"])
    assert seen["camera"] != []
    for name in ("camera", "both"):
        kept, of = beams[name]
        assert of > 5
        assert kept == 0


def test_the_environment_gives_its_tracker_what_the_camera_saw():
    tracked = {}
    for name, camera in {"laser": None, "both": "kinect-v2"}.items():
        env = gym.make("tagalong/Lab-v0", camera=camera, leader=False, people_count=0, slam=None)
        env.reset(seed=6, options={"route": "operator"})
        for _ in range(20):
            *_, info = env.step(np.zeros(2))
        tracked[name] = info["tracked_people"]
    assert tracked["laser"] < tracked["both"]


def test_people_by_the_camera_alone_need_a_camera():
    with pytest.raises(InputError, match="camera"):
        make_config({"people": "camera"})
