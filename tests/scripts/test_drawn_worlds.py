"""Drawn worlds: every engine is measured in them, and an interrupted experiment goes on."""

import json
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.benchmarks import drawn_worlds
from tagalong.scripts.cli import main
from tagalong.scripts.lab.cells import without_timing
from tagalong.slam import RecordedDrive
from walls import cast

SQUARE = np.array([(0, 0, 10, 0), (10, 0, 10, 10), (10, 10, 0, 10), (0, 10, 0, 0)], dtype=float)
BEARINGS = np.linspace(-np.pi, np.pi, 360, endpoint=False)


@dataclass
class Traits:
    people: int = 0


def tiny(kind, seed, *, spinning=False):
    """Return a drive of a few scans on the spot in a square room."""
    truth, rng = np.tile((4.0, 6.0, 0.1 * seed), (12, 1)), np.random.default_rng(seed)
    scans = [cast(SQUARE, pose, rng, 6.0, 0.0, BEARINGS) for pose in truth]
    recording = RecordedDrive(np.zeros((12, 3)), scans, truth, f"{kind}-{seed}")
    plan = SimpleNamespace(planner=SimpleNamespace(area=100.0))
    return SimpleNamespace(plan=plan, traits=Traits(), recording=recording, truth=truth)


@pytest.mark.parametrize("engine", drawn_worlds.ENGINES)
def test_on_the_spot_every_engine_is_where_it_was(monkeypatch, engine):
    monkeypatch.setattr(drawn_worlds, "draw_drive", tiny)
    result = drawn_worlds.world("hall", 0, engine)
    assert result["final"]["max_m"] < 0.02
    assert result["scans"] == 12
    assert result["not_located"] == 0.0
    assert result["beyond"] == 0.0 or engine == "gmapping"  # whose particles agree to a tenth of a millimetre
    assert ("losses" in result) == (engine == "cartographer")


@pytest.mark.parametrize(("kind", "seed"), [("office", 0), ("cells", 0)])
def test_graph_slam_is_as_far_off_as_it_says(kind, seed):
    drive = drawn_worlds.draw_drive(kind, seed)
    _, updates, _ = drawn_worlds.driven(drive.recording, "cartographer")
    covariances = np.array([update.covariance for update in updates])
    np.testing.assert_allclose(covariances, covariances.swapaxes(1, 2), atol=1e-9)
    assert (np.linalg.eigvalsh(covariances) > 0.0).all()
    distances = drawn_worlds.squared_distances(np.array([update.pose for update in updates]), covariances, drive.truth)
    assert drawn_worlds.beyond(distances) < 0.03
    assert np.median(distances) > 0.05  # nor is it so cautious that it says nothing


def test_spinning_lasers_are_measured_with_and_without_the_motion_in_their_scans(monkeypatch, tmp_path):
    told = []

    def noted(kind, seed, *, spinning):
        told.append(spinning)
        return tiny(kind, seed)

    monkeypatch.setattr(drawn_worlds, "draw_drive", noted)

    class Live:
        def update(self, odometry, scan):
            told.append("live")
            return scan, None

    monkeypatch.setattr(drawn_worlds, "deskewed", lambda drive: told.append("deskewed") or drive)
    monkeypatch.setattr(drawn_worlds, "Deskewer", Live)
    words = ["bench", "drawn-worlds", "--kinds", "hall", "--seeds", "0", "0", "--out", str(tmp_path)]
    assert main(words) == 0
    assert main([*words, "--spinning"]) == 0
    assert main([*words, "--spinning", "left"]) == 0
    assert told == [False, True, "deskewed", True]
    assert main([*words, "--spinning", "live"]) == 0
    assert told[4:] == [True, *["live"] * 12]
    assert main([*words, "--spinning", "left"]) == 0
    assert list(json.loads((tmp_path / "results.json").read_text())["worlds"]) == ["cartographer/hall/0/left"]


