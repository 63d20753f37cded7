"""Followers compared cell by cell."""

import json

import numpy as np
import pytest
from tagalong.agents import FOLLOWERS
from tagalong.envs.task import FollowInterface
from tagalong.scripts.cli import main
from tagalong.scripts.commands import compare
from tagalong.scripts.lab.cell_comparison import TITLES, compare_cells, report
from tagalong.scripts.lab.driven_episodes import MAP_FIGURES, episode_row, finished_rows
from tagalong.slam import InputError


class Nowhere:
    """Stands for an environment that nobody drives in."""

    def get_wrapper_attr(self, name):
        return FollowInterface()

    def close(self):
        pass


def row(who, cell, k, done):
    figures = {**dict.fromkeys(TITLES, 1.0), **dict.fromkeys(MAP_FIGURES)}
    ending = "tour_done" if done else "collision_static"
    return {"follower": who, "suite": "s", "cell": cell, "episode": k, "ending": ending, "slam": None, **figures}


def test_cells_are_paired_with_the_first_follower_and_corrected_for_their_number():
    rows = [row("old", cell, k, cell == "easy") for cell in ("easy", "hard") for k in range(8)]
    rows += [row("new", cell, k, True) for cell in ("easy", "hard") for k in range(8)]
    easy, hard, both = compare_cells(rows, ["old", "new"])
    assert (easy.paired["new"].difference, hard.paired["new"].difference) == (0.0, 1.0)
    assert hard.paired["new"].p == pytest.approx(2.0 / 256.0)
    assert hard.corrected["new"] == pytest.approx(2.0 * hard.paired["new"].p)
    assert [hard.contacts(who) for who in ("old", "new")] == [8, 0]
    assert hard.endings["old"] == {"collision_static": 8}
    assert both.name == "all cells"
    assert both.done["old"].mean == 0.5
    told = report([easy, hard, both], ["old", "new"])
    assert "| s: hard | 8 | 0.00 [0.00, 0.32] | 1.00 [0.68, 1.00] |" in told
    assert "+1.00 [+1.00, +1.00], p 0.016" in told


def test_a_stopped_comparison_goes_on_and_drives_nothing_twice(tmp_path, monkeypatch, capsys):
    driven = []

    def episode(who, name, k, slam):
        driven.append((who, k))
        if len(driven) == 3:
            raise KeyboardInterrupt
        return {**row(who, "", k, True), "suite": name}

    monkeypatch.setattr(compare, "episode_row", episode)
    monkeypatch.setattr(compare, "scenario_environment", lambda name, number, slam: Nowhere())
    words = ["compare", "--suites", "office", "--followers", "pid", "dwa", "--episodes", "2", "--out", str(tmp_path)]
    assert main(words) == 130
    assert main(words) == 0
    assert driven == [("pid", 0), ("dwa", 0), ("pid", 1), ("pid", 1), ("dwa", 1)]
    assert "office" in capsys.readouterr().out
    cell = json.loads((tmp_path / "results.json").read_text())["cells"][0]
    assert cell["done"]["dwa"]["mean"] == 1.0
    assert main([*words[:4], "pid", "--out", str(tmp_path)]) == 2


def test_all_who_need_a_leader_and_no_map_are_compared_if_nobody_is_named():
    assert set(compare.EVERYBODY) == {*FOLLOWERS, "reinforced-alone"}
    assert compare.EVERYBODY[0] == "pid"


def test_a_strangers_follower_enters_the_leaderboard_with_one_module_and_one_command(tmp_path, monkeypatch):
    toy = (
        "class Toy:\n    def reset(self):\n        pass\n\n    def act(self, observation):\n        return [0.0, 0.0]\n"
    )
    (tmp_path / "toy_follower.py").write_text(toy)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(
        compare, "episode_row", lambda who, name, k, slam: {**row(who, "", k, ":" in who), "suite": name}
    )
    monkeypatch.setattr(compare, "scenario_environment", lambda name, number, slam: Nowhere())
    words = ["compare", "--suites", "office", "--followers", "pid", "toy_follower:Toy", "--episodes", "6"]
    assert main([*words, "--out", "out", "--leaderboard", "board.md"]) == 0
    page = (tmp_path / "board.md").read_text()
    places = [line.split("|")[1].strip() for line in page.splitlines() if line.startswith("| `")]
    assert places == ["`toy_follower:Toy`", "`pid`"]
    assert "| 1.00 [0.61, 1.00] | 0 of 6 |" in page
    assert "+1.00 [+1.00, +1.00], p 0.031" in page
    assert "`office`, 6 tours, seeds 1000000 to 1000005" in page
    assert "`tagalong compare --suites office --followers pid toy_follower:Toy --episodes 6\n" in page


