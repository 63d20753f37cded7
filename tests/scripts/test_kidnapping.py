"""Robots that are carried away: what counts as found and as wrong, and trials off a half-done map."""

import numpy as np
import pytest
from tagalong.scripts.benchmarks.half_mapped import LEG_SCANS, carried_off_a_half_map, judge
from tagalong.scripts.benchmarks.kidnapping import cells, summary

RIGHT, WRONG, UNSURE = np.zeros(3), np.array([2.0, 0.0, 0.0]), None


@pytest.mark.parametrize(
    ("told", "found_at", "wrong"),
    [
        ([RIGHT, RIGHT, RIGHT], 1, False),
        ([WRONG, UNSURE, RIGHT], 3, False),
        ([RIGHT, RIGHT, WRONG], None, True),
        ([RIGHT, RIGHT, UNSURE], None, False),
        ([UNSURE, np.array([0.0, 0.0, 0.3]), np.array([0.0, 0.2, 0.1])], 3, False),
    ],
)
def test_found_is_who_is_sure_and_right_to_the_end_and_wrong_who_is_sure_there_and_not_right(told, found_at, wrong):
    judged = judge(told, np.zeros((3, 3)), 0.3, 0.2)
    assert (judged["found_at"], judged["wrong"]) == (found_at, wrong)
    assert (judged["error_m"] is None) == (told[-1] is None)


def test_robots_carried_off_a_half_map_are_told_apart_by_where_they_end(tmp_path):
    half = {"found_at": [3, None], "error_m": [0.1, None], "error_deg": [1.0, None], "wrong": [False, False]}
    summed = summary({"aces/half/0": {**half, "on_map": [True, False]}, "room/0p/slam/0": half, "map/room": {}})
    assert {name: row["found"]["mean"] for name, row in summed.items()} == {
        "aces/half/on": 1.0, "aces/half/off": 0.0, "room/0p/slam": 0.5,
    }  # fmt: skip
    names = [cell.name for cell in cells(tmp_path, 100, 0)]
    assert len(set(names)) == len(names)
    assert sum(name.startswith("csail/half/") for name in names) == 2
    assert not any("/half/" in cell.name for cell in cells(None, 100, 0))


def test_a_robot_is_carried_off_a_half_map_of_a_drawn_world():
    made = carried_off_a_half_map("", "office-6525", seed=0, first=0, trials=3)
    assert {len(values) for values in made.values()} == {3}
    assert sum(value is not None for value in made["found_at"]) >= 2
    assert made["on_map"] == [True, True, True]  # where they end, the third begins off it
    assert all(value is None or 1 <= value <= LEG_SCANS for value in made["found_at"])
    again = carried_off_a_half_map("", "office-6525", seed=0, first=1, trials=1)
    assert again["error_m"] == made["error_m"][1:2]  # each trial has random numbers of its own
