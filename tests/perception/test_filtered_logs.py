"""Logs and bags with people in them, filtered: what comes out, and what stays as it was."""

import gzip
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
from tagalong.perception.config import perception_preset
from tagalong.perception.filtered_logs.log import filter_log
from tagalong.perception.filtered_logs.scan_filter import IncreasingClock, ScanFilter, removed_readings
from tagalong.scripts.cli import main
from tagalong.slam import LaserScan

CONFIG = perception_preset("recorded")
STEP, FIRST = np.radians(0.5), -np.pi / 2
BEARINGS = FIRST + STEP * np.arange(361)


def room_with_walker(time_s):
    """Ranges in a room 10 m wide, 8 m ahead, with somebody who walks across it, 2 m ahead."""
    ranges = np.minimum(8.0 / np.maximum(np.cos(BEARINGS), 1e-9), 5.0 / np.maximum(np.abs(np.sin(BEARINGS)), 1e-9))
    for side in (-1.0, 1.0):
        x, y = 2.0 + 0.25 * side * np.sin(6.0 * time_s), -1.5 + 1.0 * time_s + 0.08 * side
        along = x * np.cos(BEARINGS) + y * np.sin(BEARINGS)
        aside = -x * np.sin(BEARINGS) + y * np.cos(BEARINGS)
        hit = (np.abs(aside) < 0.06) & (along > 0.0)
        ranges[hit] = np.minimum(ranges[hit], along[hit] - np.sqrt(0.06**2 - aside[hit] ** 2))
    return ranges


TIMES = 0.1 * np.arange(30)


@pytest.fixture
def carmen(tmp_path):
    """A CARMEN log with all sorts of lines and spaces."""
    lines = ["# made up\r\n", "PARAM robot_frontlaser_offset 0.1\n", "\n"]
    for t in TIMES:
        ranges = " ".join(f"{value:.2f}" for value in room_with_walker(t))
        lines.append(f"ODOM 0 0  0 0 0 0 {t} host {t}\n")
        lines.append(f"FLASER 361 {ranges} 0 0 0 0 0 0 {t:.3f} host {t:.3f}\n")
    path = tmp_path / "drive.log"
    path.write_text("".join(lines), newline="")
    return path


def test_a_carmen_log_loses_the_returns_of_people_and_nothing_else(carmen, tmp_path):
    result = filter_log(carmen, tmp_path / "out.log", CONFIG)
    before, after = carmen.read_bytes().split(b"\n"), (tmp_path / "out.log").read_bytes().split(b"\n")
    assert result.counts.scans == len(TIMES)
    assert len(result.counts.people) == 1
    assert len(before) == len(after)
    changed = 0
    for a, b in zip(before, after, strict=True):
        if not a.startswith(b"FLASER"):
            assert a == b
            continue
        a, b = a.split(b" "), b.split(b" ")
        gone = {k for k in range(len(a)) if a[k] != b[k]}
        assert all(b[k] == b"0.0" and float(a[k]) < 3.0 for k in gone)
        changed += len(gone)
    assert changed > 100


def test_a_gzipped_log_is_the_same_log(carmen, tmp_path):
    (tmp_path / "drive.log.gz").write_bytes(gzip.compress(carmen.read_bytes()))
    filter_log(carmen, tmp_path / "a.log", CONFIG)
    filter_log(tmp_path / "drive.log.gz", tmp_path / "b.log.gz", CONFIG)
    assert gzip.decompress((tmp_path / "b.log.gz").read_bytes()) == (tmp_path / "a.log").read_bytes()


def test_a_damaged_line_is_named_and_nothing_is_written(carmen, tmp_path, capsys):
    carmen.write_bytes(carmen.read_bytes().replace(b"FLASER 361 8", b"FLASER 361 x", 1) + b"FLASER 361 1.0\n")
    assert main(["filter", str(carmen), str(tmp_path / "out.log")]) == 2
    assert "drive.log, line 64: FLASER: the line is cut" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["drive.log"]