def test_a_leaderboard_that_cannot_be_written_is_told_before_any_drive(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "episode_row", lambda *_: pytest.fail("driven"))
    words = ["compare", "--suites", "corridor", "--episodes", "1", "--out", str(tmp_path / "out")]
    for target, told in {tmp_path: "is a folder, where a file has to be written", "/dev/full": "is a device"}.items():
        assert main([*words, "--leaderboard", str(target)]) == 2
        said = capsys.readouterr().err
        assert told in said
        assert said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_figures_are_paired_episode_by_episode_and_corrected_for_their_number():
    rng = np.random.default_rng(0)
    rows = [row("rough", "c", k, True) | {"jerk_rms_mps3": rng.normal(2.5, 0.1)} for k in range(20)]
    rows += [row("smooth", "c", k, k > 1) | {"jerk_rms_mps3": rng.normal(1.0, 0.1)} for k in range(20)]
    (cell,) = compare_cells(rows, ["rough", "smooth"])
    test = cell.paired_figures["smooth"]["jerk_rms_mps3"]
    assert test.median_difference == pytest.approx(-1.5, abs=0.15)
    uncorrected = 2.0 / 2**20  # all twenty differ the same way
    assert test.p == pytest.approx(uncorrected * (len(TITLES) - len(MAP_FIGURES)))
    assert cell.paired_figures["smooth"]["sparc"].p == 1.0
    assert not set(MAP_FIGURES) & set(cell.means["smooth"])  # nobody mapped
    assert f"| jerk RMS [m/s3] | {cell.means['rough']['jerk_rms_mps3'].text()} |" in report([cell], ["rough", "smooth"])


def test_what_costs_what_is_drawn_and_nobody_is_below_the_plot(monkeypatch, tmp_path):
    pytest.importorskip("matplotlib")
    from tagalong.scripts.figures import trade_off

    kept = []
    monkeypatch.setattr(trade_off, "save_figure", lambda path, figure: kept.append(figure) or path)
    rows = [row(who, "c", k, k < 2) for who in ("seldom", "as seldom") for k in range(20)]
    trade_off.draw_trade_off(compare_cells(rows, ["seldom", "as seldom"]), tmp_path / "x.png")
    tours, space = kept[0].axes
    assert tours.get_ylim()[0] < 0.03  # Wilson's lower end of 2 of 20
    assert (tours.get_ylabel(), space.get_ylabel()) == ("tours done", "personal space kept")


def test_an_episode_that_was_cut_in_the_writing_is_driven_again(tmp_path):
    file = tmp_path / "episodes.jsonl"
    assert finished_rows(file, None) == []
    whole = [row("pid", "", k, True) for k in range(2)]
    file.write_text("".join(json.dumps(one) + "\n" for one in whole) + '{"follower": "smo')
    assert finished_rows(file, None) == whole
    assert file.read_text().endswith("}\n")
    for broken in ("no episode", "[1]", '{"follower": "pid"}'):
        file.write_text(broken + "\n" + json.dumps(whole[0]) + "\n")
        with pytest.raises(InputError, match=r"episodes\.jsonl: a line is no finished episode"):
            finished_rows(file, None)


def test_episodes_without_slam_do_not_stand_for_those_with_it(tmp_path):
    file = tmp_path / "episodes.jsonl"
    without, mapped, older = (row("pid", "", 0, True) | {"slam": slam} for slam in (None, "cartographer", False))
    file.write_text("".join(json.dumps(one) + "\n" for one in (without, mapped, older)))
    assert finished_rows(file, None) == [without, older]
    assert finished_rows(file, "cartographer") == [mapped]
    assert finished_rows(file, "gmapping") == []


def test_with_slam_the_map_and_the_floor_seen_are_judged():
    figures = episode_row("mapper", "corridor", 0, "cartographer")
    assert 0.0 < figures["adnn_truth_to_map_m"] < 0.5
    assert 0.0 < figures["adnn_map_to_truth_m"] < 0.1
    assert figures["ate_m"] < 0.05
    assert 0.5 < figures["coverage"] <= 1.0


def test_who_needs_a_map_is_refused_where_nothing_maps_before_any_drive(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(compare, "episode_row", lambda *_: pytest.fail("driven"))
    words = ["compare", "--suites", "corridor", "--followers", "pid", "mapper", "--out", str(tmp_path / "out")]
    assert main(words) == 2
    assert "needs the robot's own map" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_follower_that_is_named_twice_is_one(tmp_path, capsys):
    assert main(["compare", "--followers", "pid", "pid", "--out", str(tmp_path)]) == 2
    assert "must name two or more" in capsys.readouterr().err


def test_processes_change_nothing_but_the_time_and_a_strangers_module_is_found_in_them(tmp_path, monkeypatch):
    still = "class Still:\n    def reset(self): pass\n    def act(self, observation): return [0.0, 0.0]\n"
    (tmp_path / "still_follower.py").write_text(still)
    monkeypatch.chdir(tmp_path)
    words = ["compare", "--suites", "corridor", "--followers", "pid", "still_follower:Still", "--episodes", "2"]
    for jobs in "12":
        assert main([*words, "--jobs", jobs, "--out", jobs]) == 0
    lines = (tmp_path / "1" / "episodes.jsonl").read_text().splitlines()
    assert lines == sorted(lines)
    for name in ("episodes.jsonl", "results.json", "report.md"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()
    assert main([*words, "--jobs", "100000", "--out", "3"]) == 2
