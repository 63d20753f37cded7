"""The table of the README: scene beside scene, engine beside engine."""

from tagalong.scripts.benchmarks.acceptance_table import side_by_side
from tagalong.scripts.benchmarks.people import DriveConfig, judged_drive
from tagalong.scripts.lab.cells import TIMING, without_timing


def test_what_was_measured_in_both_scenes_and_by_both_engines_stands_in_one_row():
    rows = [
        ("corridor: ADNN, raw scans", "1.16", "paper: 80.24", "5"),
        ("meeting room: ADNN, raw scans", "0.71", "paper: in a plot only", "5"),
        ("corridor: MOTA", "0.95", "", "10"),
        ("Intel log, GMapping: mean relation error [m]", "0.028", "original GMapping: 0.056", "5"),
        ("Intel log, graph SLAM: mean relation error [m]", "0.021", "LaMa: 0.038", "1"),
    ]
    assert side_by_side(rows).splitlines() == [
        "| measured in simulation | corridor | meeting room | paper: corridor; meeting room | n |",
        "|---|---|---|---|---|",
        "| ADNN, raw scans | 1.16 | 0.71 | 80.24; in a plot only | 5 |",
        "| MOTA | 0.95 |  |  | 10 |",
        "",
        "| recorded log | GMapping | graph SLAM | original programs | n |",
        "|---|---|---|---|---|",
        "| Intel, mean relation error [m] | 0.028 | 0.021 | original GMapping: 0.056; LaMa: 0.038 | 5, 1 |",
    ]


def test_without_recorded_logs_there_is_no_table_of_them():
    assert "recorded log" not in side_by_side([("corridor: MOTA", "0.95", "", "10")])


def test_a_drive_of_people_is_the_same_each_time_but_for_what_stands_under_timing():
    first, second = (judged_drive(DriveConfig(people=2, seconds=2.0), 0) for _ in range(2))
    assert first[TIMING]["ms"] > 0.0
    assert repr(without_timing(first)) == repr(without_timing(second))


def test_who_is_told_of_later_is_missed_more_seldom():
    at_once, later = (judged_drive(DriveConfig(people=3, seconds=6.0, lag_s=lag_s), 4) for lag_s in (0.0, 1.0))
    assert at_once["truths"] == later["truths"] > 50
    assert later["misses"] < at_once["misses"]
    assert later["leader_right"]