def test_a_line_that_is_read_and_cannot_be_true_is_named_too(tmp_path, capsys):
    line = "ROBOTLASER1 0 -1.57 3.14 0.1 1e9 0.01 0 3 1.0 1.1 1.2 0 0 0 0 0 0 0 0.1 0 0.5 0.5 1e9 1 h 1\n"
    (tmp_path / "drive.log").write_text("# a drive\n" + line)
    assert main(["filter", str(tmp_path / "drive.log"), str(tmp_path / "out.log")]) == 2
    assert "drive.log, line 2: ROBOTLASER1: need 0 <= `range_min`" in capsys.readouterr().err


def test_a_log_is_not_filtered_into_itself(carmen, capsys):
    assert main(["filter", str(carmen), str(carmen)]) == 2
    assert "is the log itself" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("kind", "name", "found"),
    [
        ("sqlite", "out.mcap", "is a folder"),
        ("sqlite", "out.db3", "is a folder"),
        ("mcap", "out.bag", "is an MCAP file"),
        ("bag", "out.mcap", "is a ROS 1 bag"),
    ],
)
def test_a_bag_is_not_copied_under_a_name_of_another_kind(tmp_path, capsys, kind, name, found):
    source, _ = made(tmp_path, kind)
    assert main(["filter", str(source), str(tmp_path / name)]) == 2
    told = capsys.readouterr().err
    assert found in told
    assert f"give a name without {name[3:]}" in told
    assert not (tmp_path / name).exists()


def test_a_bag_is_known_by_what_it_holds_not_by_its_name(tmp_path):
    source, target = made(tmp_path, "bag")
    unnamed = shutil.move(source, tmp_path / "recorded")
    assert main(["filter", str(unnamed), str(target)]) == 0
    assert main(["filter", str(unnamed), str(tmp_path / "copy")]) == 0


def test_a_log_is_not_copied_under_the_name_of_a_bag(carmen, tmp_path, capsys):
    assert main(["filter", str(carmen), str(tmp_path / "out.mcap")]) == 2
    assert "is no bag" in capsys.readouterr().err


def test_the_topics_that_were_added_are_told(tmp_path, capsys):
    source, target = made(tmp_path, "mcap")
    assert main(["filter", str(source), str(target), "--topic", "/front/clean"]) == 0
    assert "added: /front/clean, and its people, tracks and legs (/front/clean/people, ...)" in capsys.readouterr().out


def test_stamps_that_stand_still_or_go_back_become_times_that_increase():
    clock = IncreasingClock(10.0)
    times = [clock.update(stamp) for stamp in (5.0, 5.0, 5.2, 5.1, 5.3)]
    np.testing.assert_allclose(times, [5.0, 5.1, 5.3, 5.5, 5.7])


def test_a_reading_in_the_direction_of_another_one_goes_with_it():
    """A driver that goes once round and one step more says the first direction twice; the circle is cut behind."""
    scan = LaserScan(np.full(360, 2.0), np.radians(np.arange(-180.0, 180.0)), 0.1, 8.0)
    order = (np.arange(360) + 180) % 360
    people_filter = ScanFilter(CONFIG)
    filtered = people_filter.update(scan, np.zeros(3))
    filtered.__dict__["removed"] = np.isin(order, [0, 7])
    removed = removed_readings(filtered, order, 361, np.radians(1.0))
    assert np.flatnonzero(removed).tolist() == [0, 7, 360]


@pytest.mark.parametrize("step", [np.inf, 1000.0, 1.0, -1.0, np.radians(1.0)])
def test_readings_that_are_in_no_direction_of_another_one_stay(step):
    scan = LaserScan(np.full(1, 2.0), np.zeros(1), 0.1, 8.0)
    filtered = ScanFilter(CONFIG).update(scan, np.zeros(3))
    filtered.__dict__["removed"] = np.ones(1, dtype=bool)
    assert np.flatnonzero(removed_readings(filtered, np.array([2]), 5, step)).tolist() == [2]


