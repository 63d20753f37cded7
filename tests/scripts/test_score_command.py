import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tagalong.scripts import cli
from tagalong.scripts.runs.scoring import kind_of
from tagalong.slam import InputError, OccupancyMap, write_ros_map
from tagalong.slam.geometry import compose, transform_points
from tagalong.slam.logs import Trajectory, read_tum, write_tum

DATA = os.environ.get("TAGALONG_DATA")
LOGS = Path(str(DATA)) / "slam_logs"
RIVALS = Path(str(DATA)).parent / "reference" / "rivals"
needs_rivals = pytest.mark.skipif(not RIVALS.is_dir(), reason="no trajectories of rivals beside TAGALONG_DATA")


def l_room(ghosts=False):
    cells = np.full((80, 120), 0.1, dtype=np.float32)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 0.9, 0.9, 0.9, 0.9
    cells[40:, 50] = cells[40, 50:] = 0.9
    cells[41:, 51:] = np.nan
    if ghosts:
        cells[20:24, 30] = 0.9
    return OccupancyMap(cells, 0.05, (-1.0, -1.0))


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    poses = np.column_stack((np.linspace(0, 5, 60), np.sin(np.linspace(0, 5, 60)), np.linspace(0, 1, 60)))
    times = 100.0 + np.arange(60) * 0.1
    write_tum("truth.tum", Trajectory(times, poses))
    write_tum("moved.tum.gz", Trajectory(times[5:] + 0.004, compose((3.0, 1.0, 0.4), poses[5:])))
    write_tum("late.tum", Trajectory(times + 5000.0, poses))
    write_ros_map("static", l_room())
    write_ros_map("raw", l_room(ghosts=True))
    np.savez_compressed("people.npz", feet=np.full((5, 2, 2), (0.525, 0.1)))
    np.savez_compressed("flat.npz", feet=np.zeros((5, 2)))
    Path("relations.txt").write_text("100.0 102.0 1.69 0.9 0 0 0 0.338983\n")
    Path("words.txt").write_text("hello world\n")
    Path("odometry.log").write_text("FLASER 2 1.0 1.0 0 0 0 0 0 0 1.0 host 1.0\n" * 3)
    return tmp_path


def score(capsys, *words):
    status = cli.main(["score", *words])
    printed = capsys.readouterr()
    return status, printed.out, printed.err


def test_kinds_are_told_by_content(here):
    kinds = {name: kind_of(name) for name in ("truth.tum", "moved.tum.gz", "static.yaml", "relations.txt")}
    assert list(kinds.values()) == ["trajectory", "trajectory", "map", "relations"]
    assert kind_of("odometry.log") == "log"
    with pytest.raises(InputError, match="begins with 'hello world'"):
        kind_of("words.txt")
    Path("empty").touch()
    with pytest.raises(InputError, match="is empty"):
        kind_of("empty")


def test_a_moved_trajectory_scores_zero_after_alignment(here, capsys):
    status, out, _ = score(capsys, "moved.tum.gz", "truth.tum", "--json", "scores/s.json")
    assert status == 0
    assert "ATE rmse" in out
    assert "cm" in out
    written = json.loads(Path("scores/s.json").read_text())
    assert written["kind"] == "trajectory"
    assert written["poses"] == 55
    assert written["ate_m"]["rmse"] < 1e-4


def test_a_trajectory_is_scored_by_relations(here, capsys):
    status, out, _ = score(capsys, "truth.tum", "relations.txt")
    assert status == 0
    assert "translation mean" in out
    assert "between scans interpolated" in out


def test_maps_are_scored_with_residue_and_overlay(here, capsys):
    status, out, _ = score(
        capsys, "raw.yaml", "static.yaml", "--people", "people.npz", "--json", "s.json", "--overlay", "o.png"
    )
    assert status == 0
    assert "ADNN, reference to estimate" in out
    written = json.loads(Path("s.json").read_text())
    assert written["adnn"]["mean_m"] < 1e-6
    assert written["ghosts"]["mean_m"] > 0.0
    assert written["dynamic_residue"]["cells"] == 4
    with Image.open("o.png") as picture:
        assert picture.width > 300


