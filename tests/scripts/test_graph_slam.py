"""The judge of loop closures knows right ones from wrong ones; the cells of the experiment cover what they claim."""

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tagalong.scripts.experiments import graph_slam
from tagalong.scripts.experiments.intel_reference import corrected_poses, related_poses
from tagalong.scripts.results_table import result_rows
from tagalong.slam.geometry import between, compose
from tagalong.slam.graph.constraints import Constraint, Kind
from tagalong.slam.logs.carmen import read_carmen


def test_a_closure_is_right_within_20_cm_and_1_degree_of_the_reference():
    rng = np.random.default_rng(0)
    truth = np.column_stack((rng.uniform(-5.0, 5.0, (200, 2)), rng.uniform(-3.0, 3.0, 200)))
    submap = compose(truth[0], [0.3, -0.2, 0.5])
    offsets = [(0.0, 0.0, 0.0), (0.19, 0.0, 0.0), (0.21, 0.0, 0.0), (0.0, 0.0, np.radians(1.5)), (0.0, 0.0, 0.01)]
    made = [Constraint(0, 0, between(submap, truth[0]), np.eye(3), Kind.INTRA)]
    for k, offset in enumerate(offsets):
        node = 150 + k
        seen = compose(between(submap, truth[node]), offset)
        made.append(Constraint(0, node, seen, np.eye(3), Kind.INTER, searched=k != 1))
    made.append(Constraint(0, 20, np.zeros(3), np.eye(3), Kind.INTER))  # too near the submap in time to count
    engine = SimpleNamespace(node_scans=list(range(200)), constraints=tuple(made))
    judged = graph_slam.closures(engine, truth)  # pyright: ignore[reportArgumentType]
    assert judged["searched"] == {"count": 4, "right": 2, "near": 3}
    assert judged["returned"] == {"count": 5, "right": 3, "near": 4}


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
    corrected = corrected_poses(logs, drive)
    related = related_poses(logs, drive, corrected)
    apart = between(corrected, compose(corrected[0], between(related[0], related)))
    assert np.median(np.hypot(apart[:, 0], apart[:, 1])) < 0.3


@pytest.fixture
def data_folder() -> Path:
    folder = os.environ.get("TAGALONG_DATA")
    if not folder or not (Path(folder) / "slam_logs").is_dir():
        pytest.skip("needs the recorded logs: set TAGALONG_DATA")
    return Path(folder)