def test_people_before_a_laser_upside_down_are_where_its_own_frame_has_them(tmp_path):
    rosbag1 = pytest.importorskip("rosbags.rosbag1")
    types = store(ros1=True)
    for name, turned in (("upright", 0.0), ("over", 1.0)):
        with rosbag1.Writer(tmp_path / f"{name}.bag") as writer:
            scans = writer.add_connection("/scan", SCAN, typestore=types)
            frames = writer.add_connection("/tf_static", "tf/msg/tfMessage", msgdef=TF, md5sum=TF_MD5)
            writer.write(frames, 1, mounted(turned))
            for t in 1000.0 + TIMES:
                writer.write(scans, round(t * 1e9), bytes(message(types, True, t)))
        filter_log(tmp_path / f"{name}.bag", tmp_path / f"{name}_out.bag", CONFIG)
    kind = "geometry_msgs/msg/PoseArray"
    last = [contents(tmp_path / f"{name}_out.bag")[0]["/scan_filtered/people"][-1][1] for name in ("upright", "over")]
    upright, over = (types.deserialize_ros1(raw, kind).poses[0].position for raw in last)
    assert (upright.x, upright.y) == pytest.approx((over.x, over.y), abs=0.05)


# ---- bags

TF = "geometry_msgs/TransformStamped[] transforms\n"
TF_MD5 = "94810edda583a504dfda3829e70d7eec"


def mounted(turned):
    """A transform from the robot to the laser, upright or `turned` about its x axis, as ROS 1 writes it."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    types = get_typestore(Stores.ROS1_NOETIC)
    types.register(get_types_from_msg(TF, "tf/msg/tfMessage"))
    make = types.types
    header = make["std_msgs/msg/Header"](
        seq=0, stamp=make["builtin_interfaces/msg/Time"](sec=0, nanosec=1), frame_id="base_link"
    )
    transform = make["geometry_msgs/msg/Transform"](
        translation=make["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.2),
        rotation=make["geometry_msgs/msg/Quaternion"](x=turned, y=0.0, z=0.0, w=1.0 - turned),
    )
    stamped = make["geometry_msgs/msg/TransformStamped"](header=header, child_frame_id="laser", transform=transform)
    whole = make["tf/msg/tfMessage"](transforms=[stamped])
    return bytes(types.serialize_ros1(whole, "tf/msg/tfMessage"))


SCAN = "sensor_msgs/msg/LaserScan"


def store(ros1):
    """The library's types."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)


def message(types, ros1, t):
    make = types.types
    seconds = int(t)
    stamp = make["builtin_interfaces/msg/Time"](sec=seconds, nanosec=round((t - seconds) * 1e9))
    header = make["std_msgs/msg/Header"](stamp=stamp, frame_id="laser", **({"seq": 7} if ros1 else {}))
    ranges = room_with_walker(t - 1000.0)
    scan = make[SCAN](header=header, angle_min=FIRST, angle_max=-FIRST, angle_increment=STEP, time_increment=0.0,
                      scan_time=0.1, range_min=0.05, range_max=20.0, ranges=ranges.astype(np.float32),
                      intensities=np.arange(361, dtype=np.float32))  # fmt: skip
    return types.serialize_ros1(scan, SCAN) if ros1 else types.serialize_cdr(scan, SCAN)


def write_bag(writer, ros1):
    """30 scans, and notes of a type that nobody knows, on a topic without messages, too."""
    types = store(ros1)
    own = {"msgdef": "string words\n", ("md5sum" if ros1 else "rihs01"): "0" * 32 if ros1 else "RIHS01_" + "1" * 64}
    scans = writer.add_connection("/scan", SCAN, typestore=types)
    notes = writer.add_connection("/notes", "my_robot/msg/Note", **own)
    writer.add_connection("/silent", "my_robot/msg/Note", **own)
    for t in 1000.0 + TIMES:
        writer.write(notes, round(t * 1e9) - 5, b"whatever %d" % round(10 * t))
        writer.write(scans, round(t * 1e9), bytes(message(types, ros1, t)))


