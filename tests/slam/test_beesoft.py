"""BeeSoft logs and maps: what is read, and one clear error for what cannot be."""

import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.errors import InputError
from tagalong.slam.logs.beesoft import is_beesoft_log, is_beesoft_map, read_beesoft_log, read_beesoft_map

RANGES = " ".join(["100"] * 90 + ["8183"] + ["0"] + ["250"] * 88)
LOG = f"O 10 20 0.5 0.1\nL 100 200 0.0 125 200 0.0 {RANGES} 0.25\nL 110 200 3.2 85 200 3.2 {RANGES} 0.5\n"
MAP = "robot_specifications->resolution 10\n\nglobal_map[0]: 2 3\n-1 1.0 0.9\n0.0 0.25 1.0\n"


def test_a_log_is_read_in_metres(tmp_path):
    path = tmp_path / "a.log.gz"
    path.write_bytes(gzip.compress(LOG.encode()))
    assert is_beesoft_log(path)
    assert not is_beesoft_map(path)
    drive = read_beesoft_log(path)
    np.testing.assert_allclose(drive.odometry, [[1.0, 2.0, 0.0], [1.1, 2.0, 3.2 - 2.0 * np.pi]])
    scan = drive.scans[0]
    assert (scan.time_s, scan.T_robot_lidar) == (0.25, (0.25, 0.0, 0.0))
    assert scan.ranges[0] == 1.0
    assert np.isinf(scan.ranges[90])
    assert np.isnan(scan.ranges[91])
    np.testing.assert_allclose(np.degrees(scan.bearings[[0, -1]]), [-89.5, 89.5])


def test_in_a_map_lines_run_along_x_and_one_means_free(tmp_path):
    path = tmp_path / "map.dat"
    path.write_text(MAP)
    assert is_beesoft_map(path)
    assert not is_beesoft_log(path)
    grid = read_beesoft_map(path)
    np.testing.assert_allclose(grid.probability, [[np.nan, 1.0], [0.0, 0.75], [0.1, 0.0]], atol=1e-6)
    assert (grid.resolution, grid.origin) == (0.1, (0.0, 0.0))


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (LOG.replace(" 0.25\n", "\n"), ":2: needs 187 numbers after L, got 186"),
        (LOG.replace("O 10", "O ten"), ":1: expected a number, got 'ten'"),
        (LOG.replace("L 100", "L nan"), ":2: expected finite poses"),
        (LOG + "X 1 2\n", ":4: expected a line that begins with L or O, got 'X'"),
        ("O 1 2 3 4\n", "no laser scan found"),
    ],
)
def test_a_bad_log_is_one_clear_error(tmp_path, text, complaint):
    path = tmp_path / "bad.log"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_beesoft_log(path)
    assert complaint in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        (MAP.replace("0.25 1.0", "0.25"), ":5: needs 3 values, got 2"),
        (MAP.replace("0.25", "wall"), ":5: expected a probability or -1, got 'wall'"),
        (MAP.rsplit("0.0 ", 1)[0], "the grid is cut: needs 2 lines, got 1"),
        (MAP.replace(": 2 3", ": 2"), ":3: the size of the grid needs two positive numbers"),
        (MAP.replace(": 2 3", ": nan 3"), ":3: the size of the grid needs two positive numbers"),
        (MAP.replace("0.25", "7"), ":5: expected a probability or -1, got 7"),
        (MAP.replace("0.25", "nan"), ":5: expected a probability or -1, got nan"),
        (MAP.replace("resolution 10", "resolution inf"), "no map found"),
        (MAP.replace("resolution 10", "resolution 0"), "no map found"),
    ],
)
def test_a_bad_map_is_one_clear_error(tmp_path, text, complaint):
    path = tmp_path / "bad.dat"
    path.write_text(text)
    with pytest.raises(InputError) as error:
        read_beesoft_map(path)
    assert complaint in str(error.value)


def test_the_recorded_hall_is_read():
    folder = os.environ.get("TAGALONG_DATA")
    if not folder:
        pytest.skip("needs TAGALONG_DATA, the folder of recorded data")
    hall = Path(folder) / "localization_wean"
    drive, grid = read_beesoft_log(hall / "robotdata1.log.gz"), read_beesoft_map(hall / "wean.dat.gz")
    assert len(drive) == 713
    assert grid.probability.shape == (800, 800)
    assert 0.11 < grid.occupied.sum() / grid.known.sum() < 0.12
