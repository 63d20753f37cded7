import importlib.util
import json
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tagalong.scripts.lab.cells import Cell, files_of, run_cells
from tagalong.scripts.lab.hardware import code_fingerprint
from tagalong.slam.errors import MissingExtraError


def square(value, log):
    with Path(log).open("a") as file:
        file.write(f"{value}\n")
    return {"square": value * value}


def broken(value, log):
    raise RuntimeError("boom")


@pytest.fixture
def log(tmp_path):
    return str(tmp_path / "log.txt")


def cells(log, values=(1, 2, 3), function=square):
    return [Cell(name=f"part/{v}", function=function, arguments={"value": v, "log": log}) for v in values]


def test_results_come_back_by_name_in_the_order_of_the_cells(tmp_path, log):
    results = run_cells(cells(log, (3, 1, 2)), tmp_path)
    assert [(k, v["square"]) for k, v in results.items()] == [("part/3", 9), ("part/1", 1), ("part/2", 4)]


def test_finished_cells_are_not_run_again(tmp_path, log):
    run_cells(cells(log, (1, 2)), tmp_path)
    results = run_cells(cells(log, (1, 2, 3)), tmp_path)
    assert Path(log).read_text().split() == ["1", "2", "3"]
    assert results["part/3"]["square"] == 9


def test_a_cell_with_other_arguments_or_a_cut_file_is_made_anew(tmp_path, log):
    run_cells(cells(log, (1, 2)), tmp_path)
    (tmp_path / "part/1.json").write_text("{")
    changed = json.loads((tmp_path / "part/2.json").read_text())
    changed["arguments"]["value"] = 7
    (tmp_path / "part/2.json").write_text(json.dumps(changed))
    run_cells(cells(log, (1, 2)), tmp_path)
    assert Path(log).read_text().split() == ["1", "2", "1", "2"]


def test_a_failing_cell_leaves_the_finished_ones_and_no_file_of_its_own(tmp_path, log):
    with pytest.raises(RuntimeError, match="boom"):
        run_cells([*cells(log, (1,)), *cells(log, (5,), broken)], tmp_path)
    assert (tmp_path / "part/1.json").exists()
    assert not (tmp_path / "part/5.json").exists()


def write_number(value, files):
    (files / "number.txt").write_text(str(value))
    return {}


def add_numbers(inputs):
    return {"sum": sum(int((folder / "number.txt").read_text()) for folder in inputs)}


def test_a_cell_finds_the_files_of_those_that_it_needs(tmp_path):
    numbers = [Cell(name=f"n/{v}", function=write_number, arguments={"value": v}, keeps_files=True) for v in (3, 4)]
    total = Cell(name="sum", function=add_numbers, arguments={}, needs=("n/3", "n/4"))
    assert run_cells([*numbers, total], tmp_path, jobs=2)["sum"] == {"sum": 7}
    (tmp_path / "sum.json").unlink()
    assert run_cells([*numbers, total], tmp_path)["sum"] == {"sum": 7}


def test_what_needs_a_cell_that_is_made_anew_is_made_anew_too(tmp_path):
    def run(value):
        number = Cell(name="n", function=write_number, arguments={"value": value}, keeps_files=True)
        return run_cells([number, Cell(name="sum", function=add_numbers, arguments={}, needs=("n",))], tmp_path)["sum"]

    assert run(3) == {"sum": 3}
    assert run(4) == {"sum": 4}
    shutil.rmtree(files_of("n", tmp_path))
    assert run(4) == {"sum": 4}
    assert (files_of("n", tmp_path) / "number.txt").exists()


@pytest.mark.parametrize("content", [b"[]", b"{}", b"\xff\xfe", b""])
def test_a_file_that_is_no_result_is_made_anew(tmp_path, log, content):
    run_cells(cells(log, (1,)), tmp_path)
    (tmp_path / "part/1.json").write_bytes(content)
    assert run_cells(cells(log, (1,)), tmp_path)["part/1"] == {"square": 1}


def test_results_of_other_code_are_kept_and_counted(tmp_path, log, monkeypatch, capsys):
    run_cells(cells(log, (1, 2)), tmp_path)
    run_cells(cells(log, (1, 2, 3)), tmp_path)
    assert "other code" not in capsys.readouterr().err
    monkeypatch.setattr("tagalong.scripts.lab.cells.code_fingerprint", lambda: "another")
    assert run_cells(cells(log, (1, 2, 3, 4)), tmp_path)["part/4"]["square"] == 16
    said = [line for line in capsys.readouterr().err.splitlines() if line.startswith("tagalong: ")]
    assert len(said) == 1
    assert f"3 of 3 finished cells in {tmp_path} were made by other code" in said[0]
    assert Path(log).read_text().split() == ["1", "2", "3", "4"]


def test_the_fingerprint_of_the_code_is_the_same_every_time():
    assert code_fingerprint() == code_fingerprint.__wrapped__()
    assert re.fullmatch("[0-9a-f]{16}", code_fingerprint())


_KILLED = """
import sys, time
from pathlib import Path
from tagalong.scripts.lab.cells import Cell, files_of, run_cells
from tagalong.scripts.lab.hardware import code_fingerprint
from tagalong.slam.errors import MissingExtraError

def slow(value):
    time.sleep(0.05)
    return {"square": value * value}

run_cells([Cell(name=f"c/{v}", function=slow, arguments={"value": v}) for v in range(12)], sys.argv[1])
"""


def test_an_experiment_killed_at_any_moment_resumes_to_the_same_results(tmp_path):
    for wait in (0.05, 0.15, 0.25):
        child = subprocess.Popen([sys.executable, "-c", _KILLED, str(tmp_path / "a")], stderr=subprocess.DEVNULL)
        while child.poll() is None and not list((tmp_path / "a").rglob("*.json")):
            time.sleep(0.02)
        time.sleep(wait)
        child.kill()
        child.wait()
    for name in ("a", "b"):
        subprocess.run([sys.executable, "-c", _KILLED, str(tmp_path / name)], check=True, stderr=subprocess.DEVNULL)
    stored = [{p.name: p.read_bytes() for p in (tmp_path / n / "c").glob("[!.]*.json")} for n in ("a", "b")]
    assert stored[0] == stored[1]
    assert len(stored[0]) == 12


@pytest.mark.parametrize(("backend", "package"), [("ray", "ray"), ("dask", "distributed")])
def test_a_local_cluster_gives_the_same_results(tmp_path, log, backend, package):
    pytest.importorskip(package, reason=f"{package} is not installed (extra cluster)")
    assert run_cells(cells(log), tmp_path / "a", jobs=2, backend=backend) == run_cells(cells(log), tmp_path / "b")


@pytest.mark.parametrize(("backend", "package"), [("ray", "ray"), ("dask", "distributed")])
def test_a_missing_cluster_package_is_answered_with_the_pip_command(tmp_path, log, backend, package):
    if importlib.util.find_spec(package):
        pytest.skip(f"{package} is installed")
    with pytest.raises(MissingExtraError, match=r"pip install \"tagalong\[cluster\]\""):
        run_cells(cells(log), tmp_path, jobs=2, backend=backend)
