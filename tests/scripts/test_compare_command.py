"""Followers compared cell by cell."""

import json

import pytest
from tagalong.scripts.cli import main
from tagalong.scripts.commands import compare
from tagalong.scripts.lab.cell_comparison import MEANS, compare_cells, report


def row(who, cell, k, done):
    figures = {**dict.fromkeys(MEANS, 1.0), "adnn_truth_to_map_m": None}
    ending = "tour_done" if done else "collision_static"
    return {"follower": who, "suite": "s", "cell": cell, "episode": k, "ending": ending, "slam": False, **figures}


def test_cells_are_paired_with_the_first_follower_and_corrected_for_their_number():
    rows = [row("old", cell, k, cell == "easy") for cell in ("easy", "hard") for k in range(8)]
    rows += [row("new", cell, k, True) for cell in ("easy", "hard") for k in range(8)]
    easy, hard, both = compare_cells(rows, ["old", "new"])
    assert (easy.paired["new"].difference, hard.paired["new"].difference) == (0.0, 1.0)
    assert hard.paired["new"].p == pytest.approx(2.0 / 256.0)
    assert hard.corrected["new"] == pytest.approx(2.0 * hard.paired["new"].p)
    assert hard.contacts == {"old": 8, "new": 0}
    assert both.name == "all cells"
    assert both.done["old"].mean == 0.5
    told = report([easy, hard, both], ["old", "new"])
    assert "| s: hard | 8 | 0.00 [0.00, 0.32] | 1.00 [0.68, 1.00] |" in told
    assert "+1.00 [+1.00, +1.00], p 0.016" in told


def test_a_stopped_comparison_goes_on_and_drives_nothing_twice(tmp_path, monkeypatch, capsys):
    driven = []

    def episode(who, name, k, env):
        driven.append((who, k))
        if len(driven) == 3:
            raise KeyboardInterrupt
        return {**row(who, "", k, True), "suite": name}

    monkeypatch.setattr(compare, "episode_row", episode)
    monkeypatch.setattr(compare, "_environment", lambda name, number: None)
    words = ["compare", "--suites", "office", "--followers", "pid", "dwa", "--episodes", "2", "--out", str(tmp_path)]
    assert main(words) == 130
    assert main(words) == 0
    assert driven == [("pid", 0), ("dwa", 0), ("pid", 1), ("pid", 1), ("dwa", 1)]
    assert "office" in capsys.readouterr().out
    cell = json.loads((tmp_path / "results.json").read_text())["cells"][0]
    assert cell["done"]["dwa"]["mean"] == 1.0
    assert main([*words[:4], "pid", "--out", str(tmp_path)]) == 2


def test_a_strangers_follower_enters_the_leaderboard_with_one_module_and_one_command(tmp_path, monkeypatch):
    toy = (
        "class Toy:\n    def reset(self):\n        pass\n\n    def act(self, observation):\n        return [0.0, 0.0]\n"
    )
    (tmp_path / "toy_follower.py").write_text(toy)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(
        compare, "episode_row", lambda who, name, k, env: {**row(who, "", k, ":" in who), "suite": name}
    )
    monkeypatch.setattr(compare, "_environment", lambda name, number: None)
    words = ["compare", "--suites", "office", "--followers", "pid", "toy_follower:Toy", "--episodes", "6"]
    assert main([*words, "--out", "out", "--leaderboard", "board.md"]) == 0
    page = (tmp_path / "board.md").read_text()
    places = [line.split("|")[1].strip() for line in page.splitlines() if line.startswith("| `")]
    assert places == ["`toy_follower:Toy`", "`pid`"]
    assert "| 1.00 [0.61, 1.00] | 0 of 6 |" in page
    assert "+1.00 [+1.00, +1.00], p 0.031" in page
    assert "`office`, 6 tours, seeds 1000000 to 1000005" in page
    assert "tagalong compare --suites office --followers pid toy_follower:Toy my_module:Bold" in page


def test_a_leaderboard_that_cannot_be_written_is_told_before_any_drive(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "episode_row", lambda *_: pytest.fail("driven"))
    words = ["compare", "--suites", "corridor", "--episodes", "1", "--out", str(tmp_path / "out")]
    for target, told in {tmp_path: "is a folder, where a file has to be written", "/dev/full": "is a device"}.items():
        assert main([*words, "--leaderboard", str(target)]) == 2
        said = capsys.readouterr().err
        assert told in said
        assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
