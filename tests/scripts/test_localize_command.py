"""`tagalong localize` on a synthetic building, and what it says of bad input."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tagalong.scripts import cli
from tagalong.slam import LaserScan, RecordedDrive, write_ros_map
from tagalong.slam.geometry import between, compose
from tagalong.slam.grid import GridConfig, render_map
from tagalong.slam.logs import read_carmen, read_tum, write_carmen

BEARINGS = np.radians(np.arange(-90.0, 90.0))
CORNERS = np.array(
    [(-3.0, -2.0), (4.0, -2.0), (4.0, 0.5), (2.0, 0.5), (2.0, 3.0), (-1.0, 3.0), (-1.0, 1.0), (-3.0, 1.0)]
)


def cast(pose, time_s=0.0, corners=CORNERS):
    angles = BEARINGS + pose[2]
    d = np.stack((np.cos(angles), np.sin(angles)), axis=-1)[:, None]
    a, e = corners[None] - pose[:2], (np.roll(corners, -1, axis=0) - corners)[None]
    cross = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
    t = (a[..., 0] * e[..., 1] - a[..., 1] * e[..., 0]) / cross
    u = (a[..., 0] * d[..., 1] - a[..., 1] * d[..., 0]) / cross
    ranges = np.where((t > 0.0) & (u >= 0.0) & (u <= 1.0), t, np.inf).min(axis=1)
    return LaserScan(ranges, BEARINGS, 0.0, 20.0, time_s)


@pytest.fixture(scope="module")
def building(tmp_path_factory):
    folder = tmp_path_factory.mktemp("building")
    places = np.array(
        [[x, y, h] for x, y in ((-2.0, -0.5), (0.5, 0.0), (3.0, -1.0), (0.5, 2.0)) for h in (0.1, 2.2, -2.0)]
    )
    write_ros_map(folder / "map", render_map(places, [cast(p) for p in places], GridConfig(resolution=0.05)))
    truth = [np.array([-2.0, -0.8, 0.1])]
    for _ in range(29):
        truth.append(compose(truth[-1], (0.1, 0.0, 0.01)))
    scans = [cast(pose, 0.1 * k) for k, pose in enumerate(truth)]
    odometry = between(truth[0], np.array(truth))
    write_carmen(folder / "drive.log", RecordedDrive(odometry, scans, None, "drive"))
    return folder, np.array(truth)


def test_a_drive_is_found_on_a_map_and_written_out(building, tmp_path, capsys):
    folder, truth = building
    words = ["localize", str(folder / "drive.log"), "--map", str(folder / "map.yaml"), "--quiet", "--out"]
    for name in ("a", "b"):
        assert cli.main([*words, str(tmp_path / name)]) == 0
    assert "first sure scan" in capsys.readouterr().out
    written = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert written == ["map.png", "metrics.json", "smoothed.tum", "timing.json", "trajectory.tum"]
    metrics = json.loads((tmp_path / "a" / "metrics.json").read_text())
    assert metrics["sure_share"] > 0.9
    assert metrics["lost"] == 0
    first = metrics["first_sure_scan"]
    error = between(truth[first:], read_tum(tmp_path / "a" / "trajectory.tum").poses)
    assert np.hypot(error[:, 0], error[:, 1]).max() < 0.06
    smoothed = between(truth, read_tum(tmp_path / "a" / "smoothed.tum").poses)
    assert np.hypot(smoothed[:, 0], smoothed[:, 1]).max() < 0.1
    for name in written:
        if name != "timing.json":
            assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_of_the_whole_drive_only_what_was_on_the_map_is_written(building, tmp_path):
    folder, truth = building
    hall = np.array([(-1.0, -8.0), (1.5, -8.0), (1.5, 2.0), (0.5, 2.0), (1.5, 3.5), (1.5, 9.0), (-1.0, 9.0)])
    away = [compose(np.array((0.2, -5.0, 1.5)), (0.25 * k, 0.0, 0.0)) for k in range(40)]
    steps = between(truth[0], truth)
    odometry = [*steps, *(compose(steps[-1], (0.25 * k, 0.0, 0.0)) for k in range(1, 41))]
    scans = [cast(pose, 0.1 * k) for k, pose in enumerate(truth)]
    scans += [cast(pose, 0.1 * k, hall) for k, pose in enumerate(away, 30)]
    write_carmen(tmp_path / "drive.log", RecordedDrive(np.array(odometry), scans, None, "taken away"))
    words = ["localize", str(tmp_path / "drive.log"), "--map", str(folder / "map.yaml"), "--quiet", "--out"]
    assert cli.main([*words, str(tmp_path / "out")]) == 0
    smoothed = read_tum(tmp_path / "out" / "smoothed.tum")
    assert 29 <= len(smoothed.poses) < 45
    assert np.hypot(*(smoothed.poses[:29] - truth[:29])[:, :2].T).max() < 0.1
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert metrics["whole_drive_share"] == len(smoothed.poses) / 70


def test_a_start_may_be_given(building, tmp_path):
    folder, _ = building
    words = ["localize", str(folder / "drive.log"), "--map", str(folder / "map.yaml"), "--quiet"]
    assert cli.main([*words, "--out", str(tmp_path), "--start", "-1.9", "-0.7", "8"]) == 0
    assert json.loads((tmp_path / "metrics.json").read_text())["first_sure_scan"] == 0


def test_grossly_wrong_odometry_is_said_once_in_one_line(building, tmp_path, capsys):
    folder, _ = building
    right = read_carmen(folder / "drive.log")
    write_carmen(tmp_path / "wrong.log", replace(right, odometry=right.odometry * [2.0, 2.0, 1.0]))
    for log, wrong in ((folder / "drive.log", False), (tmp_path / "wrong.log", True)):
        words = ["localize", str(log), "--map", str(folder / "map.yaml"), "--quiet", "--out", str(tmp_path / "out")]
        assert cli.main(words) == 0
        said = capsys.readouterr().err
        assert said.count("grossly wrong") == said.count("\n") == int(wrong)
        assert ("2.0" in said) == wrong


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"--map": "nowhere.yaml"}, "nowhere.yaml: cannot be read"),
        ({"--map": "cut.yaml"}, "cut.pgm: the image is cut"),
        ({"--map": "empty.yaml"}, "empty.yaml: a map to localize on needs walls"),
        ({"log": "nowhere.log"}, "nowhere.log: cannot be read"),
        ({"log": "cut.log"}, "cut.log, line 4: ROBOTLASER1"),
    ],
)
def test_bad_input_is_one_line_and_status_2(building, tmp_path, capsys, change, complaint):
    folder, _ = building
    yaml, image = (folder / "map.yaml").read_text(), (folder / "map.pgm").read_bytes()
    (folder / "cut.yaml").write_text(yaml.replace("map.pgm", "cut.pgm"))
    (folder / "cut.pgm").write_bytes(image[:1000])
    (folder / "empty.yaml").write_text(yaml.replace("map.pgm", "empty.pgm"))
    (folder / "empty.pgm").write_bytes(image[:-100].replace(b"\x00", b"\xcd") + image[-100:])
    (folder / "cut.log").write_text("\n".join((folder / "drive.log").read_text().splitlines()[:4])[:-200])
    log, plan = folder / change.get("log", "drive.log"), folder / change.get("--map", "map.yaml")
    assert cli.main(["localize", str(log), "--map", str(plan), "--quiet", "--out", str(tmp_path)]) == 2
    message = capsys.readouterr().err
    assert complaint in message
    assert message.count("\n") == 1
