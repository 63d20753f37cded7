import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between
from tagalong.slam.logs.carmen import read_carmen
from tagalong.slam.logs.carmen_writer import write_carmen
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.logs.drive_folder import SimulatedDrive, read_drive, write_drive
from tagalong.slam.scan import LaserScan

DATA = os.environ.get("TAGALONG_DATA")
REFERENCE = Path(DATA).parent / "reference" if DATA else Path("none")


def simulated(n=12, beams=61, feet=4):
    rng = np.random.default_rng(5)
    odometry = np.column_stack((np.cumsum(rng.uniform(0, 0.1, (n, 2)), axis=0), rng.uniform(-3.1, 3.1, n)))
    bearings = np.linspace(-2.356194, 2.356194, beams)
    scans = []
    for i in range(n):
        ranges = rng.uniform(0.2, 29.0, beams)
        ranges[:4] = np.inf, np.nan, 0.05, 30.0
        scans.append(LaserScan(ranges, bearings, 0.1, 30.0, 0.1 * (i + 1), (0.1, 0.0, 0.02)))
    truth = odometry + rng.normal(0, 0.05, odometry.shape)
    drive = RecordedDrive(odometry, scans, truth, "lab-2p")
    return SimulatedDrive(drive, truth, rng.uniform(-3, 3, (n, feet, 2)))


def test_a_drive_written_is_the_drive_read(tmp_path):
    drive = simulated()
    write_drive(tmp_path, drive)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["lab-2p.gt.tum", "lab-2p.log.gz", "lab-2p.people.npz"]
    back = read_drive(tmp_path, "lab-2p")
    assert back.recording.name == "lab-2p"
    assert np.abs(between(back.truth, drive.truth)).max() < 1e-5
    np.testing.assert_array_equal(back.feet, drive.feet)
    np.testing.assert_allclose(back.recording.odometry, drive.recording.odometry, atol=1e-6)
    np.testing.assert_allclose(back.recording.times_s, drive.recording.times_s)
    for ours, theirs in zip(drive.recording.scans, back.recording.scans, strict=True):
        np.testing.assert_allclose(theirs.bearings, ours.bearings, atol=1e-7)
        np.testing.assert_allclose(theirs.T_robot_lidar, ours.T_robot_lidar, atol=1e-4)
        np.testing.assert_array_equal(theirs.is_return, ours.is_return)
        np.testing.assert_array_equal(theirs.is_no_return, ours.is_no_return)
        assert theirs.range_max == ours.range_max
        np.testing.assert_allclose(theirs.points, ours.points, atol=1.1e-3)


def test_equal_drives_give_equal_bytes_under_any_name(tmp_path):
    write_drive(tmp_path / "one", simulated(), "a")
    write_drive(tmp_path / "two", simulated(), "b")
    for ending in ("log.gz", "gt.tum", "people.npz"):
        assert (tmp_path / "one" / f"a.{ending}").read_bytes() == (tmp_path / "two" / f"b.{ending}").read_bytes()


def test_a_drive_without_people_has_no_feet(tmp_path):
    write_drive(tmp_path, simulated(feet=0))
    assert read_drive(tmp_path, "lab-2p").feet.shape == (12, 0, 2)
    (tmp_path / "lab-2p.people.npz").unlink()
    assert read_drive(tmp_path, "lab-2p").feet.shape == (12, 0, 2)


def test_mistakes_are_named(tmp_path):
    drive = simulated()
    write_drive(tmp_path, drive)
    with pytest.raises(InputError, match=r"other\.log: cannot be read"):
        read_drive(tmp_path, "other")
    lines = (tmp_path / "lab-2p.gt.tum").read_text().splitlines()
    (tmp_path / "lab-2p.gt.tum").write_text("\n".join(lines[:-1]))
    with pytest.raises(InputError, match="one pose a scan needed, got 11 for 12"):
        read_drive(tmp_path, "lab-2p")
    write_drive(tmp_path, drive)
    np.savez(tmp_path / "lab-2p.people.npz", toes=np.zeros(3))
    with pytest.raises(InputError, match="array `feet`"):
        read_drive(tmp_path, "lab-2p")
    (tmp_path / "lab-2p.people.npz").write_bytes(b"PK\x03\x04 not really")
    with pytest.raises(InputError, match="no readable npz"):
        read_drive(tmp_path, "lab-2p")
    with pytest.raises(InputError, match=r"`feet` must have shape \(12, feet, 2\)"):
        SimulatedDrive(drive.recording, drive.truth, np.zeros((3, 2, 2)))
    with pytest.raises(InputError, match=r"`truth` must have shape \(12, 3\)"):
        SimulatedDrive(drive.recording, drive.truth[:5], drive.feet)


def test_uneven_beams_are_refused_and_leave_no_file(tmp_path):
    scan = LaserScan(np.ones(3), np.array([0.0, 0.1, 0.5]), 0.1, 30.0)
    with pytest.raises(InputError, match=r"scan 0: .*evenly spaced"):
        write_carmen(tmp_path / "a.log", RecordedDrive(np.zeros((1, 3)), [scan], None, "a"))
    one = LaserScan(np.ones(1), np.zeros(1), 0.1, 30.0)
    with pytest.raises(InputError, match="at least 2 beams"):
        write_carmen(tmp_path / "a.log", RecordedDrive(np.zeros((1, 3)), [one], None, "a"))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not REFERENCE.is_dir(), reason="no reference logs beside TAGALONG_DATA")
def test_a_reference_drive_is_read_and_survives_being_written(tmp_path):
    drive = read_drive(REFERENCE, "plainslip-2p-s0")
    assert drive.feet.shape == (567, 4, 2)
    assert len(drive.recording) == 567
    write_drive(tmp_path, drive)
    back = read_carmen(tmp_path / "plainslip-2p-s0.log.gz")
    np.testing.assert_allclose(back.scans[300].ranges, drive.recording.scans[300].ranges, atol=1e-9)
    np.testing.assert_allclose(back.odometry, drive.recording.odometry, atol=1e-9)
