"""The benchmark of SLAM among people, on a drive of a few seconds."""

import json
import shutil
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.benchmarks import slam_among_people
from tagalong.scripts.cli import main
from tagalong.slam import LaserScan, RecordedDrive

BEARINGS = np.radians(np.arange(-135.0, 135.5, 0.5))


def hall(pose, feet, time_s):
    """A scan of a hall of 8 x 6 m from `pose`, with feet in it."""
    angles = pose[2] + BEARINGS
    cos, sin = np.cos(angles), np.sin(angles)
    along_x = np.where(cos > 0.0, 8.0 - pose[0], -pose[0]) / np.where(np.abs(cos) > 1e-9, cos, 1e-9)
    along_y = np.where(sin > 0.0, 6.0 - pose[1], -pose[1]) / np.where(np.abs(sin) > 1e-9, sin, 1e-9)
    ranges = np.minimum(np.abs(along_x), np.abs(along_y))
    for x, y in feet - pose[:2]:
        ahead, aside = x * cos + y * sin, -x * sin + y * cos
        hit = (np.abs(aside) < 0.06) & (ahead > 0.0)
        ranges[hit] = np.minimum(ranges[hit], ahead[hit] - np.sqrt(0.06**2 - aside[hit] ** 2))
    return LaserScan(ranges, BEARINGS, 0.05, 20.0, time_s=time_s)


def short_drive():
    """Three seconds behind somebody who walks through the hall, with true odometry."""
    times = 0.1 * np.arange(30)
    truth = np.stack((2.0 + 0.5 * times, np.full(30, 3.0), np.zeros(30)), axis=-1)
    feet = np.stack([np.array([[3.5 + 0.5 * t, 2.9], [3.7 + 0.5 * t, 3.1]]) for t in times])
    scans = [hall(*each) for each in zip(truth, feet, times, strict=True)]
    return slam_among_people.SimulatedDrive(RecordedDrive(truth - truth[0], scans, truth, "hall-1p-s0"), truth, feet)


@pytest.fixture
def simulated(monkeypatch):
    monkeypatch.setattr(slam_among_people, "following_tour", lambda config: SimpleNamespace(drive=short_drive()))


def test_people_leave_ghosts_on_a_raw_map_and_none_on_one_without_them(simulated, tmp_path, capsys):
    words = ["bench", "slam-among-people", "--scenes", "corridor", "--seeds", "0", "--engines", "cartographer"]
    assert main([*words, "--filters", "raw", "true", "--out", str(tmp_path / "out")]) == 0
    raw, true = json.loads((tmp_path / "out" / "results.json").read_text())["drives"]
    assert raw["ate_cm"] < 5.0
    assert raw["ghost_cells"] > true["ghost_cells"] == 0
    assert raw["false_cm"] > true["false_cm"]
    assert "mean of 1" in capsys.readouterr().out
    assert "SLAM among people, 20" in (tmp_path / "out" / "report.md").read_text()


def test_trajectories_of_others_are_judged_on_the_logs_that_were_written(simulated, tmp_path):
    pytest.importorskip("rosbags")
    words = ["bench", "slam-among-people", "--engines", "--out"]
    assert main([*words, str(tmp_path / "first"), "--scenes", "corridor", "--seeds", "0"]) == 0
    logs, others = tmp_path / "first" / "logs", tmp_path / "others" / "hall-1p-s0"
    assert sorted(path.suffix for path in logs.iterdir()) == [".bag", ".gz", ".npz", ".tum"]
    others.mkdir(parents=True)
    shutil.copy(logs / "hall-1p-s0.gt.tum", others / "oracle.tum")
    words += [str(tmp_path / "second"), "--logs", str(logs), "--others", str(tmp_path / "others")]
    assert main(words) == 0
    (row,) = json.loads((tmp_path / "second" / "results.json").read_text())["drives"]
    assert (row["engine"], row["scans"]) == ("others/oracle", "raw")
    assert row["ate_cm"] == pytest.approx(0.0, abs=1e-3)
    assert row["missing_cm"] < 1.0


def test_a_trajectory_with_too_few_poses_is_named(simulated, tmp_path, capsys):
    words = ["bench", "slam-among-people", "--engines", "--out"]
    assert main([*words, str(tmp_path / "a"), "--scenes", "corridor", "--seeds", "0"]) == 0
    logs, others = tmp_path / "a" / "logs", tmp_path / "others" / "hall-1p-s0"
    others.mkdir(parents=True)
    lines = (logs / "hall-1p-s0.gt.tum").read_text().splitlines()
    (others / "short.tum").write_text("\n".join(lines[:5]) + "\n")
    capsys.readouterr()
    assert main([*words, str(tmp_path / "b"), "--logs", str(logs), "--others", str(tmp_path / "others")]) == 2
    assert "short.tum: one pose a scan needed, got 5 for 30 scans" in capsys.readouterr().err
