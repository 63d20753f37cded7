"""`--record` of commands that drive or map."""

import numpy as np
import pytest
from tagalong.scripts.cli import main
from tagalong.slam import LaserScan, RecordedDrive, read_log
from tagalong.slam.logs import write_carmen

rosbags = pytest.importorskip("rosbags.highlevel")


def topics(path):
    with rosbags.AnyReader([path]) as reader:
        return {each.topic: each.msgcount for each in reader.connections}


def times(path, topic):
    with rosbags.AnyReader([path]) as reader:
        wanted = [each for each in reader.connections if each.topic == topic]
        return np.array([time_ns for _, time_ns, _ in reader.messages(wanted)]) * 1e-9


@pytest.mark.parametrize("people", ["tracker"])
def test_two_episodes_follow_each_other_in_one_recording(tmp_path, people):
    path = tmp_path / "episodes.mcap"
    words = ["evaluate", "pid", "--episodes", "2", "--beams", "181", "--perception", people]
    short = ["--set", "lost_limit_s=0.5", "--set", "scene=plain_corridor"]
    assert main([*words, *short, "--record", str(path)]) == 0
    counts, stamps = topics(path), times(path, "/scan")
    assert counts["/scan"] == counts["/scan_filtered"] == counts["/odom"] == counts["/people"] == counts["/reward"]
    assert (np.diff(stamps) > 0.0).all()
    assert sum(np.diff(stamps) > 0.5) == 1  # a second between the two
    assert len(read_log(path, scan_topic="/scan")) == counts["/scan"]


def test_a_mapped_drive_is_recorded_with_its_map(tmp_path):
    bearings = np.linspace(-1.5, 1.5, 181)
    odometry = np.stack((np.arange(8) * 0.1, np.zeros(8), np.zeros(8)), axis=-1)
    scans = [LaserScan(np.full(181, 3.0), bearings, 0.1, 30.0, 0.1 * k) for k in range(8)]
    write_carmen(tmp_path / "drive.log.gz", RecordedDrive(odometry, scans, None, "drive"))
    path = tmp_path / "drive.mcap"
    words = ["slam", str(tmp_path / "drive.log.gz"), "--out", str(tmp_path / "out"), "--quiet", "--filter-people"]
    assert main([*words, "--record", str(path)]) == 0
    assert topics(path) == {"/tf_static": 1, "/scan": 8, "/odom": 8, "/tf": 16, "/people": 8, "/path": 1, "/map": 1}


def test_people_in_recorded_scans_are_recorded(tmp_path, capsys):
    bearings = np.linspace(-1.5, 1.5, 181)
    scans = [LaserScan(np.full(181, 3.0), bearings, 0.1, 30.0, 100.0 + 0.1 * k) for k in range(4)]
    write_carmen(tmp_path / "drive.log.gz", RecordedDrive(np.zeros((4, 3)), scans, None, "drive"))
    path = tmp_path / "people.mcap"
    assert (
        main(["perceive", str(tmp_path / "drive.log.gz"), "--out", str(tmp_path / "out"), "--record", str(path)]) == 0
    )
    assert capsys.readouterr().out.endswith(f"people.csv, {path}\n")
    assert topics(path) == {"/tf_static": 1, "/scan": 4, "/scan_filtered": 4, "/odom": 4, "/tf": 4, "/people": 4}
    assert times(path, "/scan")[0] == 0.0


def test_a_recording_that_cannot_be_written_is_told_before_the_work(tmp_path, capsys):
    words = ["evaluate", "pid", "--episodes", "1", "--record"]
    assert main([*words, str(tmp_path / "a.bag")]) == 2
    assert "a recording is called FILE.mcap" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main([*words, str(tmp_path / "file" / "a.mcap")]) == 2
    assert "cannot be written" in capsys.readouterr().err
