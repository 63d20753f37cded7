"""What the README shows, runs; and it is short."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam import LaserScan, RecordedDrive
from tagalong.slam.logs import write_carmen

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
PROGRAMS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)


@pytest.fixture
def folder(tmp_path):
    """A folder with a short recorded drive along a square room."""
    bearings = np.linspace(-np.pi / 2, np.pi / 2, 181)
    odometry = np.stack((np.arange(12) * 0.1, np.zeros(12), np.zeros(12)), axis=-1)
    scans = []
    for x in odometry[:, 0]:
        ahead = (4.0 - x) / np.maximum(np.cos(bearings), 1e-9)
        aside = 2.0 / np.maximum(np.abs(np.sin(bearings)), 1e-9)
        scans.append(LaserScan(np.minimum(ahead, aside), bearings, 0.1, 30.0))
    write_carmen(tmp_path / "drive.log.gz", RecordedDrive(odometry, scans, None, "drive"))
    return tmp_path


def test_the_readme_fits_on_three_screens():
    assert len(README.splitlines()) <= 120
    assert len(PROGRAMS) == 3
    assert README.index("![") < 200  # a picture, before anything else


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda text: text.splitlines()[0])
def test_a_program_of_the_readme_runs(program, folder):
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


def test_a_follower_of_ones_own_takes_15_lines_and_is_evaluated_by_the_same_command(tmp_path):
    page = (ROOT / "docs" / "how-to" / "own-follower.md").read_text()
    (bold,) = [program for program in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "class Bold" in program]
    assert len(bold.splitlines()) <= 15
    assert "tagalong evaluate my_module:Bold" in page
    (tmp_path / "my_module.py").write_text(bold)
    command = [sys.executable, "-m", "tagalong", "evaluate", "my_module:Bold", "--episodes", "1", "--beams", "361"]
    done = subprocess.run([*command, "--out", "out"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "distance error RMS" in done.stdout
    assert "nan .." not in done.stdout  # one episode has no interval
    assert (tmp_path / "out" / "evaluation.json").exists()


def test_the_followers_of_the_readme_are_those_of_the_leaderboard():
    def cells(line):
        return [cell.strip() for cell in line.strip("|").split("|")]

    board = (ROOT / "docs" / "leaderboard.md").read_text()
    written = {}
    for who, done, contacts, jerk, *_ in (cells(line) for line in board.splitlines() if line.startswith("| `")):
        written[who] = f"{done.split()[0]}; {contacts.split()[0]}", jerk.split()[0]
    lines = README.splitlines()
    first = next(k for k, line in enumerate(lines) if "hard tours, bystanders" in line)
    head, _, done, jerk = lines[first : first + 4]
    told = zip(*(cells(line)[1:] for line in (head, done, jerk)), strict=True)
    assert {who: figures for who, *figures in told} == {who: list(figures) for who, figures in written.items()}


def test_slam_takes_at_most_ten_lines_of_python():
    (slam,) = [program for program in PROGRAMS if "read_log" in program]
    assert len([line for line in slam.splitlines() if line]) <= 10


def test_every_link_of_the_readme_leads_to_a_file():
    links = re.findall(r"\]\(([^)#:]+)\)", README)
    assert len(links) > 5
    assert [link for link in links if not (ROOT / link).is_file()] == []
