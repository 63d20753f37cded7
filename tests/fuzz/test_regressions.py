"""Inputs that once crashed, hung, or were accepted: each is refused in one line now, or gives a sane result."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from fuzzer.codec import read_finding

HERE = Path(__file__).parent
FILES = sorted((HERE / "regressions").rglob("*.json"))


@pytest.fixture(scope="module")
def findings(tmp_path_factory):
    """What the suite finds among all regressions, sent once, in children that may crash: lines by border."""
    out = tmp_path_factory.mktemp("fuzz")
    command = [sys.executable, HERE / "run.py", "--replay", HERE / "regressions", "--out", out]
    said = subprocess.run(command, capture_output=True, text=True, timeout=280, env=dict(os.environ))
    assert (out / "summary.json").exists(), said.stderr
    borders = json.loads((out / "summary.json").read_text())["borders"]
    assert sum(border["inputs"] for border in borders) == len(FILES)
    return {border["border"]: border["findings"] for border in borders}


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_what_once_broke_the_program_does_so_no_more(path, findings):
    border, _ = read_finding(path)
    number = [file for file in FILES if read_finding(file)[0] == border].index(path)
    assert [found for found in findings[border] if found["number"] == number] == []
