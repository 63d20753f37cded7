import gzip
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest
from tagalong.scripts import cli
from tagalong.scripts.commands import slam as command
from tagalong.slam import LaserScan, OccupancyMap, RecordedDrive, SlamUpdate, read_ros_map
from tagalong.slam.geometry import compose
from tagalong.slam.logs import Trajectory, read_tum, write_carmen, write_tum

RESULTS = ["map.pgm", "map.png", "map.yaml", "metrics.json", "timing.json", "trajectory.tum"]


@dataclass(frozen=True)
class FakeConfig:
    particles: int = 3


class OdometryEngine:
    """Believes the odometry and draws a dot for every end point."""

    def __init__(self, **options):
        self.config = FakeConfig(**{k: v for k, v in options.items() if k != "seed"})
        self._poses, self._points = [], []

    def update(self, odometry, scan):
        if len(self._poses) == 25 and self.config.particles == 666:
            raise KeyboardInterrupt
        self._poses.append(np.array(odometry))
        self._points.append(np.asarray(compose(odometry, (1.0, 0.0, 0.0)))[:2])
        return SlamUpdate(self._poses[-1], len(self._poses) % 2 == 1, {})

    def finish(self):
        pass

    def trajectory(self):
        return np.array(self._poses)

    def map(self):
        return self.map_at(0.1)

    def map_at(self, resolution):
        size = int(4.0 / resolution)
        cells = np.full((size, size), 0.1, dtype=np.float32)
        cells[0] = 0.9
        return OccupancyMap(cells, resolution, (0.0, -2.0))


def square_room_drive(n=40, stamped=True):
    bearings = np.linspace(-np.pi, np.pi, 90, endpoint=False)
    odometry, scans = [], []
    for i in range(n):
        pose = np.array((0.05 * i, 0.0, 0.0))
        across = np.minimum(
            np.where(np.cos(bearings) > 0, 4.0 - pose[0], 2.0 + pose[0]) / np.maximum(np.abs(np.cos(bearings)), 1e-9),
            2.5 / np.maximum(np.abs(np.sin(bearings)), 1e-9),
        )
        odometry.append(pose)
        scans.append(LaserScan(across, bearings, 0.1, 20.0, 0.1 * i if stamped else 0.0))
    return RecordedDrive(np.array(odometry), scans, None, "room")


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "room.log.gz"
    write_carmen(path, square_room_drive())
    return path


@pytest.fixture
def fake(monkeypatch):
    monkeypatch.setattr(command, "make_slam", lambda name, **options: OdometryEngine(**options))


def test_a_log_becomes_a_result_directory(log, tmp_path, fake, capsys):
    assert (
        cli.main(
            [
                "slam",
                str(log),
                "--out",
                str(tmp_path / "out"),
                "--method",
                "gmapping",
                "--set",
                "particles=7",
                "--seed",
                "3",
            ]
        )
        == 0
    )
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == RESULTS
    trajectory = read_tum(tmp_path / "out" / "trajectory.tum")
    np.testing.assert_allclose(trajectory.poses, square_room_drive().odometry, atol=1e-6)
    np.testing.assert_allclose(trajectory.times_s, square_room_drive().times_s, atol=1e-6)
    assert read_ros_map(tmp_path / "out" / "map.yaml").occupied.sum() == 40
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert (metrics["method"], metrics["seed"], metrics["config"]) == ("gmapping", 3, {"particles": 7})
    assert metrics["integrated_scans"] == 20
    assert metrics["standard_deviation_m"] is None
    assert metrics["path_m"] == pytest.approx(39 * 0.05)
    assert metrics["against_reference"] is None
    timing = json.loads((tmp_path / "out" / "timing.json").read_text())
    assert timing["scans"] == 40
    assert timing["log_s"] == pytest.approx(3.9)
    assert timing["wall_s"] > 0
    assert timing["realtime_factor"] > 0
    assert timing["peak_memory_mb"] > 10
    printed = capsys.readouterr()
    assert "integrated" in printed.out
    assert "40/40" in printed.err


