"""Every example runs, and prints something."""

import runpy
from pathlib import Path

import pytest

NEEDS = {"11_clone_a_follower": "minari"}
"""Example -> what it needs that not everybody has."""
EXAMPLES = sorted((Path(__file__).resolve().parents[1] / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(example, capsys, monkeypatch):
    pytest.importorskip(NEEDS.get(example.stem, "tagalong"))
    monkeypatch.setenv("MINARI_DATASETS_PATH", "")  # what an example sets ends with its test
    runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out
