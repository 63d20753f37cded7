"""Continuous integration runs no code that somebody else can exchange."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_actions_are_pinned_by_the_hash_of_a_commit(path):
    used = re.findall(r"uses:\s*(\S+)", path.read_text())
    assert used
    assert [action for action in used if not re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40}", action)] == []


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.name)
def test_a_workflow_may_only_read(path):
    assert re.search(r"^permissions:\n  contents: read$", path.read_text(), flags=re.M)


def test_what_is_pushed_is_checked_and_tested():
    steps = (ROOT / ".ci" / "run").read_text().splitlines()
    assert {"make check", "make test", "make docs", "make fuzz"} <= {" ".join(step.split()[:2]) for step in steps}
    assert [step for step in steps if step.startswith("make docs")] == ["make docs & # each has one core"]
    assert steps[-1] == 'wait "$site"'  # what runs beside the rest counts, too
    assert "- run: .ci/run" in (ROOT / ".github" / "workflows" / "ci.yml").read_text()


def test_what_looks_at_a_commit_has_the_version_that_continuous_integration_has():
    pinned = dict(re.findall(r"^(\S+)==(\S+)$", (ROOT / "constraints.txt").read_text(), flags=re.M))
    tools = re.findall(r'"([\w-]+)==([\d.]+)"', (ROOT / ".pre-commit-config.yaml").read_text())
    assert ("ruff", pinned["ruff"]) in tools
    assert len(set(tools)) == 2  # and one version of the other
