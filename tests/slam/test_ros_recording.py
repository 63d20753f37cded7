"""Recordings for ROS 2 say what was written, to three readers."""

import numpy as np
import pytest
from tagalong.slam import InputError, LaserScan, OccupancyMap, read_log
from tagalong.slam.logs import RosRecording, open_recording

rosbags = pytest.importorskip("rosbags.highlevel")
TIMES = np.arange(5) * 0.1
MOUNT = (0.2, -0.05, 0.1)


def scan_at(k):
    bearings = np.linspace(-2.0, 2.0, 181)
    ranges = 3.0 + 0.5 * np.sin(bearings * 3 + k)
    ranges[:5], ranges[5:9] = np.inf, np.nan
    return LaserScan(ranges, bearings, 0.1, 10.0, TIMES[k], MOUNT)


def odometry_at(k):
    return np.array([0.1 * k, -0.02 * k, 0.3 * k])


GRID = OccupancyMap(np.array([[0.0, 1.0, np.nan], [0.25, 0.5, 0.75]], dtype=np.float32), 0.05, (-1.0, 2.0))


@pytest.fixture
def recorded(tmp_path):
    """A drive of five scans, with people, a map, a way, pictures and numbers."""
    with RosRecording(tmp_path / "drive.mcap") as recording:
        for k, time_s in enumerate(TIMES):
            recording.scan(scan_at(k))
            recording.odometry(time_s, odometry_at(k), (0.5, 0.0, 0.1))
            recording.people(time_s, [(1.0, k), (2.0, 0.5)], [7, 9], leader=9)
        recording.map(0.4, GRID)
        recording.way(0.4, np.array([odometry_at(k) for k in range(5)]))
        recording.picture(0.4, np.arange(24, dtype=np.uint8).reshape(2, 4, 3), "/camera/image")
        recording.picture(0.4, np.array([[1.5, np.nan]], dtype=np.float32), "/camera/depth")
        recording.command(0.4, (0.5, 0.0, -0.2))
        recording.number(0.4, 1.25, "/reward")
    return tmp_path / "drive.mcap"


def messages(path, topic):
    with rosbags.AnyReader([path]) as reader:
        wanted = [each for each in reader.connections if each.topic == topic]
        return [reader.deserialize(raw, each.msgtype) for each, _, raw in reader.messages(wanted)]


def test_a_drive_that_was_recorded_is_read_back_as_it_was(recorded):
    drive = read_log(recorded)
    assert len(drive) == 5
    for k, scan in enumerate(drive.scans):
        assert scan.ranges == pytest.approx(scan_at(k).ranges, abs=1e-6, nan_ok=True)
        assert scan.bearings == pytest.approx(scan_at(k).bearings, abs=1e-6)
        assert scan.T_robot_lidar == pytest.approx(MOUNT, abs=1e-9)
        assert scan.time_s == pytest.approx(TIMES[k], abs=1e-9)
    assert drive.odometry == pytest.approx(np.array([odometry_at(k) for k in range(5)]), abs=1e-9)


def test_a_map_is_read_back_in_percent_with_unknown_cells(recorded):
    (grid,) = messages(recorded, "/map")
    assert grid.data.tolist() == [0, 100, -1, 25, 50, 75]
    assert (grid.info.width, grid.info.height, grid.info.resolution) == (3, 2, pytest.approx(0.05))
    assert (grid.info.origin.position.x, grid.info.origin.position.y) == (-1.0, 2.0)


def test_people_are_markers_and_the_leader_has_another_colour(recorded):
    last = messages(recorded, "/people")[-1].markers
    assert [marker.action for marker in last] == [3, 0, 0]
    assert [marker.id for marker in last[1:]] == [7, 9]
    assert (last[1].pose.position.x, last[1].pose.position.y) == (1.0, 4.0)
    assert last[1].color.r != last[2].color.r


def test_pictures_ways_commands_and_numbers_are_read_back(recorded):
    (colour,), (depth,) = messages(recorded, "/camera/image"), messages(recorded, "/camera/depth")
    assert (colour.encoding, colour.data.tolist()) == ("rgb8", list(range(24)))
    assert np.array_equal(depth.data.view("<f4"), [1.5, np.nan], equal_nan=True)
    (path,) = messages(recorded, "/path")
    assert [pose.pose.position.x for pose in path.poses] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4])
    assert messages(recorded, "/cmd_vel")[0].angular.z == -0.2
    assert messages(recorded, "/reward")[0].data == 1.25


def test_the_library_of_the_format_reads_the_same_messages(recorded):
    reader = pytest.importorskip("mcap.reader")
    with recorded.open("rb") as file:
        found = [(channel.topic, schema.name, message.log_time) for schema, channel, message in
                 reader.make_reader(file).iter_messages()]  # fmt: skip
    with rosbags.AnyReader([recorded]) as other:
        assert sorted(found) == sorted((each.topic, each.msgtype, time_ns) for each, time_ns, _ in other.messages())


def test_the_same_calls_give_the_same_bytes(tmp_path):
    for name in ("a", "b"):
        with RosRecording(tmp_path / f"{name}.mcap") as recording:
            recording.scan(scan_at(0))
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()


def test_a_recording_that_fails_leaves_nothing(tmp_path):
    with RosRecording(tmp_path / "drive.mcap") as recording:
        recording.scan(scan_at(0))
        recording.close(keep=False)
    assert list(tmp_path.iterdir()) == []


def test_what_ros_cannot_say_is_told_in_one_line(tmp_path):
    blind = LaserScan(np.zeros(0), np.zeros(0), 0.1, 10.0)
    with RosRecording(tmp_path / "drive.mcap") as recording:
        with pytest.raises(InputError, match="needs beams"):
            recording.scan(blind)
        with pytest.raises(InputError, match=r"time for ROS must be within 0 .. 2147483648 s, got -1"):
            recording.scan(scan_at(0), time_s=-1.0)
    with pytest.raises(InputError, match=r"a recording for ROS 2 is called FILE\.mcap"):
        RosRecording(tmp_path / "drive.bag")


@pytest.mark.parametrize(("ending", "library"), [(".mcap", "rosbags"), (".rrd", "rerun")])
def test_poses_and_people_that_are_nowhere_are_refused_by_both_kinds(tmp_path, ending, library):
    pytest.importorskip(library)
    path = tmp_path / f"a{ending}"
    with pytest.raises(InputError, match="`pose` must be a finite pose"), open_recording(path) as one:
        one.odometry(0.0, [])
    with pytest.raises(InputError, match="positions of people"), open_recording(path) as one:
        one.people(0.0, [[np.nan, 1e308]])
    with pytest.raises(InputError, match="a number for each of the 1 people"), open_recording(path) as one:
        one.people(0.0, [[1.0, 2.0]], ids=[1, 2])
    assert list(tmp_path.iterdir()) == []