def test_true_poses_beside_the_log_are_compared_with(log, tmp_path, fake, capsys):
    truth = compose((5.0, 1.0, 0.5), square_room_drive().odometry)
    write_tum(tmp_path / "room.gt.tum", Trajectory(np.arange(40) * 0.1, truth))
    assert cli.main(["slam", str(log), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    errors = json.loads((tmp_path / "out" / "metrics.json").read_text())["against_reference"]
    assert errors["ate_m"]["rmse"] < 1e-5
    printed = capsys.readouterr()
    assert "ATE rmse" in printed.out
    assert printed.err == ""
    write_tum(tmp_path / "room.gt.tum", Trajectory(np.arange(39) * 0.1, truth[:39]))
    assert cli.main(["slam", str(log), "--out", str(tmp_path / "out")]) == 2
    assert "got 39 for 40" in capsys.readouterr().err


def test_a_log_without_a_clock_numbers_its_scans(tmp_path, fake):
    write_carmen(tmp_path / "a.log", square_room_drive(stamped=False))
    assert cli.main(["slam", str(tmp_path / "a.log"), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert read_tum(tmp_path / "out" / "trajectory.tum").times_s.tolist() == list(range(40))
    assert json.loads((tmp_path / "out" / "timing.json").read_text())["realtime_factor"] is None


def test_the_cells_can_be_chosen(log, tmp_path, fake):
    assert cli.main(["slam", str(log), "--out", str(tmp_path / "out"), "--resolution", "0.5", "--quiet"]) == 0
    assert read_ros_map(tmp_path / "out" / "map.yaml").resolution == 0.5


@pytest.mark.parametrize("source", ["laser", "refined"])
def test_the_scans_can_make_or_refine_the_odometry(log, tmp_path, fake, capsys, source):
    words = ["slam", str(log), "--out", str(tmp_path / "out"), "--quiet", "--odometry", source]
    assert cli.main([*words, "--matcher", "mbicp", "--matcher-set", "kept=0.9"]) == 0
    said = capsys.readouterr().err
    assert f"odometry is {'made from' if source == 'laser' else 'refined by'} the scans" in said
    trajectory = read_tum(tmp_path / "out" / "trajectory.tum").poses
    np.testing.assert_allclose(trajectory, square_room_drive().odometry, atol=0.2)
    assert not np.array_equal(trajectory, square_room_drive().odometry)
    odometry = json.loads((tmp_path / "out" / "metrics.json").read_text())["odometry"]
    assert (odometry["source"], odometry["matcher"], odometry["settings"]) == (source, "mbicp", {"kept": 0.9})


def test_gmapping_twice_with_one_seed_gives_the_same_bytes(log, tmp_path):
    for folder in ("one", "two"):
        words = [
            "slam",
            str(log),
            "--out",
            str(tmp_path / folder),
            "--quiet",
            "--method",
            "gmapping",
            "--set",
            "particles=3",
        ]
        assert cli.main([*words, "--set", "linear_update=0.2"]) == 0
    for name in RESULTS:
        if name != "timing.json":
            assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes(), name
    metrics = json.loads((tmp_path / "one" / "metrics.json").read_text())
    assert metrics["integrated_scans"] > 5
    sigma = metrics["standard_deviation_m"]
    assert 0.0 <= sigma["median"] <= sigma["most"] < 1.0
    assert sigma["last"] <= sigma["most"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["slam", "none.log", "--out", "out"], "none.log: cannot be read"),
        (["slam", "LOG", "--out", "out", "--method", "slom"], "unknown SLAM engine 'slom'; SLAM engines:"),
        (
            ["slam", "LOG", "--out", "out", "--method", "gmapping", "--set", "partikel=3"],
            "unknown GMappingConfig field 'partikel'",
        ),
        (
            ["slam", "LOG", "--out", "out", "--method", "gmapping", "--set", "particles=many"],
            "`particles` must be a whole number, got 'many'",
        ),
        (["slam", "LOG", "--out", "out", "--set", "seed=3"], "--seed"),
        (["slam", "LOG", "--out", "out", "--seed", "-1"], "--seed: must be a whole number of at least 0, got '-1'"),
        (["slam", "LOG", "--out", "out", "--method", "ekf", "--set", "gate=no"], "`gate` must be a number"),
        (["slam", "LOG", "--out", "out", "--method", "cartographer", "--set", "local=3"], "local.matcher"),
        (["slam", "BLIND", "--out", "out"], "none of the 2 scans holds a measured distance"),
        (["slam", "LOG", "--out", "out", "--set", "particles"], "--set needs NAME=VALUE"),
        (
            ["slam", "LOG", "--out", "out", "--method", "gmapping", "--set", "particles=-3"],
            "`particles` must be within 1 .. 1000, got -3",
        ),
        (["slam", "LOG", "--out", "out", "--resolution", "0"], "--resolution: must be a number within 0.001 .. 10"),
        (["slam", "LOG", "--out", "LOG"], "is a file, where a folder has to be written"),
        (["slam", "CUT", "--out", "out"], "cut"),
        (["slam", "LOG", "--out", "out", "--odometry", "wheels"], "unknown source of odometry 'wheels'"),
        (["slam", "LOG", "--out", "out", "--odometry", "laser", "--matcher", "ipc"], "unknown scan matcher 'ipc'"),
        (["slam", "LOG", "--out", "out", "--matcher", "icp"], "add --odometry refined or laser"),
        (["slam", "LOG", "--out", "out", "--matcher-set", "kept"], "--matcher-set needs NAME=VALUE"),
        (["slam", "LOG", "--out", "out", "--odometry", "laser", "--matcher-set", "kep=1"], "scan matcher 'plicp': unk"),
        (["slam", "EMPTY", "--out", "out"], "no laser scan found"),
    ],
)
def test_mistakes_end_with_2_and_one_line_and_no_file(log, tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    whole = log.read_bytes()
    (tmp_path / "cut.log.gz").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "empty.log").write_text("")
    (tmp_path / "blind.log").write_text("FLASER 3 0 0 0 0 0 0 0 0 0 0 h 0\n" * 2)
    names = {"LOG": str(log), "CUT": "cut.log.gz", "EMPTY": "empty.log", "BLIND": "blind.log"}
    assert cli.main([names.get(word, word) for word in words]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert message in printed.err
    assert not (tmp_path / "out").exists()


def test_a_line_cut_in_the_middle_is_named(log, tmp_path, capsys):
    text = gzip.decompress(log.read_bytes())
    (tmp_path / "cut.log").write_bytes(text[: len(text) - 300])
    assert cli.main(["slam", str(tmp_path / "cut.log"), "--out", str(tmp_path / "out")]) == 2
    assert "line 42" in capsys.readouterr().err


def test_an_interrupted_run_writes_nothing(log, tmp_path, fake, capsys):
    assert cli.main(["slam", str(log), "--out", str(tmp_path / "out"), "--set", "particles=666"]) == 130
    assert list((tmp_path / "out").iterdir()) == []
    assert capsys.readouterr().err.endswith("tagalong: interrupted\n")


def test_ctrl_c_leaves_no_half_files(tmp_path):
    write_carmen(tmp_path / "long.log.gz", square_room_drive(3000))
    words = [
        "slam",
        str(tmp_path / "long.log.gz"),
        "--out",
        str(tmp_path / "out"),
        "--method",
        "gmapping",
        "--set",
        "linear_update=0.01",
        "--set",
        "particles=400",
    ]
    process = subprocess.Popen(
        [sys.executable, "-m", "tagalong", *words],
        stderr=subprocess.PIPE,
        text=True,
        env=dict(os.environ),
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),  # a background shell has it ignored
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "out").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert list((tmp_path / "out").iterdir()) == []
