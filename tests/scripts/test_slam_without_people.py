"""`tagalong slam --filter-people` on a small log: somebody paces before the robot, and then stands there."""

import json

import numpy as np
import pytest
from tagalong.perception import filtered_scans
from tagalong.scripts import cli
from tagalong.slam import LaserScan, RecordedDrive, read_ros_map
from tagalong.slam.logs import write_carmen

BEARINGS = np.linspace(-np.pi / 2, np.pi / 2, 721)
WALL_M, LEG_RADIUS_M, RATE_HZ = 6.0, 0.06, 10.0


def room(feet, forward, time_s):
    """A scan, from `forward` metres into a room, of its walls and of legs around `feet` (2, 2)."""
    x, y = np.cos(BEARINGS), np.sin(BEARINGS)
    ahead = np.where(x > 1e-9, (WALL_M - forward) / np.maximum(x, 1e-9), np.inf)
    ranges = np.minimum(ahead, 2.5 / np.maximum(np.abs(y), 1e-9))
    for foot in feet - (forward, 0.0):
        along, across = x * foot[0] + y * foot[1], -y * foot[0] + x * foot[1]
        hit = (np.abs(across) < LEG_RADIUS_M) & (along > 0.0)
        near = along - np.sqrt(np.maximum(LEG_RADIUS_M**2 - across**2, 0.0))
        ranges = np.where(hit, np.minimum(ranges, near), ranges)
    return LaserScan(ranges, BEARINGS, 0.1, 20.0, time_s)


def walker(k):
    """The feet of somebody who paces 3.5 m before the robot's start, one foot past the other, and stands from 60 on."""
    k = min(k, 60)
    y = 1.2 * np.sin(0.08 * k)
    return np.array([[3.4, y + 0.2 * np.sin(0.6 * k)], [3.6, y - 0.2 * np.sin(0.6 * k)]])


def drive_past_a_walker(clock=lambda k: k / RATE_HZ):
    scans = [room(walker(k), 0.02 * k, clock(k)) for k in range(120)]
    odometry = np.array([(0.02 * k, 0.0, 0.0) for k in range(120)])
    return RecordedDrive(odometry, scans, None, "walker")


def cells_where_somebody_stands(folder):
    """Occupied cells of the map, around the feet that stand."""
    apart = read_ros_map(folder / "map.yaml").occupied_points - walker(60).mean(axis=0)
    return int(np.count_nonzero(np.hypot(*apart.T) < 0.5))


@pytest.fixture
def log(tmp_path):
    write_carmen(tmp_path / "walker.log", drive_past_a_walker())
    return tmp_path / "walker.log"


@pytest.mark.parametrize("method", ["gmapping", "cartographer"])
def test_the_map_holds_the_walker_with_people_and_not_without(log, tmp_path, method, capsys):
    words = [
        "slam",
        str(log),
        "--quiet",
        "--method",
        method,
        *(["--set", "particles=3"] if method == "gmapping" else []),
    ]
    assert cli.main([*words, "--out", str(tmp_path / "raw")]) == 0
    assert cli.main([*words, "--out", str(tmp_path / "filtered"), "--filter-people"]) == 0
    raw, filtered = (cells_where_somebody_stands(tmp_path / name) for name in ("raw", "filtered"))
    assert raw >= 4
    assert filtered == 0
    removed = json.loads((tmp_path / "filtered" / "metrics.json").read_text())["people_filter"]
    assert 0 < removed["removed_returns"] < 0.2 * removed["returns"]
    assert removed["config"]["forest"] == "real"
    people = json.loads((tmp_path / "filtered" / "people.json").read_text())["people"]
    assert len(people) == removed["people"] >= 1
    longest = max(people, key=lambda person: len(person["scans"]))
    apart = np.array(longest["positions_m"]) - [walker(k).mean(axis=0) for k in longest["scans"]]
    assert np.median(np.hypot(*apart.T)) < 0.3
    assert "% of returns" in capsys.readouterr().out
    assert not (tmp_path / "raw" / "people.json").exists()


@pytest.mark.parametrize("clock", [lambda k: 0.0, lambda k: 0.1 * (k - k % 2), lambda k: 0.1 * k - (k == 50)])
def test_people_are_taken_out_of_logs_whose_clock_stands_still_or_goes_back(clock):
    drive = drive_past_a_walker(clock)
    filtered = list(filtered_scans(drive))
    assert sum(int(scan.removed.sum()) for scan in filtered) > 500
    assert [scan.without_people.time_s for scan in filtered] == [clock(k) for k in range(120)]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--forest", "real"], "--forest is the leg forest of --filter-people"),
        (["--filter-people", "--forest", "oak"], "no leg forest 'oak'"),
    ],
)
def test_a_forest_that_is_of_no_use_is_refused(log, tmp_path, words, said, capsys):
    assert cli.main(["slam", str(log), "--out", str(tmp_path / "out"), *words]) == 2
    assert said in capsys.readouterr().err
