"""What `tagalong train follower` prints."""

import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.training.follower import ProgressLines


def test_a_resumed_run_counts_the_minutes_before_it(capsys):
    lines = ProgressLines()
    lines.go_on(12.0)
    lines("too soon to be told")
    lines("evaluation after imitation 3")
    told = capsys.readouterr().out.splitlines()
    assert told == ["  12.0 min  going on from the last checkpoint", "  12.0 min  evaluation after imitation 3"]


def test_a_training_by_the_command_line_begins_ends_in_time_and_goes_on(tmp_path, capsys):
    pytest.importorskip("torch")
    words = ["train", "follower", "--preset", "corridor", "--max-minutes", "0.001", "--workers", "1"]
    for drive in ("drive 1/12", "drive 2/12"):  # what was driven is kept
        assert main([*words, "--out", str(tmp_path / "run")]) == 1  # no policy was judged in so short a time
        assert drive in capsys.readouterr().out
