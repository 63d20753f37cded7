"""What `tagalong train follower` prints."""

import json

import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.site.learning_curves import draw_curves
from tagalong.scripts.training.follower import ProgressLines
from tagalong.slam import InputError


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


def test_curves_of_runs_are_drawn_and_a_folder_without_one_is_named(tmp_path):
    pytest.importorskip("matplotlib")
    rows = [{"steps": 1e6 * k, "success": 0.2 * k, "contacts": 0.1, "lost": 0.9 - 0.2 * k} for k in range(4)]
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "curve.json").write_text(json.dumps({"training": rows}))
    assert draw_curves([tmp_path / "one", tmp_path / "two"], tmp_path / "curves.png").stat().st_size > 5000
    (tmp_path / "two" / "curve.json").write_text('{"training": []}')
    with pytest.raises(InputError, match=r"two/curve\.json: holds no curve"):
        draw_curves([tmp_path / "one", tmp_path / "two"], tmp_path / "other.png")
    assert not (tmp_path / "other.png").exists()
