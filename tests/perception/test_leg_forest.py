"""The forest: votes as its twin does, refuses damaged files, finds legs."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from forest_reference import vote_reference
from tagalong.perception.legs.clusters import cluster_scan
from tagalong.perception.legs.detector import LegDetector, LegDetectorConfig
from tagalong.perception.legs.features import FEATURE_NAMES
from tagalong.perception.legs.forest import SHIPPED, LegForest, read_card
from tagalong.perception.legs.forest_kernel import MOST_DEPTH, is_sound
from tagalong.slam import InputError, LaserScan

BEARINGS = np.radians(np.linspace(-135.0, 135.0, 1081))


def grown(rng, depth, first=0):
    """Return a tree of random questions, depth-first from number `first` on: features, values, right children."""
    if depth == 0 or rng.random() < 0.1:
        return [-1], [rng.random()], [0]
    left = grown(rng, depth - 1, first + 1)
    turn = first + 1 + len(left[0])
    right = grown(rng, depth - 1, turn)
    question = int(rng.integers(len(FEATURE_NAMES))), rng.normal(), turn
    return tuple([one, *a, *b] for one, a, b in zip(question, left, right, strict=True))


@pytest.fixture(scope="module")
def forest():
    """A forest of random trees."""
    rng, roots, nodes = np.random.default_rng(3), [], ([], [], [])
    for _ in range(12):
        roots.append(len(nodes[0]))
        for whole, part in zip(nodes, grown(rng, 9, roots[-1]), strict=True):
            whole += part
    feature, value, right = nodes
    return LegForest(np.int8(feature), np.float32(value), np.int32(right), np.int32(roots))


@pytest.fixture(scope="module")
def rows(forest):
    """Features of 600 clusters, some of them on the threshold of a tree's first question."""
    rows = np.random.default_rng(4).normal(size=(600, len(FEATURE_NAMES))).astype(np.float32)
    rows[::7, forest.feature[0]] = forest.value[0]
    return rows


def two_legs_and_a_wall():
    """A room of 3 m around the laser, and a person's two legs 2 m ahead."""
    ranges = np.full(1081, 3.0)
    for y in (-0.15, 0.15):
        away = np.hypot(2.0, y)
        offset = away * np.sin(BEARINGS - np.arctan2(y, 2.0))
        hit = (np.abs(offset) < 0.06) & (np.abs(BEARINGS) < 1.0)
        ranges[hit] = away - np.sqrt(0.06**2 - offset[hit] ** 2)
    return LaserScan(ranges, BEARINGS, 0.1, 30.0, T_robot_lidar=(0.2, 0.0, 0.0))


def test_the_kernel_votes_as_the_reference_does(forest, rows):
    expected = vote_reference(forest.feature, forest.value, forest.right, forest.roots, rows)
    np.testing.assert_allclose(forest.vote(rows), expected, rtol=1e-12)


def test_a_saved_forest_comes_back_the_same(forest, rows, tmp_path):
    replace(forest, odds=0.4).save(tmp_path / "legs.npz", {"note": "test"})
    again = LegForest.load(tmp_path / "legs.npz")
    np.testing.assert_array_equal(again.vote(rows), forest.vote(rows))
    assert again.odds == 0.4
    assert (tmp_path / "legs.json").exists()


def test_a_forest_for_other_features_is_refused(forest, tmp_path):
    forest.save(tmp_path / "legs.npz", {})
    with np.load(tmp_path / "legs.npz") as file:
        content = dict(file)
    content["feature_names"] = content["feature_names"][::-1]
    np.savez(tmp_path / "other.npz", **content)
    with pytest.raises(InputError, match="other features"):
        LegForest.load(tmp_path / "other.npz")


