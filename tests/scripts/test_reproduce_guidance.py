"""The rule from measurements to plus signs and verdicts, and one short drive."""

import numpy as np
import pytest
from tagalong.scripts.reproduce.experiment import load_experiment
from tagalong.scripts.reproduce.guidance.drives import GUIDES, UNLED, guide_drive
from tagalong.scripts.reproduce.guidance.measured import Measured, cell_name
from tagalong.scripts.reproduce.guidance.pictures import draw_coverage, draw_criteria
from tagalong.scripts.reproduce.guidance.rule import METHODS, PAPER, compare, pluses, verdict
from tagalong.scripts.reproduce.guidance.tables import figures_table, lead, numbers, scenes_table, signs_table

N = 40


def around(mean, spread=0.1, seed=0):
    return mean + spread * np.random.default_rng(seed).standard_normal(N)


def three(pid, joystick, random, spread=0.1):
    return compare(
        {g: around(m, spread, k) for k, (g, m) in enumerate(zip(METHODS, (pid, joystick, random), strict=True))}
    )


def test_who_is_clearly_better_gets_more_signs():
    found = three(1.0, 2.0, 3.0)
    assert pluses(tuple(METHODS), found) == {"pid": 3, "joystick": 2, "random": 1}
    assert found["pid", "joystick"].better == found["joystick", "pid"].better == "pid"
    assert found["pid", "joystick"].high < 0.8


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_who_is_better_does_not_depend_on_the_order_of_equal_differences(order):
    worse = np.repeat([6.0, 4.0], [21, 9])[order]
    found = compare({"pid": worse, "joystick": np.full(30, 5.0)})["pid", "joystick"]
    assert found.p < 0.05
    assert found.better == "joystick"


def test_equal_guides_get_equal_signs():
    found = three(1.0, 1.0, 1.0, spread=0.05)
    assert set(pluses(tuple(METHODS), found).values()) == {1}
    assert found["pid", "random"].equal


def test_guides_without_any_difference_are_not_separable():
    found = compare({guide: np.zeros(N) for guide in METHODS})
    assert found["pid", "joystick"].p == 1.0
    assert not found["pid", "joystick"].better


def test_a_cell_is_confirmed_refuted_or_not_separable():
    as_printed = three(1.0, 2.0, 3.0)
    assert [verdict("safety", guide, as_printed) for guide in METHODS] == ["confirmed"] * 3
    upside_down = three(3.0, 2.0, 1.0)
    assert [verdict("safety", guide, upside_down) for guide in METHODS] == ["refuted"] * 3
    blurred = three(1.0, 1.0, 1.0, spread=5.0)
    assert [verdict("safety", guide, blurred) for guide in METHODS] == ["not separable"] * 3


def test_equal_signs_of_the_paper_hold_only_for_equal_figures():
    assert PAPER["time saving"]["pid"] == PAPER["time saving"]["joystick"]
    assert verdict("time saving", "pid", three(1.0, 1.02, 3.0)) == "confirmed"
    assert verdict("time saving", "pid", three(1.0, 1.6, 3.0)) == "refuted"


def test_drives_without_a_value_are_left_out_of_their_pair():
    values = {guide: around(k + 1.0, 0.1, k) for k, guide in enumerate(METHODS)}
    values["pid"][:5] = np.nan
    assert compare(values)["pid", "random"].better == "pid"


def made_up(guide, seed):
    quick, busy = {"pid": 1.0, "joystick": 1.3}.get(guide, 2.0), guide == "joystick"
    leads = guide not in UNLED
    keys = ("duration_s", "coverage", "time_to_90_s", "time_to_95_s", "time_to_99_s", "jerk_rms_mps3", "sparc", "ldlj")
    keys += ("contacts_people", "contacts_static", "near_misses", "min_distance_bystander_m", "min_ttc_s")
    keys += ("personal_space_compliance", "path_length_m", "band_1_2_m_share", "losses", "reacquired")
    row = dict.fromkeys(keys, quick + 0.01 * seed)
    row |= {"time_to_99_s": None, "coverage": 0.95, "ending": "", "curve": [0.1, 0.5], "sparc": -quick}
    row["operator"] = {"commands": 50 if busy else 0, "active_s": 20.0 if busy or leads else 0.0, "screen": busy}
    row["map"] = dict.fromkeys(("truth_to_map_m", "map_to_truth_m", "coverage", "residue", "ate_m"), 0.02)
    return row


@pytest.fixture
def measured():
    scenes, seeds = ("corridor", "office"), range(8)
    rows = {cell_name(g, s, k): made_up(g, k) for g in GUIDES for s in scenes for k in seeds}
    return Measured(rows, scenes, seeds, 480.0)


def test_the_report_says_what_was_measured(measured, tmp_path):
    table = signs_table(measured)
    assert len(table.rows) == 12
    convenience = {row[1]: (row[3], row[6]) for row in table.rows if row[0] == "convenience"}
    assert convenience["joystick control"] == ("+", "confirmed")
    assert convenience["random exploration"] == ("+++", "confirmed")
    assert all(len(row) == len(table.columns) for row in table.rows)
    full = figures_table(measured, "office")
    (never,) = [row for row in full.rows if row[0].startswith("time to 99")]
    assert set(never[1:]) == {"never"}
    assert len(scenes_table(measured).rows) == 4 * 2 + 7
    assert "12 cells" in lead(measured)
    assert numbers(measured)["table_1"]
    for figure in (draw_criteria(measured, tmp_path), draw_coverage(measured, tmp_path)):
        assert figure.file.stat().st_size > 5000


def test_time_not_reached_counts_as_the_limit(measured):
    measured.results[cell_name("pid", "corridor", 0)]["time_to_90_s"] = None
    assert measured.burden("pid", "time saving", "corridor")[0] == 480.0


@pytest.mark.parametrize("guide", ["dwa", "joystick"])
def test_a_short_drive_gives_every_figure_and_a_video(guide, tmp_path):
    row = guide_drive(guide, "meeting_room", 1, 4.0, tmp_path)
    assert row["map"]["ate_m"] < 0.2
    assert 0.2 < row["coverage"] <= 1.0
    assert (row["operator"]["commands"] > 0) == (guide == "joystick")
    assert (tmp_path / "drive.gif").exists()
    assert (tmp_path / "joystick.txt").exists() == (guide == "joystick")


def test_the_experiment_is_known():
    experiment = load_experiment("guidance")
    assert experiment.name == "guidance"