def contents(path):
    """Topic -> times and bytes, and topic -> type and definition, by the library's reader."""
    from rosbags.rosbag1 import Reader as Reader1
    from rosbags.rosbag2 import Reader as Reader2

    with (Reader1 if path.suffix == ".bag" else Reader2)(path) as reader:
        said = {each.topic: (each.msgtype, each.msgdef, each.digest, each.ext) for each in reader.connections}
        found = {topic: [] for topic in said}
        for connection, time_ns, raw in reader.messages(reader.connections):
            found[connection.topic].append((time_ns, bytes(raw)))
    return found, said


def made(tmp_path, kind):
    rosbag1, rosbag2 = pytest.importorskip("rosbags.rosbag1"), pytest.importorskip("rosbags.rosbag2")
    if kind in ("bag", "bag.bz2"):
        path = tmp_path / "drive.bag"
        writer = rosbag1.Writer(path)
        if kind == "bag.bz2":
            writer.set_compression(writer.CompressionFormat.BZ2)
        with writer:
            write_bag(writer, ros1=True)
        return path, tmp_path / "out.bag"
    plugin = rosbag2.StoragePlugin.SQLITE3 if kind == "sqlite" else rosbag2.StoragePlugin.MCAP
    with rosbag2.Writer(tmp_path / "drive", version=9, storage_plugin=plugin) as writer:
        write_bag(writer, ros1=False)
    if kind == "mcap":
        shutil.move(tmp_path / "drive" / "drive.mcap", tmp_path / "drive.mcap")
        return tmp_path / "drive.mcap", tmp_path / "out.mcap"
    return tmp_path / "drive", tmp_path / "out"


