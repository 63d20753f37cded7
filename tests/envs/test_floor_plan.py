"""Any ROS map as a building."""

import os
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
import tagalong  # noqa: F401 (registers the ids)
from tagalong.envs.scenes.catalogue import make_scene
from tagalong.envs.scenes.occupancy import true_map
from tagalong.envs.scenes.request import SceneRequest
from tagalong.slam import InputError, OccupancyMap, write_ros_map
from tagalong.slam.logs import read_carmen

DATA = os.environ.get("TAGALONG_DATA")


def plan(path, seed=0):
    return make_scene("floor_plan", np.random.default_rng(seed), request=SceneRequest(floor_plan=str(path)))


def write(folder, probability, resolution=0.05):
    write_ros_map(folder / "map.yaml", OccupancyMap(probability.astype(np.float32), resolution, (-3.0, 2.0)))
    return folder / "map.yaml"


def hall(rows=200, cols=400):
    """A hall of 10 x 20 m with walls."""
    probability = np.zeros((rows, cols))
    probability[:4] = probability[-4:] = 1.0
    probability[:, :4] = probability[:, -4:] = 1.0
    return probability


def test_the_map_of_a_building_is_that_building_again(tmp_path):
    office = make_scene("office", np.random.default_rng(4))
    before = true_map(office)
    write_ros_map(tmp_path / "map.yaml", before)
    after = true_map(plan(tmp_path / "map.yaml"))
    gap = np.hypot(*(after.occupied_points[:, None] - before.occupied_points[None]).transpose(2, 0, 1))
    assert gap.min(axis=1).max() < 0.12
    assert gap.min(axis=0).max() < 0.12


def test_the_building_is_the_maps_and_the_tours_are_the_seeds():
    first, second = (make_scene("floor_plan", np.random.default_rng(seed)) for seed in (0, 1))
    assert first.solids == second.solids
    assert not np.array_equal(first.routes["tour"], second.routes["tour"])


@pytest.mark.parametrize("seed", [373, 583, 709])
def test_where_the_ends_that_were_drawn_lie_together_others_are_drawn(seed):
    scene = make_scene("floor_plan", np.random.default_rng(seed), request=SceneRequest())
    assert np.hypot(*np.diff(scene.routes["tour"], axis=0).T).sum() > 14.0


def test_a_map_that_was_written_anew_is_read_anew(tmp_path):
    path = write(tmp_path, hall())
    assert len(plan(path).solids) == 4
    changed = hall()
    changed[100:110, 200:210] = 1.0
    write(tmp_path, changed)
    os.utime(path, ns=(0, 0))
    assert len(plan(path).solids) == 5


def test_specks_of_free_space_are_left_out(tmp_path):
    probability = np.pad(hall(), 60, constant_values=np.nan)
    probability[5:8, 5:8] = 0.0
    scene = plan(write(tmp_path, probability))
    assert scene.bounds == pytest.approx((0.0, 5.0, 20.0, 15.0))


def test_what_is_wrong_with_a_map_is_said(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        plan(tmp_path / "none.yaml")
    with pytest.raises(InputError, match="no free cell"):
        plan(write(tmp_path, np.ones((20, 20))))
    with pytest.raises(InputError, match=r"0\.2 m at most, got 0\.5 m"):
        plan(write(tmp_path, hall(), resolution=0.5))
    with pytest.raises(InputError, match="next to its free ones"):
        plan(write(tmp_path, np.zeros((300, 300))))
    with pytest.raises(InputError, match="no tour of 14 m or more"):
        plan(write(tmp_path, hall(40, 60)))


def test_an_environment_takes_the_file(tmp_path):
    path = write(tmp_path, hall())
    env = gym.make("tagalong/FloorPlan-v0", floor_plan=str(path), slam=None, beams=61, people_count=3)
    env.reset(seed=0)
    assert len(env.unwrapped.world.scene.solids) == 4
    _, _, _, _, info = env.step(np.zeros(2))
    assert info["ending"] == ""


@pytest.mark.skipif(DATA is None, reason="needs TAGALONG_DATA with recorded logs")
def test_a_map_of_a_recorded_log_becomes_a_building(tmp_path):
    from tagalong.slam.growing_map import GrowingMap

    drive = read_carmen(Path(DATA or "") / "slam_logs" / "intel.gfs.log.gz")
    growing = GrowingMap()
    for pose, scan in list(zip(drive.odometry, drive.scans, strict=True))[:1200:4]:
        growing.write(scan, pose)
    write_ros_map(tmp_path / "map.yaml", growing.map)
    scene = plan(tmp_path / "map.yaml")
    assert len(scene.solids) > 100
    assert scene.tour_length > 14.0
