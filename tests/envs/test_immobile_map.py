"""`mapping="immobile"`: the robot's map of what never moves, on the poses of any engine."""

from types import SimpleNamespace

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.onboard.immobile_map import ImmobileDrawing
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.slam import InputError, LaserScan
from tagalong.slam.geometry import between

SMALL = {"beams": 541, "people_count": 0, "leader": False}
CAMERA = RgbdConfig(width=64, height=53, rate_hz=5.0)


def maps_after(steps, **options):
    """The map observations and the own map after turning on the spot in the lab."""
    env = gym.make("tagalong/Lab-v0", **{**SMALL, **options})
    observation, _ = env.reset(seed=1)
    for _ in range(steps):
        observation, *_ = env.step(np.array([0.0, 0.3]))
    assert env.observation_space.contains(observation)
    return observation["map"], env.unwrapped.own_map().map, env


def test_the_camera_puts_more_into_the_map_than_the_laser_and_people_not():
    occupied, known = {}, {}
    for name, options in {
        "occupancy": {"mapping": "occupancy"},
        "laser": {"mapping": "immobile"},
        "camera": {"mapping": "immobile", "camera": CAMERA},
    }.items():
        _, grid, _ = maps_after(60, slam="truth", people="truth", **options)
        occupied[name], known[name] = int(grid.occupied.sum()), int(grid.known.sum())
    assert occupied["camera"] > 1.2 * occupied["laser"] > 0
    assert known["camera"] > known["laser"]


def test_it_works_on_the_poses_of_an_engine_with_found_people():
    patch, grid, _ = maps_after(12, slam="gmapping", people="tracker", mapping="immobile", camera=CAMERA)
    assert grid.occupied.sum() > 100
    assert 0.0 <= patch.min() < patch.max() <= 1.0


def test_a_snapshot_goes_on_with_the_same_bytes():
    _, _, env = maps_after(4, slam="truth", people="truth", mapping="immobile", camera=CAMERA)
    env = env.unwrapped
    state = env.save_state()
    runs = []
    for _ in range(2):
        env.restore_state(state)
        for _ in range(6):
            observation, *_ = env.step(np.array([0.1, 0.2]))
        runs.append((observation["map"].tobytes(), env.own_map().map.probability.tobytes()))
    assert runs[0] == runs[1]


def test_wrong_choices_are_errors():
    with pytest.raises(InputError, match="immobile, occupancy"):
        gym.make("tagalong/Lab-v0", mapping="magic")
    with pytest.raises(InputError, match="slam"):
        gym.make("tagalong/Lab-v0", mapping="immobile", slam=None)


def test_slam_by_the_immobile_map_alone_stays_near_the_truth():
    env = gym.make("tagalong/Lab-v0", **SMALL, slam="immobile", mapping="immobile", ends_on_contact=False)
    env.reset(seed=2)
    start = env.unwrapped.truth.robot_pose
    for _ in range(60):
        *_, info = env.step([0.2, 0.3])
    error = between(between(start, info["robot_pose"]), info["map_pose"])
    assert np.hypot(*error[:2]) < 0.05
    assert env.unwrapped.own_map().map.occupied.sum() > 100


def test_it_needs_that_map():
    with pytest.raises(InputError, match="mapping"):
        gym.make("tagalong/Lab-v0", slam="immobile")


class Reviser:
    """A mapper that comes to believe that the robot started 1 m farther to the left."""

    pose, path = np.zeros(3), np.zeros((0, 3))

    def revised(self):
        return self.path


def test_a_map_whose_scans_were_elsewhere_is_drawn_anew():
    bearings = np.linspace(-1.0, 1.0, 201)
    mapper, drawing = Reviser(), ImmobileDrawing(0.2, redrawable=True)
    for k in range(24):
        scan = LaserScan(4.02 / np.cos(bearings), bearings, 0.1, 20.0, time_s=0.1 * k + 0.1)
        if k == 16:
            mapper.pose = np.array([0.0, 1.0, 0.0])
        mapper.path = np.tile(mapper.pose, (k + 1, 1))
        grid = drawing.update(mapper, SimpleNamespace(scan=scan, removed=np.zeros(201, dtype=bool)), [])
    walls = grid.occupied_points
    assert np.abs(walls[:, 0] - 4.0).max() < 0.15
    assert walls[:, 1].min() > 1.0 - 4.02 * np.tan(1.0) - 0.1  # nothing is left where the robot was thought to be