def test_without_wheels_odometry_is_made_of_the_scans(monkeypatch, tmp_path, capsys):
    def drifting(kind, seed, *, spinning):
        drive = tiny(kind, seed)
        odometry = np.linspace((0.0, 0.0, 0.0), (3.0, 1.0, 0.5), len(drive.recording))
        return SimpleNamespace(**{**vars(drive), "recording": replace(drive.recording, odometry=odometry)})

    monkeypatch.setattr(drawn_worlds, "draw_drive", drifting)
    words = ["bench", "drawn-worlds", "--kinds", "hall", "--seeds", "0", "0", "--out", str(tmp_path), "--spinning"]
    assert main([*words, "--odometry", "laser"]) == 0
    worlds = json.loads((tmp_path / "results.json").read_text())["worlds"]
    assert list(worlds) == ["cartographer/hall/0/out/laser"]
    assert worlds["cartographer/hall/0/out/laser"]["odometry"]["rmse_m"] < 0.02
    for spinning in ("left", "live"):
        assert main([*words, spinning, "--odometry", "laser"]) == 2
        assert f"leave out --spinning {spinning}" in capsys.readouterr().err


def test_an_interrupted_run_goes_on_and_tells_what_a_whole_one_tells(monkeypatch, tmp_path, capsys):
    drawn = []

    def counted(kind, seed, *, spinning):
        drawn.append((kind, seed))
        if len(drawn) == 3:
            raise KeyboardInterrupt
        return tiny(kind, seed)

    monkeypatch.setattr(drawn_worlds, "draw_drive", counted)
    words = ["bench", "drawn-worlds", "--kinds", "hall", "cave", "--seeds", "0", "1", "--out"]
    assert main([*words, str(tmp_path / "cut")]) == 130
    assert main([*words, str(tmp_path / "cut")]) == 0
    assert drawn == [("hall", 0), ("cave", 0), ("hall", 1), ("hall", 1), ("cave", 1)]
    assert main([*words, str(tmp_path / "whole")]) == 0
    cut, whole = (json.loads((tmp_path / name / "results.json").read_text()) for name in ("cut", "whole"))
    assert without_timing(cut["worlds"]) == without_timing(whole["worlds"])
    assert cut["summary"]["cartographer/all"]["n"] == 4
    assert "cartographer/cave" in capsys.readouterr().out


def test_the_summary_counts_worlds_by_kind_and_all_together():
    def row(rmse, losses):
        timing = {"scans_per_s": 100.0, "p99_ms": 5.0, "max_ms": 9.0}
        error = {"rmse_m": rmse, "max_m": 2.0 * rmse}
        return {
            "final": error, "local": error, "odometry": error, "not_located": 0.5, "beyond": 0.1, "losses": losses,
            "closures": {"count": 3, "wrong": 1}, "timing": timing,
        }  # fmt: skip

    rows = {"cartographer/hall/0": row(0.1, 0), "cartographer/hall/1": row(0.5, 2), "cartographer/cave/0": row(0.2, 1)}
    summed = drawn_worlds.summary(rows)
    assert list(summed) == ["cartographer/all", "cartographer/cave", "cartographer/hall"]
    assert summed["cartographer/all"]["final"]["median_m"] == pytest.approx(0.2)
    assert summed["cartographer/all"]["losses"] == 3
    assert summed["cartographer/all"]["final"]["large"]["mean"] == pytest.approx(1.0 / 3.0)
    assert summed["cartographer/hall"]["closures"] == {"count": 6, "wrong": 2}
    assert "1 of 3" in drawn_worlds.table(summed)


def test_seeds_in_the_wrong_order_are_refused(capsys, tmp_path):
    assert main(["bench", "drawn-worlds", "--out", str(tmp_path / "out"), "--seeds", "3", "1"]) == 2
    assert "--seeds: the first must not be larger than the last, got 3 1" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
