"""The simulator of scans and the training command, in tiny settings."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from sklearn.ensemble import RandomForestClassifier
from tagalong.perception import LegForest
from tagalong.scripts.cli import main
from tagalong.scripts.training.evaluate_legs import LegScores, score_legs
from tagalong.scripts.training.leg_forests import odds_for
from tagalong.scripts.training.leg_pasting import paste_legs
from tagalong.scripts.training.leg_recordings import read_leg_recordings
from tagalong.scripts.training.leg_scans import draw_scan
from tagalong.scripts.training.train_legs import flatten_forest
from tagalong.slam import LaserScan

TINY = ["--scans", "40", "--test-scans", "10", "--trees", "4", "--drives", "1", "--test-drives", "1"]


def write_recording(path, rng, legs, scans=12):
    """A recording of scans with 361 beams in the layout of the leg_tracker data."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 361)
    ranges = np.full((scans, 361), 4.0) + rng.normal(0.0, 0.01, (scans, 361))
    places = np.column_stack((rng.uniform(1.0, 3.0, scans), rng.uniform(-1.0, 1.0, scans)))
    content = {}
    if legs:
        for row, (x, y) in zip(ranges, places, strict=True):
            row[np.abs(angles - np.arctan2(y, x)) < 0.06 / np.hypot(x, y)] = np.hypot(x, y)
        content = {"leg_xy": places, "leg_scan_index": np.arange(scans)}
    np.savez(
        path,
        ranges=ranges.astype(np.float32),
        angle_min=angles[0],
        angle_increment=angles[1] - angles[0],
        range_min=0.03,
        range_max=11.0,
        stamp=np.arange(float(scans)),
        **content,
    )


@pytest.fixture
def recordings(tmp_path):
    rng = np.random.default_rng(0)
    for k in (1, 2, 3):
        write_recording(tmp_path / f"positive_{k}_labelled.npz", rng, legs=True)
    write_recording(tmp_path / "negative_2_left_scans.npz", rng, legs=False, scans=96)
    return tmp_path


def test_the_same_seed_draws_the_same_scan_and_another_seed_another():
    first, again, other = (draw_scan(np.random.default_rng(seed)).scan for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.ranges, again.ranges)
    assert len(first) != len(other) or not np.array_equal(first.ranges, other.ranges)


def test_only_returns_are_legs_and_a_scan_without_people_has_none():
    drawn = [draw_scan(np.random.default_rng(seed)) for seed in range(20)]
    assert sum(d.is_leg.sum() for d in drawn) > 0
    assert all(d.scan.is_return[d.is_leg].all() for d in drawn)
    assert not any(draw_scan(np.random.default_rng(seed), people=False).is_leg.any() for seed in range(5))


def test_a_pasted_leg_keeps_its_range_and_hides_only_what_is_behind_it():
    bearings = np.linspace(-1.0, 1.0, 201)
    ranges = np.full(201, np.inf)
    ranges[95:106] = 2.0
    near_wall = LaserScan(np.where(np.arange(201) < 100, 1.0, 5.0), bearings, 0.1, 10.0)
    for seed in range(10):
        scan = LaserScan(ranges, bearings, 0.1, 10.0)
        pasted = paste_legs(np.random.default_rng(seed), scan, np.array([[2.0, 0.0]]), near_wall)
        np.testing.assert_allclose(pasted.scan.ranges[pasted.is_leg], 2.0)
        np.testing.assert_array_equal(pasted.scan.ranges[~pasted.is_leg], near_wall.ranges[~pasted.is_leg])
        assert not pasted.is_leg[:100].any()
        assert pasted.is_leg.sum() <= 11


def test_recall_is_counted_at_the_confidence_that_so_many_false_legs_exceed():
    scores = LegScores(np.array([0.9, 0.6, 0.3, 0.0]), np.array([0.8, 0.5, 0.2, 0.1]), scans=2)
    assert scores.recall(0.5) == 0.5  # one false leg in two scans: above 0.5
    assert scores.recall(2.0) == 0.75
    assert scores.at(0.3) == (0.75, 1.0)
    assert odds_for(0.3) == pytest.approx(1.0)


def test_training_twice_with_one_seed_gives_the_same_bytes(tmp_path):
    for name in "ab":
        assert main(["train", "legs", "--forest", "simulation", "--out", str(tmp_path / name), *TINY]) == 0
    for file in ("legs_simulation.npz", "legs_simulation.json", "curve.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()
    assert (tmp_path / "a" / "curve.png").stat().st_size > 1000


def test_the_real_forest_is_scored_on_recordings_left_out(tmp_path, recordings, capsys):
    out = tmp_path / "out"
    assert main(["train", "legs", "--forest", "real", "--data", str(recordings), "--out", str(out), *TINY]) == 0
    card = json.loads((out / "legs_real.json").read_text())
    with np.load(out / "legs_real.npz") as written:
        assert card["features"] == written["feature_names"].tolist()
    assert card["scores"]["recordings not trained on"]["scans_of_false_legs"] == 96
    assert LegForest.load(out / "legs_real.npz").odds == pytest.approx(card["odds"])
    assert "recall, recordings not trained on" in capsys.readouterr().out


def test_bad_arguments_and_data_end_with_one_line(tmp_path, capsys):
    assert main(["train", "legs", "--forest", "real", "--out", str(tmp_path)]) == 2
    assert "--data" in capsys.readouterr().err
    (tmp_path / "positive_1_labelled.npz").write_bytes(b"nothing")
    assert main(["train", "legs", "--forest", "real", "--data", str(tmp_path), "--out", str(tmp_path)]) == 2
    assert "not a recording of leg scans" in capsys.readouterr().err


def test_a_forest_of_ours_votes_as_scikit_learns_predict_proba():
    rng = np.random.default_rng(3)
    rows = rng.normal(size=(600, 40)).astype(np.float32)
    truth = rows[:, 0] * rows[:, 1] + rows[:, 5] > 0.2
    theirs = RandomForestClassifier(12, max_depth=9, min_samples_leaf=2, random_state=0)
    theirs.fit(rows, truth, sample_weight=1.0 + 3.0 * truth)
    ours = flatten_forest(theirs)
    on_thresholds = rows.copy()
    on_thresholds[:, ours.feature[ours.roots[0]]] = ours.value[ours.roots[0]]
    for sample in (rows, on_thresholds):
        np.testing.assert_allclose(ours.vote(sample), theirs.predict_proba(sample)[:, 1], atol=1e-6)


@pytest.mark.parametrize(("name", "recall", "false_legs"), [("real", 0.8, 0.8), ("simulation", 0.7, 8.0)])
def test_a_shipped_forest_finds_recorded_legs(name, recall, false_legs):
    """A check that the shipped file is the trained one; `real` knows these recordings, its card has fair figures."""
    if "TAGALONG_DATA" not in os.environ:
        pytest.skip("set TAGALONG_DATA to the folder with legs/positive_1_labelled.npz")
    positive, people_free = read_leg_recordings(Path(os.environ["TAGALONG_DATA"]) / "legs")
    scores = score_legs(LegForest.load(name), positive, people_free.scans[::5])
    found, false = scores.at(0.3)
    assert found >= recall
    assert false <= false_legs