def test_feet_of_another_frame_are_placed_by_the_two_trajectories(here, capsys):
    world = np.array((7.0, -3.0, 2.0))
    poses = np.column_stack((np.linspace(0, 2, 5), np.zeros(5), np.zeros(5)))
    feet = transform_points(world, np.full((5, 2, 2), (0.525, 0.1)))
    Path("map").mkdir()
    write_ros_map("map/map", l_room(ghosts=True))
    write_tum("map/trajectory.tum", Trajectory(np.arange(5.0), poses))
    write_tum("drive.gt.tum", Trajectory(np.arange(5.0), compose(world, poses)))
    np.savez_compressed("drive.people.npz", feet=feet)
    words = ["map/map.yaml", "static.yaml", "--people", "drive.people.npz", "--json", "s.json"]
    assert score(capsys, *words)[0] == 0
    assert json.loads(Path("s.json").read_text())["dynamic_residue"]["cells"] == 4
    Path("drive.people.npz").rename("drive.npz")
    assert score(capsys, *words[:3], "drive.npz", *words[4:])[0] == 0  # by whatever name
    assert json.loads(Path("s.json").read_text())["dynamic_residue"]["cells"] == 4
    Path("drive.npz").rename("drive.people.npz")
    write_tum("drive.gt.tum", Trajectory(np.arange(4.0), poses[:4]))
    status, _, err = score(capsys, *words)
    assert status == 2
    assert "got 5, 4 and 5" in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.tum", "truth.tum"], "none.tum: cannot be read"),
        (["static.yaml", "truth.tum"], "a map cannot be judged by a trajectory"),
        (["odometry.log", "truth.tum"], "a log cannot be judged by a trajectory"),
        (["relations.txt", "relations.txt"], "relations cannot be judged by relations"),
        (["truth.tum", "odometry.log"], "holds odometry only"),
        (["late.tum", "truth.tum"], "are the clocks the same?"),
        (["late.tum", "relations.txt"], "are the clocks the same?"),
        (["words.txt", "truth.tum"], "neither a TUM trajectory"),
        (["raw.yaml", "static.yaml", "--people", "truth.tum"], "no readable npz"),
        (["raw.yaml", "static.yaml", "--people", "flat.npz"], "`feet` must have shape (scans, feet, 2), got (5, 2)"),
        (["moved.tum.gz", "truth.tum", "--people", "people.npz"], "true feet of people judge a map"),
        (["raw.yaml", "static.yaml", "--readings", "truth.tum"], "odometry of readings goes with relations"),
        (["moved.tum.gz", "truth.tum", "--overlay", "o.png"], "--overlay draws two maps"),
        (["moved.tum.gz", "truth.tum", "--max-gap", "-1"], "--max-gap: must be a number within 0 .. 86400"),
        (["moved.tum.gz", "truth.tum", "--json", "truth.tum/s.json"], "cannot be written"),
    ],
)
def test_mistakes_end_with_2_and_one_line(here, capsys, words, message):
    before = sorted(p.name for p in here.iterdir())
    status, _, err = score(capsys, *words)
    assert status == 2
    assert err.count("\n") == 1
    assert message in err
    assert sorted(p.name for p in here.iterdir()) == before


@needs_rivals
@pytest.mark.parametrize(
    ("log", "engine", "rmse_m"),
    [
        ("aces", "gmapping", 0.95),
        ("aces", "lama_slam2d", 0.095),
        ("belgioioso", "gmapping", 0.122),
        ("belgioioso", "lama_graph", 0.151),
    ],
)
def test_rivals_on_real_logs_score_as_their_table_says(tmp_path, capsys, log, engine, rmse_m):
    out = tmp_path / "s.json"
    reference = LOGS / f"{log}_with_odometry.log.gz"
    assert cli.main(["score", str(RIVALS / log / f"{engine}.tum.gz"), str(reference), "--json", str(out)]) == 0
    assert json.loads(out.read_text())["ate_m"]["rmse"] == pytest.approx(rmse_m, rel=0.01)


@needs_rivals
@pytest.mark.parametrize(
    ("drive", "engine", "rmse_cm", "max_cm"),
    [
        ("corridor-1p-s0", "gmapping", 20.5, 39.0),
        ("corridor-1p-s0", "carto_tuned", 1.1, 2.4),
        ("meeting-2p-s0", "gmapping", 4.1, 12.7),
        ("plainslip-2p-s0", "lama_slam2d", 53.2, 229.0),
    ],
)
def test_rivals_in_simulation_score_as_their_table_says(tmp_path, drive, engine, rmse_cm, max_cm):
    out = tmp_path / "s.json"
    reference = RIVALS.parent / f"{drive}.gt.tum"
    assert cli.main(["score", str(RIVALS / drive / f"{engine}.tum.gz"), str(reference), "--json", str(out)]) == 0
    ate = json.loads(out.read_text())["ate_m"]
    assert 100 * ate["rmse"] == pytest.approx(rmse_cm, abs=0.06)
    assert 100 * ate["max"] == pytest.approx(max_cm, abs=0.3)


@needs_rivals
def test_every_relation_of_intel_is_scored_by_the_odometry_between_scans(tmp_path, capsys):
    words = [str(RIVALS / "intel" / "gmapping.tum.gz"), str(LOGS / "intel_relations_by_reading.txt.gz")]
    readings = str(LOGS / "intel_readings_odometry.txt.gz")
    out = tmp_path / "s.json"
    assert cli.main(["score", *words, "--readings", readings, "--json", str(out)]) == 0
    written = json.loads(out.read_text())
    assert written["translation"]["count"] == 2984
    assert written["skipped"] == 0
    assert written["translation"]["mean"] == pytest.approx(0.0433, abs=5e-4)
    assert read_tum(words[0]).times_s[0] > 9e8
