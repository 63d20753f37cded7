"""The robustness bench: what counts as off, as told and as a miss; its cells; drawn campus corridors."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.scripts.benchmarks import slam_faults, slam_scale
from tagalong.scripts.benchmarks.fault_drives import FaultDrive, ScanRelations, fault_drive, related_truth, world_names
from tagalong.scripts.benchmarks.fault_scores import aligned_distances, honesty
from tagalong.scripts.benchmarks.fault_verdicts import faulty_cells, verdicts
from tagalong.scripts.cli import main
from tagalong.slam import LaserScan, RecordedDrive, SlamUpdate
from tagalong.slam.geometry import between, compose


def ring(count=200):
    angles = np.linspace(0.0, 2.0 * np.pi, count)
    return np.column_stack((10.0 * np.cos(angles), 10.0 * np.sin(angles), (angles + 1.5 * np.pi) % (2 * np.pi) - np.pi))


def test_what_is_far_off_does_not_draw_the_rest_away():
    truth = ring()
    estimate = compose((3.0, 1.0, 0.7), truth)
    estimate[120:180, 0] += 40.0
    distances = aligned_distances(estimate, truth)
    assert distances[:120].max() < 0.02
    assert distances[120:180].min() > 39.0


def test_a_stretch_is_told_by_one_scan_in_it_and_a_short_one_need_not_be():
    truth = ring()
    estimate, located = truth.copy(), np.ones(200, dtype=np.bool_)
    estimate[10:40, 1] += 5.0
    estimate[60:120, 1] += 5.0
    located[[20, 190]] = False
    silent = honesty(estimate, located, truth)
    assert (silent.stretches, silent.told) == (1, 0)
    assert silent.wrongly_told == pytest.approx(1.0 / 200.0)
    located[119] = False
    assert honesty(estimate, located, truth).told == 1


def test_relations_to_missing_scans_are_carried_on_by_the_odometry():
    truth = ring()
    pairs = np.array([(0, 50), (3, 103), (10, 199)])
    relations = ScanRelations(pairs, between(truth[pairs[:, 0]], truth[pairs[:, 1]]))
    scans = [LaserScan(np.ones(3), np.arange(3.0), 0.0, 5.0, float(k)) for k in range(200)]
    drive = FaultDrive(RecordedDrive(compose((9.0, 0.0, 1.0), truth), scans, None, "ring"), relations)
    for origin in (np.arange(0, 200, 4), np.arange(199, -1, -1), np.sort(np.repeat(np.arange(200), 2))):
        assert drive.error(truth[origin], origin)["m"] < 1e-9
    with_gap = np.concatenate((np.arange(40), np.arange(60, 200)))
    assert drive.error(truth[with_gap], with_gap)["m"] < 1e-9
    drifting = truth * (1.1, 1.1, 1.0)
    drifting[:, 2] += 0.001 * np.arange(200)
    assert drive.error(related_truth(drive, drifting), np.arange(200))["m"] < 0.1


def result(error, **more):
    plain = {"scans": 100, "error": {"m": error, "deg": 0.1}, "online": {"m": error, "deg": 0.1}, "located": 1.0}
    timing = {"processor_s": 1.0, "p99_ms": 2.0, "memory_mb": 3.0}
    return {**plain, "off": 0.0, "stretches": 0, "told": 0, "wrongly_told": 0.0, "timing": timing, **more}


def test_the_verdicts_name_the_cells_that_miss_them():
    results = {
        "truth/hall": {},
        "hall/none/cartographer": result(0.05, wrongly_told=0.05),
        "hall/none/gmapping": result(0.1),
        "hall/none/cartographer without recovery": result(0.05),
        "hall/slip/cartographer": result(0.9, stretches=2, told=1),
        "hall/slip/gmapping": result(0.4),
        "hall/slip/cartographer without recovery": result(0.9),
        "hall/gap/cartographer": {"scans": 100, "failed": "InputError: too large"},
        "hall/gap/gmapping": result(5.0),
        "hall/gap/cartographer without recovery": result(9.0),
        "hall/people/cartographer": result(0.29),
        "hall/people/gmapping": result(0.01),
        "hall/people/cartographer without recovery": result(0.1),
    }
    rival, undisturbed, recovery, told, wrongly = verdicts(faulty_cells(results))[:5]
    assert [cell.split(":")[0] for cell in rival.missed] == ["hall/gap", "hall/slip"]
    assert "InputError" in rival.missed[0]
    assert not undisturbed.holds
    assert undisturbed.found == "1 of 3 cells (33.3%)"
    assert [cell.split(":")[0] for cell in recovery.missed] == ["hall/gap", "hall/people"]
    assert told.missed == ["hall/slip: 1 of 2 stretches told, 0.900 m"]
    assert not wrongly.holds
    assert wrongly.missed == ["hall: 5.0%"]


class Believer:
    """Believes the odometry; fails where a scan has no return."""

    def __init__(self):
        self._poses = []

    def update(self, odometry, scan):
        if not scan.is_return.any():
            raise RuntimeError("blind")
        self._poses.append(odometry)
        return SlamUpdate(odometry, True, {})

    def finish(self):
        pass

    def trajectory(self):
        return np.array(self._poses)


def small(folder, name):
    del folder
    poses = np.column_stack((0.2 * np.arange(120.0), np.zeros((120, 2))))
    scans = [LaserScan(np.full(20, 7.0), np.linspace(-1.0, 1.0, 20), 0.1, 9.0, 0.1 * k) for k in range(120)]
    return FaultDrive(RecordedDrive(poses, scans, poses, name), None)


def test_the_bench_measures_writes_and_reports_and_goes_on_where_it_was(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(slam_faults, "fault_drive", small)
    monkeypatch.setattr(slam_faults, "make_engine", lambda name: Believer())
    monkeypatch.setattr(slam_faults, "memory_mb", lambda: 100.0)
    monkeypatch.setattr(slam_faults, "give_back_memory", lambda: None)
    words = "bench slam-faults --worlds 1 --faults scale-0.8 reach-5.6 late-0.1 --engines gmapping cartographer --out"
    assert main([*words.split(), str(tmp_path / "out")]) == 1
    told = capsys.readouterr().out
    assert "RuntimeError: blind" in told
    written = json.loads((tmp_path / "out" / "results.json").read_text())
    assert set(written["results"]) >= {"office-0/none/gmapping", "office-0/scale-0.8/cartographer"}
    assert written["results"]["office-0/none/gmapping"]["error"]["m"] == pytest.approx(0.0, abs=1e-9)
    assert written["results"]["office-0/scale-0.8/gmapping"]["stretches"] == 0  # laid on the middle half
    page = (tmp_path / "out" / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    monkeypatch.setattr(slam_faults, "make_engine", None)
    assert main([*words.split(), str(tmp_path / "out")]) == 1


def test_what_cannot_be_measured_is_refused(tmp_path, capsys):
    out = ["--out", str(tmp_path / "out")]
    assert main(["bench", "slam-faults", "--logs", "aces", *out]) == 2
    assert "--logs needs the folder DATA" in capsys.readouterr().err
    assert main(["bench", "slam-faults", "--worlds", "0", *out]) == 2
    assert main(["bench", "slam-faults", str(tmp_path / "none"), *out]) == 2
    assert main(["bench", "slam-scale", "--sizes", "5", *out]) == 2
    assert "--sizes: must be a number within 20 .. 2000" in capsys.readouterr().err


def test_worlds_take_the_kinds_by_turns():
    names = world_names(7)
    assert names[0].rpartition("-")[0] == names[5].rpartition("-")[0]
    assert len(set(names)) == 7


def test_the_cost_of_a_drive_is_measured_piece_by_piece(monkeypatch):
    monkeypatch.setattr(slam_scale, "_new", lambda engine: Believer())
    monkeypatch.setattr(slam_scale, "memory_mb", lambda: 100.0)  # it collects garbage, which takes time in a test
    made = slam_scale.grown(20.0, 0.02, "cartographer", 0)
    assert len(made["timing"]["points"]) == slam_scale.POINTS
    assert made["km"] == pytest.approx(0.03, abs=0.015)
    assert "cartographer/20m" in slam_scale.table({"cartographer/20m/0.02km": made})


@pytest.mark.parametrize(("name", "metres"), [("aces", 5.4), ("intel", 7.4), ("csail", 1.7), ("intel-910", 24.0)])
def test_raw_odometry_of_a_recorded_log_is_as_far_off_as_is_known(name, metres):
    folder = os.environ.get("TAGALONG_DATA")
    if not folder or not (Path(folder) / "slam_logs").is_dir():
        pytest.skip("needs the recorded logs: set TAGALONG_DATA")
    drive = fault_drive(str(Path(folder) / "slam_logs"), name)
    said = drive.recording.odometry
    assert drive.error(said, np.arange(len(said)))["m"] == pytest.approx(metres, rel=0.02)
