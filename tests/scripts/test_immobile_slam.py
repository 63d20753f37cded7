"""`tagalong data record` and `tagalong slam --mapping immobile`: laser and camera of one bag on one map."""

import json

import numpy as np
import pytest
from tagalong.envs import Operator, RgbdConfig
from tagalong.perception.immobile import ImmobileSlam
from tagalong.perception.rgbd import read_bag_frames
from tagalong.scripts.cli import main
from tagalong.scripts.reproduce.immobile.drives import lab_world
from tagalong.slam import InputError, make_slam, read_log, read_ros_map
from tagalong.slam.scan import LaserScan

pytest.importorskip("rosbags")
PITCH = 15.0


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    path = tmp_path_factory.mktemp("lab") / "lab.mcap"
    words = ["data", "record", str(path), "--seed", "3", "--minutes", "0.1", "--camera-hz", "2", "--pitch", str(PITCH)]
    assert main(words) == 0
    return path


def test_what_was_measured_is_read_back_equal(lab):
    world = lab_world(3, RgbdConfig(rate_hz=2.0, pitch=float(np.radians(PITCH))))
    operator, scans, odometry, frames = Operator(world.scene), [world.scan()], [world.odometry], list(world.frames)
    while world.time_s < 6.0:
        world.step(operator.command(world.truth))
        scans.append(world.scan())
        odometry.append(world.odometry)
        frames += [frame for frame in world.frames if frame.time_s > (frames[-1].time_s if frames else -1.0)]
    drive, seen = read_log(lab), [each.frame for each in read_bag_frames(lab)]
    assert len(drive) == len(scans)
    for scan, told in zip(scans, drive.scans, strict=True):
        np.testing.assert_array_equal(told.is_return, scan.is_return)
        expected = scan.ranges[scan.is_return].astype(np.float32)
        np.testing.assert_array_equal(told.ranges[told.is_return], expected)
    np.testing.assert_allclose(drive.odometry, odometry, atol=1e-9)
    assert len(seen) == len(frames) > 10
    for frame, told in zip(frames, seen, strict=True):
        np.testing.assert_array_equal(told.depth, frame.depth)
        np.testing.assert_array_equal(told.colour, frame.colour)
        np.testing.assert_allclose(told.camera.rays, frame.camera.rays, atol=1e-9)
        assert told.time_s == pytest.approx(frame.time_s, abs=1e-8)
        assert told.T_robot_camera == pytest.approx(frame.T_robot_camera, abs=1e-9)


@pytest.mark.parametrize("method", ["immobile", "gmapping"])
def test_a_bag_with_both_sensors_is_mapped_by_both(lab, tmp_path, method, capsys):
    words = ["slam", str(lab), "--mapping", "immobile", "--method", method, "--forest", "simulation", "--quiet"]
    assert main([*words, "--out", str(tmp_path)]) == 0
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    assert metrics["mapping"] == "immobile"
    assert metrics["views"] > 10
    assert metrics["against_reference"]["ate_m"]["rmse"] < 0.03
    assert "camera's views" in capsys.readouterr().out
    both = read_ros_map(tmp_path / "map.yaml")
    assert (tmp_path / "movable.yaml").exists()
    # by the laser alone there is less to see: no desk tops
    drive, alone = read_log(lab), ImmobileSlam()
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        alone.update(odometry, scan)
    assert both.occupied.sum() > 1.1 * alone.map().occupied.sum()


def test_a_map_is_drawn_anew_where_the_engine_learns_in_the_end_that_the_robot_was_elsewhere():
    class Late:
        """Says in the end that all was half a metre farther."""

        config, path, moved = None, np.zeros((0, 3)), 0.0

        def update(self, odometry, scan):
            self.path = np.concatenate((self.path, np.reshape(odometry, (1, 3))))
            return make_slam("gmapping").update(odometry, scan)

        def finish(self):
            self.moved = 0.5

        def trajectory(self):
            return self.path + np.array([self.moved, 0.0, 0.0])

    slam = ImmobileSlam(engine=Late())
    for number in range(20):
        slam.update(np.zeros(3), LaserScan(np.full(91, 2.0), np.linspace(-1, 1, 91), 0.1, 10.0, 0.1 * number))
    before = slam.map()
    slam.finish()
    after = slam.map()
    assert after.occupied.sum() == before.occupied.sum()
    _, cols = np.nonzero(before.occupied)
    x = before.origin[0] + (cols + 0.5) * before.resolution
    _, cols = np.nonzero(after.occupied)
    moved = after.origin[0] + (cols + 0.5) * after.resolution
    assert moved.mean() - x.mean() == pytest.approx(0.5, abs=0.03)


def test_times_that_stand_still_and_cells_of_another_size_are_refused():
    slam, scan = ImmobileSlam(), LaserScan(np.full(91, 2.0), np.linspace(-1, 1, 91), 0.1, 10.0, 1.0)
    slam.update(np.zeros(3), scan)
    with pytest.raises(InputError, match="increase"):
        slam.update(np.zeros(3), scan)
    with pytest.raises(InputError, match="cells of"):
        slam.map_at(0.2)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--method", "immobile"], "--mapping immobile"),
        (["--camera-height", "1"], "--mapping immobile"),
        (["--mapping", "immobile", "--filter-people"], "--filter-people"),
        (["--mapping", "immobile", "--camera-every", "nan"], "--camera-every"),
        (["--mapping", "immobile", "--camera-height", "nan"], "--camera-height"),
        (["--mapping", "immobile", "--laser-height", "9"], "laser_height"),
        (["--mapping", "immobile", "--method", "immobile", "--set", "particles=3"], "--set"),
    ],
)
def test_options_that_do_not_go_together_are_told_before_the_log_is_read(tmp_path, words, said, capsys):
    assert main(["slam", "no.log", "--out", str(tmp_path), *words]) == 2
    assert said in capsys.readouterr().err


def test_a_recording_that_cannot_be_written_is_told_before_the_drive(tmp_path, capsys):
    assert main(["data", "record", str(tmp_path / "lab.bag")]) == 2
    assert main(["data", "record", str(tmp_path / "lab.mcap"), "--minutes", "nan"]) == 2
    assert main(["data", "record", str(tmp_path / "lab.mcap"), "--pitch", "100"]) == 2
    assert capsys.readouterr().err.count("\n") == 3
