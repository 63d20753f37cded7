"""The judge of loop closures knows right ones from wrong ones; the cells of the experiment cover what they claim."""

import gzip
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.benchmarks import graph_slam
from tagalong.scripts.benchmarks.acceptance_table import result_rows
from tagalong.scripts.benchmarks.intel_reference import (
    CORRECTED,
    corrected_poses,
    corrected_readings,
    published_poses,
    related_poses,
)
from tagalong.scripts.cli import main
from tagalong.slam import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.logs import read_carmen


def tie(node, pose, *, searched):
    """A constraint between the first submap and a node, as the engine tells it."""
    return SimpleNamespace(submap=0, node=node, pose=pose, kind=graph_slam.Kind.INTER, searched=searched)


def test_a_closure_is_right_within_20_cm_and_1_degree_of_the_reference():
    rng = np.random.default_rng(0)
    truth = np.column_stack((rng.uniform(-5.0, 5.0, (200, 2)), rng.uniform(-3.0, 3.0, 200)))
    submap = compose(truth[0], [0.3, -0.2, 0.5])
    offsets = [(0.0, 0.0, 0.0), (0.19, 0.0, 0.0), (0.21, 0.0, 0.0), (0.0, 0.0, np.radians(1.5)), (0.0, 0.0, 0.01)]
    made, drawn = [], {0: between(submap, truth[0])}
    for k, offset in enumerate(offsets):
        node = 150 + k
        seen = compose(between(submap, truth[node]), offset)
        made.append(tie(node, seen, searched=k != 1))
    made.append(tie(20, np.zeros(3), searched=False))  # too near the submap in time to count
    engine = SimpleNamespace(node_scans=list(range(200)), constraints=tuple(made), submap_nodes=[drawn])
    judged = graph_slam.closures(engine, truth)  # pyright: ignore[reportArgumentType]
    assert judged["searched"] == {"count": 4, "right": 2, "near": 3}
    assert judged["returned"] == {"count": 5, "right": 3, "near": 4}


def test_a_submap_lies_where_the_reference_puts_most_of_its_nodes():
    truth = np.column_stack((np.arange(12.0), np.zeros(12), np.zeros(12)))
    made, off = (tie(11, truth[11], searched=True),), np.radians(3.0)
    engine = SimpleNamespace(
        node_scans=list(range(12)), constraints=made, submap_nodes=[{k: truth[k] for k in range(11)}]
    )
    for noisy, right in (([0], 1), ([0, 1, 2, 3, 4], 1), ([0, 1, 2, 3, 4, 5, 6], 0), ([11], 0)):
        reference = truth.copy()
        reference[noisy, 2] += off
        judged = graph_slam.closures(engine, reference)  # pyright: ignore[reportArgumentType]
        assert judged["searched"]["right"] == right, noisy


def test_corrected_scans_are_readings_by_the_order_of_the_lines(tmp_path):
    words = ["PARAM", "ODOM", "ODOM", "FLASER", "ODOM", "ODOM", "FLASER", "NEFF", "ODOM", "ODOM", "ODOM", "FLASER"]
    with gzip.open(tmp_path / "log.gz", "wt") as lines:
        lines.writelines(f"{word} 1.0 2.0\n" for word in words)
    assert corrected_readings(tmp_path / "log.gz").tolist() == [1, 2, 4]


@pytest.mark.parametrize(
    ("words", "missing"), [("graph-slam none none", "none/slam_logs"), ("kidnapping none", "none")]
)
def test_the_benchmarks_of_logs_say_what_they_need(tmp_path, monkeypatch, capsys, words, missing):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", words.split()[0]]) == 2
    assert "required: " in capsys.readouterr().err
    assert main(["bench", *words.split()]) == 2
    assert f"{missing} is not a folder" in capsys.readouterr().err
    assert not [path for path in tmp_path.rglob("*") if path.suffix == ".json"]


def test_every_cell_has_a_name_of_its_own_and_every_drive_with_people_is_mapped_three_ways(tmp_path):
    cells = graph_slam.cells(tmp_path, tmp_path)
    assert len({cell.name for cell in cells}) == len(cells)
    names = [cell.name for cell in cells if "meeting-2p" in cell.name]
    assert [name.split(" ", 1)[1] for name in names] == ["raw", "true filter", "own tracker"]


def test_graph_slam_has_its_row_in_the_table_of_results():
    rows = result_rows({"graph/intel/0": {"relation_m": 0.021}, "logs/intel/0": {"relation_m": 0.028}})
    assert [row[0] for row in rows] == [
        f"Intel log, {name}: mean relation error [m]" for name in ("GMapping", "graph SLAM")
    ]


def test_the_references_of_the_intel_log_agree_with_each_other(data_folder):
    logs = data_folder / "slam_logs"
    drive = read_carmen(logs / "intel_every5th.log.gz")
    local = make_slam("cartographer", global_=None)
    for odometry, scan in zip(drive.odometry[:900], drive.scans[:900], strict=True):
        local.update(odometry, scan)
    part = replace(drive, odometry=drive.odometry[:900], scans=drive.scans[:900])
    every = published_poses(logs, drive)
    published, corrected = every[:900], corrected_poses(logs, part, local.trajectory())
    known = corrected_readings(logs / CORRECTED)
    same = np.isin(5 * np.arange(1, 900) - 4, known).nonzero()[0] + 1  # scan k is reading 5 k - 4 (README of the logs)
    readings = np.searchsorted(known, 5 * same - 4)
    exact = read_carmen(logs / CORRECTED).odometry[readings]
    assert len(same) > 40
    np.testing.assert_allclose(published[same], exact, atol=1e-3)
    apart = between(published, corrected)
    assert np.median(np.hypot(apart[:, 0], apart[:, 1])) < 0.05
    assert np.degrees(np.median(np.abs(apart[:, 2]))) < 0.5
    related = related_poses(logs, drive, every)
    apart = between(every, compose(every[0], between(related[0], related)))
    assert np.median(np.hypot(apart[:, 0], apart[:, 1])) < 0.3


@pytest.fixture
def data_folder() -> Path:
    folder = os.environ.get("TAGALONG_DATA")
    if not folder or not (Path(folder) / "slam_logs").is_dir():
        pytest.skip("needs the recorded logs: set TAGALONG_DATA")
    return Path(folder)
