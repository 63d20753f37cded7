import argparse
import gzip
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.scripts.lab.cells import run_cells
from tagalong.scripts.lab.scan_pairs import blind_direction, simulated_scans, split_trials, with_people
from tagalong.scripts.lab.statistics import Estimate
from tagalong.scripts.reproduce.scan_matching import EXPERIMENT
from tagalong.scripts.reproduce.scan_matching.answers import crossing
from tagalong.scripts.reproduce.scan_matching.claims import about
from tagalong.scripts.reproduce.scan_matching.degenerate import degenerate
from tagalong.scripts.reproduce.scan_matching.experiment import left_out
from tagalong.scripts.reproduce.scan_matching.plan import Extent, MatchingPlan
from tagalong.scripts.reproduce.scan_matching.real_pairs import known_rooms, read_pairs
from tagalong.scripts.reproduce.scan_matching.searches import exact
from tagalong.scripts.reproduce.scan_matching.success import success
from tagalong.slam import InputError, LaserScan
from tagalong.slam.scan_to_scan import MATCHERS

TINY = Extent(
    rotations=(0.0, 20.0, 180.0),
    translations=(0.0, 0.57),
    trials=2,
    point_trials=4,
    exact_trials=1,
    pairs=2,
    near_pairs=3,
    consecutive=3,
    step=7,
)


def options(tmp_path, **changes):
    asked = {"quick": True, "trials": None, "pairs": None, "data": None, "out": tmp_path}
    return argparse.Namespace(**{**asked, **changes})


def test_without_data_the_simulated_part_runs_and_the_report_says_what_is_left_out(tmp_path, monkeypatch):
    monkeypatch.setattr("tagalong.scripts.reproduce.scan_matching.experiment.QUICK", TINY)
    asked = options(tmp_path)
    results = run_cells(EXPERIMENT.cells(asked), tmp_path / "cells")
    (tmp_path / "figures").mkdir()
    report = EXPERIMENT.report(results, asked, tmp_path / "figures")
    assert "all recorded scans (no --data)" in report.lead
    assert report.results["sources"] == ["simulated"]
    figures = [figure for section in report.sections for figure in section.figures]
    assert {"fig-2", "fig-3", "fig-4", "fig-5", "fig-6", "fig-7"} <= {figure.file.name[:5] for figure in figures}
    assert all(figure.file.is_file() for figure in figures)
    for section in report.sections:
        for table in section.tables:
            assert all(len(row) == len(table.columns) for row in table.rows)
    assert all(claim["verdict"] for claim in report.results["claims"])


def test_with_logs_there_are_corridors_real_pairs_and_speeds_too(tmp_path):
    logs = tmp_path / "slam_logs"
    logs.mkdir()
    for name in ("intel_every5th.log.gz", "intel.gfs.log.gz"):
        (logs / name).touch()
    plan = MatchingPlan(TINY, logs, None)
    cells = plan.cells()
    names = [cell.name for cell in cells]
    assert {name.split("/")[0] for name in names} >= {"corridor", "distance", "views", "consecutive", "exact"}
    assert plan.sources == ("intel",)
    assert "viewpoints of aces (not in the data)" in left_out(plan)
    by_name = {cell.name: cell for cell in cells}
    assert all(by_name[cell.name].arguments == cell.arguments for cell in cells)


def test_equal_cells_give_equal_figures_whatever_the_clock():
    first, second = (success(None, ["simulated"], "hglasm-g-small", 0.57, 20.0, 5, people=2, noise=0.01) for _ in "ab")
    assert first.pop("timing").keys() == second.pop("timing").keys()
    assert first == second


def test_global_finds_what_trying_every_pose_finds():
    assert exact(None, "simulated", 3) == {"equal": 3, "equal_views": 3, "trials": 3}


@pytest.mark.skipif("TAGALONG_DATA" not in os.environ, reason="recorded scans are read from TAGALONG_DATA")
def test_on_recorded_scans_too():
    folder = Path(os.environ["TAGALONG_DATA"]) / "slam_logs"
    assert exact(str(folder), "intel", 3) == {"equal": 3, "equal_views": 3, "trials": 3}


