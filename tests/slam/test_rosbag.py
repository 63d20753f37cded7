"""Bags written by the library, read as drives."""

import bz2
import lzma
import os
import shutil
import sqlite3
import sys
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.cli import main
from tagalong.slam.drives.log import read_log
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between
from tagalong.slam.logs.bag_messages import as_defined, open_bag, unpacked_bz2
from tagalong.slam.logs.rosbag import read_rosbag
from tagalong.slam.scan_to_scan.laser_odometry import laser_odometry

rosbags = pytest.importorskip("rosbags")
from rosbags.rosbag1 import Writer as Writer1  # noqa: E402
from rosbags.rosbag2 import Writer as Writer2  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402
from rosbags.typesys.store import Typestore  # noqa: E402

LEGS = Path(os.environ.get("TAGALONG_DATA", "")) / "legs"
TIMES = 1000.0 + 0.1 * np.arange(12)
UPRIGHT, TURNED_OVER, ON_ITS_SIDE = (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0), (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))


class BagWriter:
    """Writes messages of a ROS 1 file or a ROS 2 folder."""

    def __init__(self, path, ros2=False):
        self.ros2, self.store = ros2, get_typestore(Stores.ROS2_HUMBLE if ros2 else Stores.ROS1_NOETIC)
        if not ros2:
            definition = "geometry_msgs/TransformStamped[] transforms"
            self.store.register(get_types_from_msg(definition, "tf2_msgs/msg/TFMessage"))
        self.writer = Writer2(path, version=9) if ros2 else Writer1(path)
        self.connections = {}

    def __enter__(self):
        self.writer.open()
        return self

    def __exit__(self, *_):
        self.writer.close()

    def of(self, kind, **fields):
        return self.store.types[kind](**fields)

    def header(self, frame, time):
        seconds = int(np.floor(time))
        stamp = self.of("builtin_interfaces/msg/Time", sec=seconds, nanosec=round((time - seconds) * 1e9))
        return self.of("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **({} if self.ros2 else {"seq": 0}))

    def write(self, topic, kind, time, message):
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        serialize = self.store.serialize_cdr if self.ros2 else self.store.serialize_ros1
        self.writer.write(self.connections[topic], round(time * 1e9), serialize(message, kind))

    def scan(self, time, ranges, topic="/scan", late=0.0, increment=0.1, **other):
        fields = {"angle_min": -increment * 2, "angle_max": increment * 2, "angle_increment": increment,
                  "time_increment": 0.0, "scan_time": 0.1, "range_min": 0.05, "range_max": 8.0, **other}  # fmt: skip
        message = self.of("sensor_msgs/msg/LaserScan", header=self.header("/laser", time), **fields,
                          ranges=np.array(ranges, np.float32), intensities=np.zeros(0, np.float32))  # fmt: skip
        self.write(topic, "sensor_msgs/msg/LaserScan", time + late, message)

    def echoes(self, time, echoes, topic="/horizontal_laser_2d"):
        beams = [self.of("sensor_msgs/msg/LaserEcho", echoes=np.array(beam, np.float32)) for beam in echoes]
        fields = {"angle_min": -0.2, "angle_max": 0.2, "angle_increment": 0.1, "time_increment": 0.0, "scan_time": 0.1,
                  "range_min": 0.05, "range_max": 8.0, "ranges": beams, "intensities": []}  # fmt: skip
        message = self.of("sensor_msgs/msg/MultiEchoLaserScan", header=self.header("/laser", time), **fields)
        self.write(topic, "sensor_msgs/msg/MultiEchoLaserScan", time, message)

    def pose(self, x, y, theta):
        return self.of(
            "geometry_msgs/msg/Pose",
            position=self.of("geometry_msgs/msg/Point", x=x, y=y, z=0.0),
            orientation=self.turn(0.0, 0.0, np.sin(theta / 2), np.cos(theta / 2)),
        )

    def turn(self, x, y, z, w):
        return self.of("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)

    def odometry(self, time, pose, topic="/odom"):
        nothing = self.of("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        twist = self.of("geometry_msgs/msg/Twist", linear=nothing, angular=nothing)
        message = self.of(
            "nav_msgs/msg/Odometry", header=self.header("odom", time), child_frame_id="base_link",
            pose=self.of("geometry_msgs/msg/PoseWithCovariance", pose=self.pose(*pose), covariance=np.zeros(36)),
            twist=self.of("geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=np.zeros(36)),
        )  # fmt: skip
        self.write(topic, "nav_msgs/msg/Odometry", time, message)

    def transform(self, time, parent, child, place, turn, topic="/tf"):
        x, y, z = place
        moved = self.of(
            "geometry_msgs/msg/Transform",
            translation=self.of("geometry_msgs/msg/Vector3", x=x, y=y, z=z), rotation=self.turn(*turn),
        )  # fmt: skip
        stamped = self.of("geometry_msgs/msg/TransformStamped", header=self.header(parent, time), child_frame_id=child,
                          transform=moved)  # fmt: skip
        self.write(topic, "tf2_msgs/msg/TFMessage", time, self.of("tf2_msgs/msg/TFMessage", transforms=[stamped]))


def moved(time):
    return (2.0 * (time - 1000.0), 0.5, 3.0 + 0.4 * (time - 1000.0))


def write_drive(path, ros2=False, by_tf=False, mounted=UPRIGHT, odometry_late=0.05):
    with BagWriter(path, ros2) as bag:
        bag.transform(1000.0, "base_link", "laser", (0.2, 0.1, 0.3), mounted, "/tf_static")
        for time in TIMES:
            for when in (time - odometry_late, time + odometry_late):
                x, y, theta = moved(when)
                if by_tf:
                    bag.transform(
                        when, "odom", "base_link", (x, y, 0.0), (0.0, 0.0, np.sin(theta / 2), np.cos(theta / 2))
                    )
                else:
                    bag.odometry(when, (x, y, theta))
            bag.scan(time, [1.0, 2.0, np.inf, 0.01, 9.0])
    return path


@pytest.mark.parametrize("ros2", [False, True])
@pytest.mark.parametrize("by_tf", [False, True])
def test_a_drive_comes_back_with_odometry_at_the_times_of_the_scans(tmp_path, ros2, by_tf):
    drive = read_log(write_drive(tmp_path / ("folder" if ros2 else "drive.bag"), ros2, by_tf))
    expected = np.array([moved(time) for time in TIMES])
    np.testing.assert_allclose(between(expected, drive.odometry), 0.0, atol=1e-6)
    np.testing.assert_allclose(drive.times_s, TIMES, atol=1e-6)
    assert drive.scans[0].T_robot_lidar == pytest.approx((0.2, 0.1, 0.0))
    assert drive.scans[0].is_return.tolist() == [True, True, False, False, False]
    assert drive.scans[0].is_no_return.tolist() == [False, False, True, False, True]
    assert drive.has_odometry
    assert drive.notes == ()


def test_a_laser_that_hangs_upside_down_has_its_beams_turned_over(tmp_path):
    upright = read_rosbag(write_drive(tmp_path / "a.bag")).scans[0]
    over = read_rosbag(write_drive(tmp_path / "b.bag", mounted=TURNED_OVER)).scans[0]
    np.testing.assert_allclose(over.points[::-1], upright.points * [1.0, -1.0], atol=1e-6)
    assert (np.diff(over.bearings) > 0.0).all()
    with pytest.raises(InputError, match="must stand level"):
        read_rosbag(write_drive(tmp_path / "c.bag", mounted=ON_ITS_SIDE))


def test_a_scan_topic_is_chosen_by_name_and_needed_where_there_are_two(tmp_path, capsys):
    with BagWriter(tmp_path / "two.bag") as bag:
        for time in TIMES:
            bag.scan(time, [1.0] * 5, "/front")
            bag.scan(time, [2.0] * 5, "/back")
    assert main(["slam", str(tmp_path / "two.bag"), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "several topics of type sensor_msgs/msg/LaserScan: /back, /front; choose by --scan-topic" in error
    assert error.count("\n") == 1
    assert read_rosbag(tmp_path / "two.bag", "back").scans[0].ranges[0] == 2.0
    with pytest.raises(InputError, match="no topic 'left'"):
        read_rosbag(tmp_path / "two.bag", "left")


@pytest.mark.parametrize("ros2", [False, True])
def test_of_several_echoes_of_a_beam_the_first_counts(tmp_path, ros2):
    path = tmp_path / ("folder" if ros2 else "drive.bag")
    with BagWriter(path, ros2) as bag:
        for time in TIMES:
            bag.echoes(time, [[1.0, 3.0], [2.0], [], [np.inf], [9.0, 9.5]])
    scan = read_log(path).scans[3]
    np.testing.assert_array_equal(scan.ranges, [1.0, 2.0, np.nan, np.inf, 9.0])
    assert scan.is_no_return.tolist() == [False, False, False, True, True]
    filtered = tmp_path / ("out" if ros2 else "out.bag")
    assert main(["filter", str(path), str(filtered), "--quiet"]) == 0
    with open_bag(filtered) as bag:
        assert bag.topics["/horizontal_laser_2d_filtered"] == "sensor_msgs/msg/LaserScan"
        out = [message.content for message in bag.messages("/horizontal_laser_2d_filtered")]
    np.testing.assert_array_equal(out[3].ranges, np.float32([1.0, 2.0, np.nan, np.inf, 9.0]))
    assert (out[3].angle_min, out[3].range_max) == pytest.approx((-0.2, 8.0))


def test_scans_before_all_odometry_are_left_out_and_told(tmp_path):
    with BagWriter(tmp_path / "late.bag") as bag:
        for time in TIMES:
            bag.scan(time, [1.0] * 5)
            if time > TIMES[4]:
                bag.odometry(time, moved(time))
    drive = read_rosbag(tmp_path / "late.bag")
    assert len(drive) == 9
    assert drive.notes[-1] == "3 scans left out: no odometry at their time"


def test_scans_in_a_gap_of_the_odometry_are_left_out_and_told(tmp_path):
    with BagWriter(tmp_path / "gap.bag") as bag:
        for time in TIMES:
            bag.scan(time, [1.0] * 5)
        for time in (TIMES[0] - 4.0, TIMES[0] + 0.15, TIMES[4], TIMES[4] + 1.0, TIMES[-1] + 3.0):
            bag.odometry(time, moved(time))
    drive = read_rosbag(tmp_path / "gap.bag")
    inside = [time for time in TIMES if TIMES[0] + 0.15 <= time <= TIMES[4] + 1.0]
    np.testing.assert_allclose(drive.times_s, inside, atol=1e-6)
    np.testing.assert_allclose(between(np.array([moved(t) for t in inside]), drive.odometry), 0.0, atol=1e-6)
    assert drive.notes[-1] == f"{len(TIMES) - len(inside)} scans left out: no odometry at their time"
    with BagWriter(tmp_path / "none.bag") as bag:
        for time in TIMES:
            bag.scan(time, [1.0] * 5)
        for time in (TIMES[0] - 4.0, TIMES[-1] + 4.0):
            bag.odometry(time, moved(time))
    with pytest.raises(InputError, match=r"no scan of /scan has odometry of /odom: .* poses 1\.0 s apart"):
        read_rosbag(tmp_path / "none.bag")


def test_headers_of_another_clock_give_way_to_the_times_of_the_recorder(tmp_path):
    with BagWriter(tmp_path / "clocks.bag") as bag:
        for time in TIMES:
            bag.odometry(time, moved(time))
            bag.scan(time + 130.0, [1.0] * 5, late=-130.0)
    drive = read_rosbag(tmp_path / "clocks.bag")
    np.testing.assert_allclose(between(np.array([moved(time) for time in TIMES]), drive.odometry), 0.0, atol=1e-6)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("cut.bag", b"#ROSBAG V2.0\nnonsense", "no readable ROS bag"),
        ("empty.bag", b"", "no readable ROS bag"),
        ("noise.bag", bytes(range(256)) * 40, "no readable ROS bag"),
    ],
)
@pytest.mark.parametrize("command", ["slam", "perceive"])
def test_broken_bags_end_with_one_line_and_status_two(tmp_path, capsys, name, content, words, command):
    (tmp_path / name).write_bytes(content)
    assert main([command, str(tmp_path / name), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1


def test_a_bag_cut_in_the_middle_is_named_with_what_restores_it(tmp_path):
    whole = write_drive(tmp_path / "whole.bag").read_bytes()
    (tmp_path / "cut.bag").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match=r"cut\.bag: no readable ROS bag .*`rosbag reindex` restores"):
        read_log(tmp_path / "cut.bag")


def test_a_folder_that_holds_a_pipe_is_refused_at_once(tmp_path):
    write_drive(tmp_path / "bag", ros2=True)
    os.mkfifo(tmp_path / "bag" / "more.db3")
    with pytest.raises(InputError, match=r"more\.db3: is a pipe, where a file is needed"):
        read_log(tmp_path / "bag")


def test_a_message_that_is_not_what_its_type_says_is_one_error():
    """A bag brings the definitions of its types along."""
    content = SimpleNamespace(ranges="far")
    with pytest.raises(InputError, match="scan: a message is not what its type says"), as_defined("scan"):
        print(content.header.stamp)


def test_a_chunk_that_unpacks_to_gigabytes_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("tagalong.slam.logs.bag_messages.MOST_CHUNK", 1000)
    with pytest.raises(ValueError, match="unpacks to more than 1000 bytes"):
        unpacked_bz2(bz2.compress(bytes(100_000)))
    monkeypatch.setattr(Writer1, "__init__", compressed(Writer1.__init__))
    write_drive(tmp_path / "drive.bag")
    with pytest.raises(InputError, match="unpacks to more than 1000 bytes"):
        read_log(tmp_path / "drive.bag")


def compressed(made):
    """The constructor of a writer that compresses what it writes."""

    def init(self, path):
        made(self, path)
        self.set_compression(self.CompressionFormat.BZ2)

    return init


def test_a_bag_that_lacks_the_messages_of_its_index_is_named(tmp_path):
    folder = write_drive(tmp_path / "drive", ros2=True)
    with closing(sqlite3.connect(next(folder.glob("*.db3")))) as file:
        file.execute("DELETE FROM messages")
        file.commit()
    with pytest.raises(InputError, match=r"drive: no readable ROS bag \(there is no message of /scan in it\)"):
        read_rosbag(folder)


def test_no_definition_that_a_bag_brings_along_becomes_a_program(tmp_path, monkeypatch):
    """The library writes a program for each definition that it registers, and runs it."""
    path, registered = write_drive(tmp_path / "drive.bag"), []
    changed = bytearray(path.read_bytes())
    assert b"float32 range_max" in changed
    path.write_bytes(changed.replace(b"float32 range_max", b"float32 range_evi"))
    register = Typestore.register
    monkeypatch.setattr(Typestore, "register", lambda self, types: (registered.append(types), register(self, types)))
    read_rosbag(path)
    assert "evi" not in str(registered)


def test_a_type_that_a_bag_defines_otherwise_than_ros_does_is_refused(tmp_path):
    path = write_drive(tmp_path / "drive.bag")
    digest = get_typestore(Stores.ROS1_NOETIC).generate_msgdef("sensor_msgs/msg/LaserScan")[1].encode()
    path.write_bytes(path.read_bytes().replace(digest, digest[::-1]))
    with pytest.raises(InputError, match="defines sensor_msgs/msg/LaserScan otherwise than ROS does"):
        read_rosbag(path)


def test_a_mistake_of_whoever_reads_an_open_bag_is_not_called_damage(tmp_path):
    path = write_drive(tmp_path / "whole.bag")
    with pytest.raises(KeyError), open_bag(path) as bag:
        bag.topics["/nowhere"]


@pytest.mark.parametrize("increment", [np.nan, np.inf, 0.0])
def test_beams_without_directions_are_one_clear_error(tmp_path, increment):
    with BagWriter(tmp_path / "odd.bag") as bag:
        bag.scan(1.0, [1.0] * 5, increment=increment)
    with pytest.raises(InputError, match=r"odd\.bag: /scan: beams need a finite angle and step"):
        read_log(tmp_path / "odd.bag")


def test_a_circle_cut_ahead_is_cut_behind_and_zero_and_infinite_limits_mean_what_drivers_mean(tmp_path):
    ranges = np.full(360, 4.0)
    ranges[[0, 10, 20]] = 2.0, 0.0, np.inf
    circle = {"angle_min": -np.pi, "increment": np.radians(1.0), "range_min": 0.0, "range_max": np.inf}
    with BagWriter(tmp_path / "backwards.bag") as bag:
        bag.transform(999.0, "base_link", "laser", (0.0, 0.0, 0.3), (0.0, 0.0, 1.0, 0.0), "/tf_static")
        bag.scan(1000.0, ranges, **circle)
    scan = read_rosbag(tmp_path / "backwards.bag").scans[0]
    assert (np.diff(scan.bearings) > 0.0).all()
    ahead = int(np.argmin(np.where(scan.is_return, scan.ranges, np.inf)))
    assert abs(ahead - 180) <= 1
    np.testing.assert_allclose(scan.points_robot[np.searchsorted(scan.beams, ahead)], [2.0, 0.0], atol=1e-5)
    assert scan.range_max == 4.0
    assert (int(scan.is_return.sum()), int(scan.is_no_return.sum())) == (358, 1)


def test_a_folder_that_is_no_bag_and_a_bag_without_scans_are_named(tmp_path):
    with pytest.raises(InputError, match=r"no ROS 2 bag"):
        read_log(tmp_path)
    with BagWriter(tmp_path / "odd.bag") as bag:
        bag.odometry(1.0, (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"no topic of type sensor_msgs/msg/LaserScan or \S+; it has: /odom"):
        read_rosbag(tmp_path / "odd.bag")


def test_without_the_library_the_command_that_installs_it_is_named(tmp_path, capsys, monkeypatch):
    path = write_drive(tmp_path / "drive.bag")
    monkeypatch.setitem(sys.modules, "rosbags.rosbag1", None)
    assert main(["slam", str(path), "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == 'tagalong: ROS bags need the extra "ros": pip install "tagalong[ros]"\n'


def unpacked(tmp_path, name):
    if not (LEGS / f"{name}.bag.xz").is_file():
        pytest.skip("needs TAGALONG_DATA with legs/")
    with lzma.open(LEGS / f"{name}.bag.xz") as packed, (tmp_path / f"{name}.bag").open("wb") as file:
        shutil.copyfileobj(packed, file)
    return tmp_path / f"{name}.bag"


def test_a_recorded_bag_equals_the_arrays_made_from_it(tmp_path):
    drive = read_rosbag(unpacked(tmp_path, "positive_2"))
    with np.load(LEGS / "positive_2_scans.npz") as arrays:
        np.testing.assert_array_equal([scan.ranges for scan in drive.scans], arrays["ranges"].astype(np.float64))
    assert not drive.has_odometry


def test_a_robot_that_stands_among_walking_people_is_known_to_stand(tmp_path):
    drive = read_rosbag(unpacked(tmp_path, "positive_2"))
    made = laser_odometry(drive.scans[:120])
    assert made.matched.mean() > 0.95
    assert np.abs(made.poses[:, :2]).max() < 0.05
    assert np.abs(made.poses[:, 2]).max() < np.deg2rad(1.0)
