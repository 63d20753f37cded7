"""Recordings of rerun hold what was written, by rerun's own reader; its reader of MCAP finds ours whole."""

import subprocess
import sys

import numpy as np
import pytest
from tagalong.slam import InputError, LaserScan, OccupancyMap
from tagalong.slam.logs import open_recording

TIMES = (0.0, 0.1, 0.2)
FULL = """
import resource, sys
import numpy as np
from tagalong.slam import InputError
from tagalong.slam.logs import open_recording

recording = open_recording(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))
recording.picture(0.0, np.zeros((500, 500, 3), dtype=np.uint8), "/camera/image")
try:
    recording.close()
except InputError as error:
    print(error)
"""


def scan_at(time_s):
    return LaserScan(np.array([1.0, 2.0, np.inf]), np.array([-0.1, 0.0, 0.1]), 0.1, 10.0, time_s, (0.2, 0.0, 0.0))


def write(path):
    with open_recording(path) as recording:
        for time_s in TIMES:
            recording.scan(scan_at(time_s))
            recording.odometry(time_s, (time_s, 0.0, 0.0))
            recording.people(time_s, [(1.0, 2.0)], [7], leader=7)
        recording.map(0.2, OccupancyMap(np.array([[0.0, 1.0]], dtype=np.float32), 0.1, (0.0, 0.0)))
        recording.way(0.2, np.zeros((2, 3)))
        recording.pose(0.2, (0.0, 0.0, 0.0), "/truth/pose", "world")
        recording.picture(0.2, np.zeros((2, 4, 3), dtype=np.uint8), "/camera/image")
        recording.command(0.2, (0.5, 0.0, 0.1))
        recording.number(0.2, 1.25, "/reward")
    return path


def test_what_was_recorded_is_read_back_by_rerun(tmp_path):
    reader = pytest.importorskip("rerun.chunk")
    found = {}
    for chunk in reader.RrdReader(write(tmp_path / "drive.rrd")).stream():
        columns = chunk.to_record_batch().to_pydict()
        found.setdefault(chunk.entity_path, {}).update(columns)
    scans = found["/map/odom/base_link/laser/scan"]["Points3D:positions"]
    assert len(scans) == len(TIMES)
    assert np.allclose(scans[0], [(np.cos(0.1), -np.sin(0.1), 0.0), (2.0, 0.0, 0.0)])
    assert np.allclose(found["/map/odom/people"]["Ellipsoids3D:centers"][0][0][:2], (1.0, 2.0))
    assert np.allclose(found["/map/map"]["Points3D:positions"][0], [(0.15, 0.05, 0.0)])
    assert found["/reward"]["Scalars:scalars"][0] == [1.25]
    assert {"/camera/image", "/map/path", "/world/truth/pose", "/cmd_vel/turn"} <= set(found)


@pytest.mark.skipif(sys.platform == "win32", reason="limits of files")
def test_a_disk_that_is_full_is_told_and_not_waited_for(tmp_path):
    pytest.importorskip("rerun")
    words = [sys.executable, "-c", FULL, "drive.rrd"]
    answer = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (answer.stdout, answer.stderr) == ("drive.rrd: cannot be written (File too large)\n", "")
    assert list(tmp_path.iterdir()) == []


def test_what_is_larger_than_a_pipe_arrives_whole_and_what_is_given_up_leaves_nothing(tmp_path):
    reader = pytest.importorskip("rerun.chunk")
    pixels = np.random.default_rng(0).integers(0, 256, (1500, 2000, 3), dtype=np.uint8)
    for name, keep in (("whole.rrd", True), ("gone.rrd", False)):
        recording = open_recording(tmp_path / name)
        recording.picture(0.0, pixels, "/camera/image")
        recording.close(keep=keep)
    assert [path.name for path in tmp_path.iterdir()] == ["whole.rrd"]
    held = [chunk.to_record_batch().to_pydict() for chunk in reader.RrdReader(tmp_path / "whole.rrd").stream()]
    buffers = [columns["Image:buffer"] for columns in held if "Image:buffer" in columns]
    assert bytes(np.asarray(buffers[0][0][0], dtype=np.uint8)) == pixels.tobytes()


def test_reruns_reader_of_mcap_finds_every_message(tmp_path):
    reader, rosbag2 = pytest.importorskip("rerun.chunk"), pytest.importorskip("rosbags.rosbag2")
    path = write(tmp_path / "drive.mcap")
    rows = {}
    for chunk in reader.McapReader(path).stream():
        names = chunk.to_record_batch().schema.names
        if not chunk.is_static and not any(name.startswith("Mcap") for name in names):
            rows[chunk.entity_path] = max(rows.get(chunk.entity_path, 0), chunk.num_rows)
    with rosbag2.Reader(path) as whole:
        counts = {each.topic: each.msgcount for each in whole.connections if each.topic != "/tf_static"}
    assert {topic: rows.get(topic) for topic in counts} == counts


def test_another_ending_is_refused_in_one_line(tmp_path):
    with pytest.raises(InputError, match=r"is called FILE\.mcap \(ROS 2, Foxglove\) or FILE\.rrd \(rerun\)"):
        open_recording(tmp_path / "drive.bag")
