"""`mapping="immobile"`: the robot's map of what never moves, on the poses of any engine."""

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.sensors.camera.config import RgbdConfig
from tagalong.slam.errors import InputError

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
