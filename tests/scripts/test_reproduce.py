import argparse
import json
import re
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tagalong.scripts.lab.backends import runner
from tagalong.scripts.lab.cells import Cell, without_timing
from tagalong.scripts.reproduce.experiment import EXPERIMENTS, Experiment, load_experiment
from tagalong.scripts.reproduce.report import Figure, Report, Section, Table
from tagalong.scripts.reproduce.run import run_experiment
from tagalong.slam import InputError


def throw(seed, files):
    eyes = np.random.default_rng(seed).integers(1, 7, 3)
    np.savez(files / "eyes.npz", eyes=eyes)
    return {"sum": int(eyes.sum()), "timing": {"wall_s": time.perf_counter()}}


class Dice:
    """An experiment for these tests."""

    name = "dice"

    def add_arguments(self, parser):
        pass

    def cells(self, options):
        count = 2 if options.quick else 3
        return [Cell(name=f"throw/{k}", function=throw, arguments={"seed": k}, keeps_files=True) for k in range(count)]

    def report(self, results, options, folder):
        Image.new("RGB", (4, 3)).save(folder / "box.png")
        eyes = np.load(options.out / "cells/throw/0.files/eyes.npz")["eyes"]
        rows = [(name, str(result["sum"])) for name, result in results.items()]
        section = Section(
            title="Throws & <sums>",
            text="First.\n\nSecond.",
            tables=[Table(title="Sums", columns=("throw", "sum"), rows=rows, note=f"eyes {eyes.tolist()}")],
            figures=[Figure(file=folder / "box.png", caption="A box")],
        )
        numbers = {"mean": float(np.mean([r["sum"] for r in results.values()])), "timing": {"mean_s": 1.0}}
        return Report(title="Dice", lead="They fall.", sections=[section], results=numbers)


@pytest.fixture
def options(tmp_path):
    return argparse.Namespace(out=tmp_path, quick=False, jobs=1, backend="local", data=None, sides=6)


def test_results_are_the_same_bytes_after_an_interruption_and_hold_no_clock(options, tmp_path):
    run_experiment(Dice(), options)
    first = (tmp_path / "results.json").read_bytes()
    (tmp_path / "cells/throw/1.json").unlink()
    run_experiment(Dice(), options)
    assert (tmp_path / "results.json").read_bytes() == first
    content = json.loads(first)
    assert content["settings"] == {"quick": False, "data": False, "sides": 6}
    assert "timing" not in content["results"]
    assert "timing" not in content["cells"]["throw/0"]


def test_times_stand_in_their_own_file(options, tmp_path):
    run_experiment(Dice(), options)
    timing = json.loads((tmp_path / "timing.json").read_text())
    assert set(timing["cells"]) == {"throw/0", "throw/1", "throw/2"}
    assert timing["results"] == {"timing": {"mean_s": 1.0}}


def test_the_page_needs_nothing_but_itself_and_escapes_words(options, tmp_path):
    run_experiment(Dice(), options)
    page = (tmp_path / "report.html").read_text()
    assert "Throws &amp; &lt;sums&gt;" in page
    assert "data:image/png;base64," in page
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "<script" not in page


def test_quick_is_the_same_with_fewer_cells(options):
    options.quick = True
    assert [cell.name for cell in Dice().cells(options)] == ["throw/0", "throw/1"]


def test_timing_is_taken_out_at_any_depth():
    assert without_timing({"a": [{"timing": 1, "b": 2}], "timing": 3}) == {"a": [{"b": 2}]}


def test_an_unknown_backend_is_named():
    with pytest.raises(InputError, match="unknown backend 'slurm'"), runner("slurm", 2):
        pass


def test_an_unknown_experiment_is_named():
    with pytest.raises(InputError, match="unknown experiment 'nothing'"):
        load_experiment("nothing")


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_every_experiment_declares_quick_cells_with_unique_names(name, options):
    experiment = load_experiment(name)
    assert isinstance(experiment, Experiment)
    assert experiment.name == name
    parser = argparse.ArgumentParser()
    experiment.add_arguments(parser)
    assert "tagalong reproduce" in (parser.epilog or "")
    options = argparse.Namespace(**{**vars(options), **vars(parser.parse_args([])), "quick": True})
    names = [cell.name for cell in experiment.cells(options)]
    assert names
    assert len(set(names)) == len(names)
    assert not any(Path(name).is_absolute() for name in names)


def test_a_folder_that_cannot_be_written_is_named(options, tmp_path):
    (tmp_path / "file").write_text("")
    options.out = tmp_path / "file" / "out"
    with pytest.raises(InputError, match=r"file/out: cannot be made"):
        run_experiment(Dice(), options)
