import argparse

import numpy as np
import pytest
from scipy.stats import ttest_rel
from tagalong.scripts.lab.cells import files_of, run_cells
from tagalong.scripts.lab.drive_files import limited, load_input
from tagalong.scripts.reproduce.following.experiment import EXPERIMENT
from tagalong.scripts.reproduce.following.judgement import Pair, pair, sure_verdicts
from tagalong.scripts.reproduce.following.plan import (
    QUICK_SWEEP,
    ParameterSweep,
    all_cells,
    map_cell,
    map_name,
    reference_cells,
    tour_cell,
)
from tagalong.scripts.reproduce.following.sweep import ratio_text
from tagalong.slam import InputError, LaserScan


def options(**changes):
    return argparse.Namespace(**{"repeats": None, "quick": False, "no_sweep": False, **changes})


def test_the_published_experiment_has_a_raw_and_a_filtered_map_of_every_drive():
    names = {cell.name for cell in EXPERIMENT.cells(options(no_sweep=True))}
    for scene in ("corridor", "meeting_room"):
        for people in (1, 2):
            for engine in ("gmapping", "cartographer"):
                for seed in range(5):
                    for scans in ("raw", "filtered"):
                        assert map_name(scene, people, "typical", 30.0, engine, scans, seed) in names


def test_every_cell_comes_after_those_that_it_needs_and_once():
    cells = all_cells(2, ParameterSweep(repeats=1))
    names = [cell.name for cell in cells]
    assert len(set(names)) == len(names)
    for place, cell in enumerate(cells):
        assert all(names.index(needed) < place for needed in cell.needs)


def test_repeats_below_one_are_refused():
    with pytest.raises(InputError, match="--repeats"):
        EXPERIMENT.cells(options(repeats=0))


def test_a_verdict_needs_an_interval_that_leaves_zero_out():
    better = Pair(np.array([3.0, 3.1, 3.2]), np.array([1.0, 1.1, 1.2]), True)
    assert (better.verdict, better.ratio) == ("better", pytest.approx(3.1 / 1.1))
    assert Pair(better.raw, better.filtered, False).verdict == "worse"
    assert Pair(np.array([1.0, 2.0, 3.0]), np.array([2.0, 1.0, 3.0]), True).verdict == "no effect"
    assert Pair(np.array([3.0]), np.array([1.0]), True).verdict == "no effect"


def test_one_of_many_verdicts_is_sure_only_where_it_stands_their_number():
    rng, no = np.random.default_rng(0), np.zeros(5)
    raw = np.array([3.0, 3.2, 2.9, 3.4, 3.1])
    assert Pair(raw, no, True).p == pytest.approx(ttest_rel(raw, no)[1])
    assert (Pair(no, no, True).p, Pair(raw[:1], no[:1], True).p) == (1.0, 1.0)
    assert Pair(raw, raw - 1.0, True).p < 1e-9
    clear, weak = Pair(raw, no, True), Pair(raw, raw + np.array([-0.1, -0.3, -0.5, -0.6, -0.2]), True)
    assert 0.02 < weak.p < 0.05
    assert (clear.verdict, weak.verdict) == ("better", "better")
    assert sure_verdicts([weak]) == ["better"]
    chance = [Pair(rng.normal(size=5), no, True) for _ in range(20)]
    assert sure_verdicts([clear, weak, *chance]) == ["better"] + ["no effect"] * 21


def test_means_stay_where_a_metric_can_be():
    low, high = Pair(np.array([0.9, 1.0]), np.array([0.0, 0.1]), False, most=1.0).means
    assert (low.high, high.low) == (1.0, 0.0)


def test_ratios_are_drawn_without_an_exponent():
    assert [ratio_text(ratio) for ratio in (0.054, 0.61, 1.0, 9.94, 85.2, 130.4)] == [
        "0.054",
        "0.61",
        "1",
        "9.9",
        "85",
        "130",
    ]


def test_a_shorter_laser_sees_nothing_beyond_its_range():
    scan = LaserScan(np.array([1.0, 7.0, np.nan, np.inf]), np.linspace(0, 1, 4), 0.1, 30.0)
    cut = limited(scan, 5.0)
    assert cut.is_return.tolist() == [True, False, False, False]
    assert cut.is_no_return.tolist() == [False, True, False, True]


@pytest.mark.slow
def test_one_drive_is_recorded_mapped_and_judged_and_kept_to_the_bit(tmp_path):
    scene, odometry, usable = QUICK_SWEEP.scenes[0], "typical", 30.0
    cells = [*reference_cells(scene, 0), tour_cell(scene, 1, odometry, 0)]
    cells += [map_cell(scene, 1, odometry, usable, "cartographer", kind, 0) for kind in ("raw", "filtered")]
    cells = [cell for cell in cells if "gmapping" not in cell.name]
    results = run_cells(cells, tmp_path)
    for metric in ("ate", "adnn", "map_to_truth"):
        found = pair(results, metric, scene, 1, odometry, usable, "cartographer", [0])
        assert 0.0 < found.filtered[0] < 0.1, metric
    tour = load_input(files_of(cells[2].name, tmp_path) / "drive.npz")
    assert results[cells[2].name]["scans"] == len(tour.filtered)
    kept = [
        (raw.is_return & ~clean.is_return).sum()
        for raw, clean in zip(tour.scans("raw", 30.0), tour.filtered, strict=True)
    ]
    assert np.mean(kept) > 10