@pytest.mark.parametrize(
    ("key", "value"),
    [("right", 0), ("right", 10**6), ("feature", 100), ("value", np.nan), ("odds", -1.0), ("roots", -5)],
)
def test_a_forest_with_damaged_arrays_is_refused(forest, tmp_path, key, value):
    forest.save(tmp_path / "legs.npz", {})
    with np.load(tmp_path / "legs.npz") as file:
        content = dict(file)
    content[key] = np.full_like(content[key], value)
    np.savez(tmp_path / "broken.npz", **content)
    with pytest.raises(InputError, match="damaged"):
        LegForest.load(tmp_path / "broken.npz")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("odds", np.ones(2)),
        ("odds", np.array("many")),
        ("odds", np.array(np.inf)),
        ("feature", np.zeros((2, 2), np.int8)),
        ("value", np.array(["a"])),
        ("right", np.array([1e300])),
        ("roots", np.zeros(0, np.int32)),
    ],
)
def test_a_forest_of_other_arrays_than_were_saved_is_refused(forest, tmp_path, key, value):
    forest.save(tmp_path / "legs.npz", {})
    with np.load(tmp_path / "legs.npz") as file:
        content = dict(file)
    np.savez(tmp_path / "broken.npz", **{**content, key: value})
    with pytest.raises(InputError, match=r"broken\.npz"):
        LegForest.load(tmp_path / "broken.npz")


def test_a_tree_like_a_chain_is_refused():
    """Every cluster is asked at every level: a chain of a million would take seconds a scan."""
    chain = 2 * MOST_DEPTH + 3
    feature = np.where(np.arange(chain) % 2 == 0, 0, -1)
    feature[-1] = -1
    right = np.where(feature == 0, np.arange(chain) + 2, 0)
    assert not is_sound(feature, right, np.array([0]), 1)
    assert is_sound(feature[2:], np.maximum(right[2:] - 2, 0), np.array([0]), 1)


def test_a_forest_whose_walks_meet_is_refused():
    feature, right = np.array([0, 0, -1, -1]), np.array([3, 3, 0, 0])
    assert not is_sound(feature, right, np.array([0]), 1)
    assert is_sound(np.array([0, 0, -1, -1, -1]), np.array([4, 3, 0, 0, 0]), np.array([0]), 1)


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04 cut off"])
def test_a_file_that_is_no_forest_gives_one_clear_error(tmp_path, content):
    path = tmp_path / "legs.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match="not a leg forest"):
        LegForest.load(path)
    with pytest.raises(InputError, match="real or simulation"):
        LegForest.load("oak")


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_forest_finds_two_legs_where_they_stand(name):
    scan = two_legs_and_a_wall()
    found = LegDetector(LegForest.load(name)).detect(scan)
    legs = found.positions[found.human]
    assert len(legs) == 2
    np.testing.assert_allclose(legs[np.argsort(legs[:, 1])], [[2.2, -0.15], [2.2, 0.15]], atol=0.015)
    assert not found.human[np.flatnonzero(found.clusters.sizes > 100)].any()


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_forest_is_small_and_its_card_says_what_it_is(name):
    card = read_card(name)
    assert card["forest"] == name
    assert card["features"] == list(FEATURE_NAMES)
    assert {"command", "seed", "config", "recorded_data", "limits", "scikit_learn", "scores"} <= set(card)
    forest = LegForest.load(name)
    assert forest.odds == pytest.approx(card["odds"])
    models = Path(__file__).resolve().parents[2] / "perception" / "models"
    assert (models / f"legs_{name}.npz").stat().st_size < 1.5e6


@pytest.mark.parametrize("ranges", [[], [np.nan] * 8, [np.inf] * 8, [0.0] * 8, [1.0, np.nan, np.inf, 0.0]])
def test_a_scan_without_clusters_gives_no_detections(ranges):
    scan = LaserScan(np.array(ranges), np.linspace(-1.0, 1.0, len(ranges)), 0.1, 10.0)
    found = LegDetector(LegForest.load("real")).detect(scan)
    assert len(found) == 0
    assert found.positions.shape == (0, 2)


def test_a_detector_with_nonsense_numbers_is_refused():
    with pytest.raises(InputError, match="gamma"):
        LegDetectorConfig(gamma=1.5)


def test_the_detector_is_deterministic():
    scan = two_legs_and_a_wall()
    forest = LegForest.load("simulation")
    clusters = cluster_scan(scan)
    np.testing.assert_array_equal(forest.confidence(scan, clusters), forest.confidence(scan, clusters))


@pytest.mark.parametrize("name", ["oak", "a" * 300, "a" * 5000])
def test_a_forest_of_no_known_name_is_told(name):
    with pytest.raises(InputError):
        LegForest.load(name)
