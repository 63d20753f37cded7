"""All experiments at once: what is told beforehand, the pages that are written, and that finished cells are kept."""

import argparse

import numpy as np
import pytest
from PIL import Image
from tagalong.scripts.lab.cells import Cell
from tagalong.scripts.reproduce import evidence
from tagalong.scripts.reproduce.report import Figure, Report, Section, Table


def toss(seed):
    return {"heads": int(np.random.default_rng(seed).integers(2))}


class Coins:
    """An experiment for these tests."""

    name = "coins"

    def add_arguments(self, parser):
        parser.add_argument("--tosses", type=int, default=3)

    def cells(self, options):
        return [Cell(name=f"toss/{k}", function=toss, arguments={"seed": k}) for k in range(options.tosses)]

    def report(self, results, options, folder):
        Image.fromarray(np.full((40, 1500, 3), (200, 30, 30), np.uint8)).save(folder / "coin.png")
        table = Table(
            title="Heads", columns=("toss", "a|b"), rows=[(name, "1 < 2") for name in results], note="A note."
        )
        figure = Figure(file=folder / "coin.png", caption="A [red] coin")
        section = Section(title="Tosses", text="One.\n\nTwo_and_more.", tables=[table], figures=[figure])
        return Report(title="Coins & heads", lead="They fall.", sections=[section], results={})


@pytest.fixture
def options(tmp_path, monkeypatch):
    monkeypatch.setattr(evidence, "EXPERIMENTS", {"coins": "coins | fair ones"})
    monkeypatch.setattr(evidence, "load_experiment", lambda name: Coins())
    return argparse.Namespace(
        out=tmp_path / "out", pages=tmp_path / "pages", quick=True, jobs=1, backend="local", data=None
    )


def test_each_experiment_gets_a_page_with_its_tables_small_pictures_and_what_it_cost(options, tmp_path):
    evidence.run_all(options, ("coins",))
    page = (tmp_path / "pages/coins.md").read_text()
    assert page.startswith("# Coins & heads\n\nThey fall.\n\n*Measured on ")
    assert "Made by `tagalong reproduce coins --quick`" in page.replace("\\`", "`")
    assert "| toss | a\\|b |\n| :--- | ---: |\n| toss/0 | 1 &lt; 2 |" in page
    assert "One.\n\nTwo\\_and\\_more." in page
    assert "![A \\[red\\] coin](coins/coin.png)" in page
    with Image.open(tmp_path / "pages/coins/coin.png") as picture:
        assert picture.size == (1000, 27)
        assert picture.mode == "P"
    index = (tmp_path / "pages/index.md").read_text()
    assert "[coins](coins.md) | coins \\| fair ones | 0.00 |" in index


def test_what_is_missing_is_told_beforehand_and_what_is_finished_is_kept(options, tmp_path, capsys):
    evidence.run_all(options, ("coins",))
    assert "not known yet" in capsys.readouterr().err
    kept = {path: path.stat().st_mtime_ns for path in (tmp_path / "out/coins/cells/toss").glob("*.json")}
    (tmp_path / "out/coins/cells/toss/1.json").unlink()
    evidence.run_all(options, ("coins",))
    told = capsys.readouterr().err
    assert told.splitlines()[2].split() == ["coins", "3", "1", "0.00"]
    after = {path: path.stat().st_mtime_ns for path in (tmp_path / "out/coins/cells/toss").glob("*.json")}
    assert [path.name for path in kept if after[path] != kept[path]] == ["1.json"]
