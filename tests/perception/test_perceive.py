import csv
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.perception import HindsightFilter
from tagalong.scripts.cli import main

WALKER = Path(os.environ.get("TAGALONG_DATA", "")) / "legs" / "positive_1_scans.npz"


def write_scans(path, **changed):
    arrays = {
        "ranges": np.full((5, 90), 3.0, dtype=np.float32),
        "angle_min": np.float64(-0.8),
        "angle_increment": np.float64(0.018),
        "range_min": np.float64(0.02),
        "range_max": np.float64(10.0),
        "bag_time": 100.0 + 0.1 * np.arange(5),
    }
    arrays.update(changed)
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})
    return str(path)


def rows_of(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_an_empty_room_gives_tables_with_headers_only(tmp_path):
    assert main(["perceive", write_scans(tmp_path / "room.npz"), "--out", str(tmp_path / "out")]) == 0
    assert (tmp_path / "out" / "people.csv").read_text() == "scan,id,x,y,vx,vy,confidence\n"
    assert (tmp_path / "out" / "legs.csv").read_text().startswith("scan,x,y,confidence\n")
    assert (tmp_path / "out" / "config.json").is_file()


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"ranges": np.zeros(5)}, "must have shape (scans, beams)"),
        ({"range_max": None}, "missing: range_max"),
        ({"bag_time": np.zeros(3)}, "one a scan"),
        ({"bag_time": np.zeros(5)}, "give --rate HZ"),
    ],
)
def test_bad_files_end_with_one_line_and_status_two(tmp_path, capsys, changed, words):
    assert main(["perceive", write_scans(tmp_path / "bad.npz", **changed), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert words in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere.log"], "no file nowhere.log"),
        (["room.npz", "--preset", "table3"], "unknown preset 'table3'"),
        (["room.npz", "--forest", "oak"], "no leg forest 'oak'"),
        (["room.npz", "--rate", "-1"], "--rate: must be a number within 0.01 .. 100000"),
    ],
)
def test_bad_arguments_end_with_one_line_and_status_two(tmp_path, capsys, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    write_scans(tmp_path / "room.npz")
    assert main(["perceive", *arguments, "--out", "out"]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "given_to_it", "words"),
    [
        ([], None, "preset recorded, leg forest real; odometry made of the scans, for the log has none"),
        (["--odometry", "none"], [0.0, 0.0, 0.0], "odometry none: the laser stands"),
    ],
)
def test_scans_that_come_without_odometry_are_no_standing_robot_unless_that_is_said_and_the_choice_is_told(
    tmp_path, monkeypatch, capsys, arguments, given_to_it, words
):
    given, update = [], HindsightFilter.update

    def noting(people_filter, scan, odometry=None):
        given.append(None if odometry is None else odometry.tolist())
        return update(people_filter, scan, odometry)

    monkeypatch.setattr(HindsightFilter, "update", noting)
    assert main(["perceive", write_scans(tmp_path / "room.npz"), "--out", str(tmp_path / "out"), *arguments]) == 0
    assert given == [given_to_it] * 5
    assert words in capsys.readouterr().out


def test_scans_without_times_are_counted(tmp_path):
    scans = write_scans(tmp_path / "room.npz", bag_time=np.zeros(5))
    assert main(["perceive", scans, "--out", str(tmp_path / "out"), "--rate", "10"]) == 0


@pytest.mark.skipif(not WALKER.is_file(), reason="TAGALONG_DATA names no folder with legs/positive_1_scans.npz")
def test_a_recorded_walk_has_legs_and_people_and_the_same_bytes_twice(tmp_path):
    for folder in ("first", "second"):
        assert main(["perceive", str(WALKER), "--out", str(tmp_path / folder)]) == 0
    for name in ("legs.csv", "people.csv", "config.json"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()
    people, legs = rows_of(tmp_path / "first" / "people.csv"), rows_of(tmp_path / "first" / "legs.csv")
    assert len({row["scan"] for row in people}) > 50
    assert all(0.1 <= float(row["confidence"]) <= 1.0 for row in legs)