KINDS = ["bag", "bag.bz2", "sqlite", "mcap", "mcap folder"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_bag_keeps_all_that_it_has_and_gets_four_topics(tmp_path, kind):
    if kind.startswith("mcap"):
        pytest.importorskip("mcap")
    source, target = made(tmp_path, kind)
    assert main(["filter", str(source), str(target)]) == 0
    (before, said_before), (after, said_after) = contents(source), contents(target)
    added = ["/scan_filtered", "/scan_filtered/legs", "/scan_filtered/people", "/scan_filtered/tracks"]
    assert sorted(after) == sorted([*before, *added])
    for topic, messages in before.items():
        assert after[topic] == messages
        assert said_after[topic] == said_before[topic]
    assert [len(after[topic]) for topic in added] == [len(TIMES)] * 4
    types = store("bag" in kind)
    read = types.deserialize_ros1 if "bag" in kind else types.deserialize_cdr
    scans = [read(raw, SCAN) for _, raw in after["/scan"]]
    filtered = [read(raw, SCAN) for _, raw in after["/scan_filtered"]]
    assert [time for time, _ in after["/scan_filtered"]] == [time for time, _ in after["/scan"]]
    gone = 0
    for scan, left in zip(scans, filtered, strict=True):
        assert left.header == scan.header
        taken = np.isnan(left.ranges)
        np.testing.assert_array_equal(left.ranges[~taken], scan.ranges[~taken])
        np.testing.assert_array_equal(left.intensities, scan.intensities)
        assert (scan.ranges[taken] < 3.0).all()
        gone += np.count_nonzero(taken)
    assert gone > 100
    people = read(after["/scan_filtered/people"][-1][1], "geometry_msgs/msg/PoseArray")
    assert people.header == scans[-1].header
    assert [(p.position.x, p.position.y) for p in people.poses] == [pytest.approx((2.0, 1.4), abs=0.3)]
    cloud = read(after["/scan_filtered/tracks"][-1][1], "sensor_msgs/msg/PointCloud2")
    assert (cloud.width, cloud.point_step, [f.name for f in cloud.fields]) == (
        1,
        28,
        ["x", "y", "z", "id", "vx", "vy", "confidence"],
    )
    x, _, _, _, vy, _ = np.delete(np.frombuffer(cloud.data, np.float32), 3)
    assert x == pytest.approx(people.poses[0].position.x, abs=1e-5)
    assert vy == pytest.approx(1.0, abs=0.3)


def test_an_mcap_file_keeps_what_only_mcap_has(tmp_path):
    mcap_writer, mcap_reader = pytest.importorskip("mcap.writer"), pytest.importorskip("mcap.reader")
    types = store(ros1=False)
    with (tmp_path / "drive.mcap").open("wb") as file:
        writer = mcap_writer.Writer(file, compression=mcap_writer.CompressionType.LZ4)
        writer.start("ros2", "somebody")
        text = types.generate_msgdef(SCAN, ros_version=2)[0]
        schema = writer.register_schema(SCAN, "ros2msg", text.encode())
        channel = writer.register_channel("/scan", "cdr", schema, {"robot": "seven"})
        other = writer.register_channel("/json", "json", 0)
        writer.add_attachment(1, 2, "plan.txt", "text/plain", b"a room")
        for k, t in enumerate(1000.0 + TIMES):
            writer.add_message(other, round(t * 1e9) - 1, b"{}", round(t * 1e9) - 3, 5)
            writer.add_message(channel, round(t * 1e9), bytes(message(types, False, t)), round(t * 1e9) - 9, k)
        writer.add_metadata("weather", {"rain": "no"})
        writer.finish()

    def content(path):
        with path.open("rb") as file:
            reader = mcap_reader.make_reader(file, validate_crcs=True)
            messages = [
                ((c.topic, c.message_encoding, c.metadata), s and (s.name, s.data),
                 (m.log_time, m.publish_time, m.sequence, m.data))
                for s, c, m in reader.iter_messages()
                if "filtered" not in c.topic
            ]  # fmt: skip
            return messages, list(reader.iter_attachments()), list(reader.iter_metadata()), reader.get_header()

    assert main(["filter", str(tmp_path / "drive.mcap"), str(tmp_path / "out.mcap")]) == 0
    assert content(tmp_path / "out.mcap") == content(tmp_path / "drive.mcap")


def test_topics_that_are_there_already_are_named(tmp_path, capsys):
    source, target = made(tmp_path, "bag")
    filter_log(source, target, CONFIG)
    assert main(["filter", str(target), str(tmp_path / "again.bag"), "--scan-topic", "scan"]) == 2
    assert "has a topic /scan_filtered already; give another name by --topic" in capsys.readouterr().err
    assert main(["filter", str(target), str(tmp_path / "again.bag"), "--scan-topic", "scan", "--topic", "/clean"]) == 0


def test_a_folder_that_is_there_already_is_left_alone(tmp_path, capsys):
    source, target = made(tmp_path, "sqlite")
    target.mkdir()
    (target / "mine").touch()
    assert main(["filter", str(source), str(target)]) == 2
    assert "is there already" in capsys.readouterr().err
    assert [path.name for path in target.iterdir()] == ["mine"]


@pytest.mark.parametrize("kind", ["bag", "sqlite"])
def test_who_is_killed_leaves_nothing_under_the_name_of_the_copy(tmp_path, kind):
    source, target = made(tmp_path, kind)
    code = (
        "import time; from tagalong.perception.filtered_logs import bag; from tagalong.scripts.cli import main\n"
        "write = bag._BagFilter._write\n"
        "bag._BagFilter._write = lambda *a: (write(*a), print('wrote', flush=True), time.sleep(9.0))\n"
        f"main(['filter', {str(source)!r}, {str(target)!r}])"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"wrote\n"
    process.send_signal(signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert not target.exists()
