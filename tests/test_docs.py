"""What the documents name is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TOP = ("slam", "perception", "envs", "agents", "scripts", "tests", "docs", "examples")


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "docs/glossary.md"])
def test_files_and_folders_that_a_document_names_exist(name):
    named = re.findall(rf"`((?:{'|'.join(TOP)})/[\w/.]*)`", (ROOT / name).read_text())
    assert len(named) > 10
    assert [path for path in named if not (ROOT / path).exists()] == []


def test_the_terms_of_the_glossary_are_in_alphabetical_order():
    rows = re.findall(r"^\| ([^|]+) \| [^|]+ \| `[^|]+` \|$", (ROOT / "docs" / "glossary.md").read_text(), flags=re.M)
    assert len(rows) > 30
    assert rows == sorted(rows, key=str.lower)


def test_nothing_tells_to_start_a_benchmark_as_a_module():
    texts = [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md"), *(ROOT / "scripts").rglob("*.py")]
    old = re.compile(r"-m tagalong\.scripts\.(benchmarks|experiments)")
    assert [path.name for path in texts if path.name != "CHANGELOG.md" and old.search(path.read_text())] == []
