"""The wheel, as a stranger installs it."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
from pathlib import Path

import pytest
import tagalong

ROOT = Path(__file__).resolve().parents[1]


def run(*words: str | Path, cwd: Path) -> str:
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "TAGALONG_DATA")}
    done = subprocess.run(
        [str(w) for w in words], cwd=cwd, env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, f"{words}: {done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory) -> Path:
    """The python of an empty environment into which the wheel, and what it asks for, was installed."""
    folder = tmp_path_factory.mktemp("wheel")
    leftovers = shutil.ignore_patterns(".venv", ".git", "build", "out", "*.egg-info", "__pycache__", ".*_cache")
    source = shutil.copytree(ROOT, folder / "source", ignore=leftovers)
    run(sys.executable, "-m", "build", "--wheel", "--outdir", folder, source, cwd=folder)
    (wheel,) = folder.glob("tagalong-*.whl")
    venv.create(folder / "env", with_pip=True)
    python = folder / "env" / "bin" / "python"
    run(python, "-m", "pip", "install", "-q", "-c", ROOT / "constraints.txt", wheel, cwd=folder)
    return python


def test_the_version_is_the_same_wherever_it_stands():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.M)
    told = re.search(r"^## (\S+)", (ROOT / "CHANGELOG.md").read_text(), re.M)
    assert cited is not None
    assert told is not None
    assert [tagalong.__version__, cited[1], told[1]] == [project] * 3


def test_the_oldest_dependencies_can_be_tried():
    words = [sys.executable, ROOT / ".ci" / "lowest.py", "viz", "learn", "ros", "datasets"]
    oldest = dict(line.split("==") for line in run(*words, cwd=ROOT).splitlines())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert len(oldest) >= len(project["dependencies"]) + len(project["optional-dependencies"]["learn"])
    assert oldest["numpy"] == "2.2.*"
    lines = re.findall(r"^(\S+)==([\d.]+)", (ROOT / "constraints.txt").read_text(), flags=re.M)
    pinned = {name.lower().replace("_", "-"): version for name, version in lines}
    newer = [name for name, version in oldest.items() if parts(version[:-2]) > parts(pinned[name])]
    assert newer == []  # what is promised as the oldest is no newer than what is tried


def parts(version: str) -> list[int]:
    return [int(part) for part in version.split(".")]


@pytest.mark.slow
def test_the_wheel_brings_the_command_and_its_help(installed, tmp_path):
    assert "COMMAND" in run(installed.parent / "tagalong", "--help", cwd=tmp_path)
    assert "COMMAND" in run(installed, "-m", "tagalong", "--help", cwd=tmp_path)


@pytest.mark.slow
def test_importing_the_installed_package_loads_nothing_heavy(installed, tmp_path):
    program = (
        "import sys, tagalong; "
        "print([m for m in ('mujoco', 'torch', 'sklearn', 'numba', 'matplotlib') if m in sys.modules])"
    )
    assert run(installed, "-c", program, cwd=tmp_path).strip() == "[]"
