"""What the experiments' own command lines promise: whatever a user does wrong is told in a line or two, before work."""

import subprocess
import sys
from importlib import import_module

import pytest
from tagalong.scripts.benchmarks import follower_comparison
from tagalong.scripts.cli import told
from tagalong.slam.errors import InputError


@pytest.mark.parametrize(
    "words",
    [
        "follower_comparison --episodes 0",
        "follower_comparison --maps -1",
        "recall_by_distance --seeds 0",
        "recall_by_distance --seconds nan",
        "people --seeds 0",
        "people --people none",
        "people --seconds 0",
        "people --first-seed -1",
        "people_by_sensor --seconds -3",
        "people_by_sensor --first-seed -1",
        "rgbd_people --seeds 0",
        "rgbd_planes --seeds 1.5",
    ],
)
def test_numbers_that_make_no_sense_are_refused_by_their_option(words, capsys, tmp_path):
    name, *arguments = words.split()
    with pytest.raises(SystemExit) as ended:
        import_module(f"tagalong.scripts.benchmarks.{name}").main([*arguments, "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert f"argument {arguments[0]}: must be a" in error
    assert error.endswith(f"got {arguments[1]!r}")
    assert not (tmp_path / "out").exists()


def test_what_a_user_did_wrong_is_told_in_one_line(capsys):
    def fails():
        raise InputError("no such thing")

    assert told(fails) == 2
    assert capsys.readouterr().err == "tagalong: no such thing\n"
    assert told(lambda: 1) == 1


def test_an_experiment_started_as_a_module_tells_it_so():
    words = [sys.executable, "-m", "tagalong.scripts.benchmarks.people", "--preset", "nothing"]
    ended = subprocess.run(words, capture_output=True, text=True, check=False)
    assert ended.returncode == 2
    assert ended.stderr.startswith("tagalong: unknown preset 'nothing'")
    assert ended.stderr.count("\n") == 1


def test_a_follower_that_is_named_twice_drives_once(tmp_path, capsys, monkeypatch):
    rows = []

    def driven(who, name, k, env):
        row = {"follower": who, "suite": name, "episode": k, "slam": False, "ending": "tour_done"}
        rows.append(row | dict.fromkeys(follower_comparison.FIGURES, 1.0))
        return rows[-1]

    monkeypatch.setattr(follower_comparison, "episode_row", driven)
    words = "--followers pid pid --suites corridor --episodes 2 --maps 0 --out"
    assert follower_comparison.main([*words.split(), str(tmp_path)]) == 0
    assert len(rows) == 2
    assert "tours done" in capsys.readouterr().out
