"""Followers compared: figures of each, paired tests, and the plot of tours done over jerk."""

import json

import numpy as np
import pytest
from tagalong.scripts.benchmarks.follower_comparison import FIGURES, compare, draw_trade_off, finished_rows
from tagalong.slam import InputError


def rows(follower, jerk, done):
    """One episode for each entry; whatever is not jerk is equal for all."""
    same = dict.fromkeys(FIGURES, 0.5) | {"adnn_truth_to_map_m": None}
    return [
        {"follower": follower, "suite": "office", "episode": k, "ending": "tour_done" if ok else "leader_lost"}
        | same
        | {"jerk_rms_mps3": value}
        for k, (value, ok) in enumerate(zip(jerk, done, strict=True))
    ]


@pytest.fixture
def result():
    rng = np.random.default_rng(0)
    smooth = rows("smooth", rng.normal(1.0, 0.1, 20), [True] * 18 + [False] * 2)
    rough = rows("rough", rng.normal(2.5, 0.1, 21), [True] * 21)
    return compare(smooth + rough, ["smooth", "rough"])


def test_only_episodes_that_all_have_driven_are_compared(result):
    assert result["office"]["episodes"] == 20
    assert result["office"]["figures"]["smooth"]["success"]["mean"] == pytest.approx(0.9)
    assert result["office"]["figures"]["smooth"]["endings"] == {"leader_lost": 2, "tour_done": 18}
    paired = result["office"]["paired"]["rough"]
    assert paired["jerk_rms_mps3"]["p"] < 1e-4
    assert paired["jerk_rms_mps3"]["median_difference"] == pytest.approx(-1.5, abs=0.15)
    assert paired["sparc"]["p"] == 1.0
    assert paired["adnn_truth_to_map_m"]["n"] == 0  # driven without SLAM


def test_the_trade_off_is_drawn(result, tmp_path):
    pytest.importorskip("matplotlib")
    file = draw_trade_off(result, tmp_path / "trade_off.png")
    assert file.stat().st_size > 5000


def test_nobody_is_below_the_plot(monkeypatch, tmp_path):
    pytest.importorskip("matplotlib")
    from tagalong.scripts.benchmarks import follower_comparison

    kept = []
    monkeypatch.setattr(follower_comparison, "save_figure", lambda path, figure: kept.append(figure) or path)
    seldom = rows("seldom", np.ones(20), [True] * 2 + [False] * 18)
    draw_trade_off(compare(seldom, ["seldom"]), tmp_path / "x.png")
    tours, space = kept[0].axes
    assert tours.get_ylim()[0] < 0.03  # Wilson's lower end of 2 of 20
    assert (tours.get_ylabel(), space.get_ylabel()) == ("tours done", "personal space kept")
    assert space.get_ylim()[0] < 0.5


def test_an_episode_that_was_cut_in_the_writing_is_driven_again(tmp_path):
    file = tmp_path / "episodes.jsonl"
    assert finished_rows(file) == []
    whole = [row | {"slam": True} for row in rows("smooth", [1.0, 2.0], [True, True])]
    file.write_text("".join(json.dumps(row) + "\n" for row in whole) + '{"follower": "smo')
    assert finished_rows(file) == whole
    assert finished_rows(file) == whole
    assert file.read_text().endswith("}\n")
    file.write_text("no episode\n" + json.dumps(whole[0]) + "\n")
    with pytest.raises(InputError, match=r"episodes\.jsonl: a line is no finished episode"):
        finished_rows(file)


def test_episodes_without_slam_do_not_stand_for_those_with_it(tmp_path):
    file = tmp_path / "episodes.jsonl"
    (one,) = rows("smooth", [1.0], [True])
    with_map, without = one | {"adnn_truth_to_map_m": 0.02}, one  # as older files have them
    told, later = one | {"slam": True}, one | {"slam": False, "episode": 5}
    file.write_text("".join(json.dumps(row) + "\n" for row in (with_map, without, told, later)))
    assert finished_rows(file) == [with_map, told]
    assert finished_rows(file, 0) == [without, later]
    assert finished_rows(file, 5) == [with_map, told, later]