@pytest.mark.parametrize("matcher", MATCHERS)
def test_no_matcher_is_confidently_wrong_about_scans_that_say_little(matcher):
    for kind, count in degenerate(matcher, 5)["kinds"].items():
        assert count["confidently_wrong"] == 0, kind
        assert count["finite"] == 5, kind
        assert count["blind"] == count["believed"], kind


def test_verdicts_follow_the_interval():
    assert about(Estimate(0.91, 0.88, 0.93, 500), 0.90) == "confirmed"
    assert about(Estimate(0.99, 0.98, 1.0, 500), 0.85) == "confirmed and better, 99%"
    assert about(Estimate(0.99, 0.98, 1.0, 500), 0.20, merit=False).startswith("not so: higher")
    assert about(Estimate(0.70, 0.66, 0.74, 500), 0.85).startswith("not so: lower")


def test_a_cost_is_read_between_two_points_on_a_logarithmic_scale():
    cost, share = np.array([10.0, 100.0, 1000.0]), np.array([0.5, 0.8, 1.0])
    assert crossing(cost, share, 0.9) == pytest.approx(10**2.5)
    assert crossing(cost, share, 0.4) == 10.0
    assert crossing(cost, share * 0.8, 0.9) == np.inf


def test_each_scan_is_asked_about_once_before_any_is_asked_again():
    scans = simulated_scans()[:7]
    firsts = [trial.reference.ranges[3] for trial in split_trials(scans, 17, 0.5, 0.1, 0)]
    assert len(set(firsts[:7])) == len(set(firsts[7:14])) == 7
    assert len(firsts) == 17
    assert split_trials(scans, 0, 0.5, 0.1, 0) == []


def test_people_stand_before_the_walls_and_walk_on_between_the_scans():
    scan = LaserScan(np.full(180, 5.0), np.radians(np.arange(-90.0, 90.0)), 0.05, 30.0)
    seen = with_people(scan, np.array([[2.0, 0.0]]), np.array([np.pi]))
    hit = np.degrees(seen.bearings[seen.ranges < 4.9])
    assert 3 < len(hit) < 12
    assert np.abs(hit).max() < 8
    (trial,) = split_trials([scan], 1, 0.0, 0.0, 0, people=3)
    apart = np.abs(trial.reference.ranges - trial.new.ranges)
    assert (apart > 0.5).any()


def test_a_corridor_has_a_blind_direction_and_a_room_has_none():
    bearings = np.radians(np.arange(-90.0, 90.0))
    with np.errstate(divide="ignore"):
        walls = np.minimum(1.2 / np.abs(np.sin(bearings)), 20.0)
        axis = blind_direction(LaserScan(np.where(walls < 15, walls, np.inf), bearings, 0.05, 20.0))
        room = np.minimum(walls, 3.0 / np.maximum(np.cos(bearings), 1e-9))
    assert axis is not None
    assert abs(axis[0]) > 0.99
    assert blind_direction(LaserScan(room, bearings, 0.05, 20.0)) is None


def test_pairs_files_are_read_and_bad_lines_named(tmp_path):
    ranges = " ".join(f"{r:.3f}" for r in simulated_scans()[0].ranges[:60])
    file = tmp_path / "x.pairs.txt.gz"
    file.write_bytes(gzip.compress(f"header\n7 0.05 0 0.02 60 {ranges} {ranges}\n".encode()))
    with pytest.raises(InputError, match=r"x\.pairs_gt\.txt"):
        read_pairs(file)
    (tmp_path / "x.pairs_gt.txt").write_text("7 0 0 0\n")
    assert known_rooms(str(file), "plicp", 1)["pairs"] == 1
    file.write_bytes(gzip.compress(b"header\n7 0.05 0 0.02 60 1 2\n"))
    with pytest.raises(InputError, match=r"pairs\.txt\.gz:2"):
        read_pairs(file)


def test_bad_options_are_named(tmp_path):
    with pytest.raises(InputError, match="--trials"):
        EXPERIMENT.cells(options(tmp_path, trials=3))
    with pytest.raises(InputError, match="--pairs"):
        EXPERIMENT.cells(options(tmp_path, pairs=tmp_path / "none"))
