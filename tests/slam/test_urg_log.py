"""Logs of the tinySLAM project: both layouts, and what is said of broken ones."""

import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.drives.log import read_log
from tagalong.slam.errors import InputError
from tagalong.slam.logs.urg import read_urg_log

DATA = os.environ.get("TAGALONG_DATA")
TICK = 2.0 * np.pi * 0.077 / 2000.0  # [m]


def line(head, ranges):
    return " ".join(str(value) for value in [*head, *ranges])


def ranges_mm():
    ranges = np.full(683, 2000)
    ranges[:70] = 90  # the robot
    ranges[341:346] = 1500, 0, 7, 19, 20  # codes of errors end below 20
    return ranges


def test_encoders_are_rolled_into_poses_and_ranges_face_ahead(tmp_path):
    path = tmp_path / "drive.dat"
    wheels = [(1000, 500), (1000 + 2000, 500 + 2000), (3000 - 100, 2500 + 100)]
    path.write_text("\n".join(line([k * 100000, 0, *w, *[0] * 20], ranges_mm()) for k, w in enumerate(wheels)))
    drive = read_log(path)
    turn = 200 * TICK / 0.33
    np.testing.assert_allclose(drive.odometry, [[0, 0, 0], [2000 * TICK, 0, 0], [2000 * TICK, 0, turn]], atol=1e-9)
    scan = drive.scans[1]
    assert scan.time_s == pytest.approx(0.1)
    assert len(scan.ranges) == 543
    middle = int(np.argmin(np.abs(scan.bearings)))
    assert scan.ranges[middle] == pytest.approx(1.5)
    assert np.isnan(scan.ranges[middle + 1 : middle + 4]).all()
    assert scan.ranges[middle + 4] == pytest.approx(0.02)
    assert scan.is_return[middle + 4]
    np.testing.assert_allclose(scan.points_robot[middle], [1.645, 0.0], atol=1e-9)
    assert drive.notes == ()


def test_the_layout_with_poses_takes_them_and_a_cut_last_line_is_told(tmp_path):
    path = tmp_path / "lab.dat"
    whole = [line([k * 100000, 5, -5, 0.5 * k, 1.0, 350.0 + 20.0 * k, *[0] * 6], ranges_mm()) for k in range(3)]
    path.write_text("\n".join([*whole[:2], whole[2][:300]]))
    drive = read_log(path)
    np.testing.assert_allclose(drive.odometry, [[0, 1, np.radians(-10)], [0.5, 1, np.radians(10)]], atol=1e-9)
    assert "last line (3)" in drive.notes[0]


def test_a_cut_line_in_the_middle_and_words_are_named(tmp_path):
    whole = line([1, 0, 5, 5, *[0] * 20], ranges_mm())
    for broken, message in ((whole[:300], "2: needs 707 numbers"), (whole.replace("1500", "far"), "2: expected")):
        (tmp_path / "a.dat").write_text("\n".join([whole, broken, whole]))
        with pytest.raises(InputError, match=message):
            read_urg_log(tmp_path / "a.dat")


@pytest.mark.skipif(DATA is None, reason="needs TAGALONG_DATA")
@pytest.mark.parametrize(("name", "scans", "path_m"), [("exp2", 641, 43.0), ("test_lab", 590, 23.2)])
def test_recorded_drives_are_read_whole(name, scans, path_m):
    drive = read_log(Path(str(DATA)) / "hokuyo_odometry" / f"{name}.dat.gz")
    assert len(drive) == scans
    assert np.hypot(*np.diff(drive.odometry[:, :2], axis=0).T).sum() == pytest.approx(path_m, rel=0.05)
