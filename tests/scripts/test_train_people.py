"""Frames to train people on, their truth, and the command that trains."""

import json

import numpy as np
import pytest
from tagalong.perception.rgbd import PersonClassifier, RgbdPeople
from tagalong.scripts.benchmarks.rgbd_people import by_distance, by_visible
from tagalong.scripts.cli import main
from tagalong.scripts.training.evaluate_people import PeopleScores, joined, score_frame
from tagalong.scripts.training.rgbd_cameras import floor_in_sight, tilted_camera
from tagalong.scripts.training.rgbd_frames import LabelledFrame, draw_frames
from tagalong.scripts.training.rgbd_props import PROPS, REACH_M
from tagalong.scripts.training.train_people import (
    TEST_SCENES,
    TRAIN_PROPS,
    TRAIN_SCENES,
    PeopleSamples,
    PeopleTrainConfig,
    fit_people,
)
from tagalong.slam import InputError

BRIGHTNESS = 7 * 3 * 4 * 9
"""So many features tell of brightness, the first ones: blocks of 64 x 32 pixels, cells of each, directions."""


def drawn(seed=0, scene="corridor", props="training 1"):
    return draw_frames(np.random.default_rng(seed), (scene,), "training", props, 6)


@pytest.fixture(scope="module")
def frames():
    return [frame for seed in range(3) for frame in drawn(seed)]


def test_the_same_seed_draws_the_same_frames(frames):
    again = drawn(0)
    assert all(a.frame.depth.tobytes() == b.frame.depth.tobytes() for a, b in zip(frames, again, strict=False))


def test_nobody_has_more_pixels_than_with_nothing_before_them(frames):
    met = 0
    for frame in frames:
        pixels = np.bincount(frame.person[frame.person >= 0], minlength=len(frame.places))
        met += np.count_nonzero(pixels > 100)
        assert (pixels <= 1.15 * frame.whole + 30).all()
    assert met >= 5


def test_people_stand_where_their_pixels_are(frames):
    for frame in frames:
        points = frame.frame.camera.rays * frame.frame.depth[..., None]
        for who in np.unique(frame.person[frame.person >= 0]):
            mine = points[(frame.person == who) & np.isfinite(frame.frame.depth)]
            if len(mine) > 100:
                place = np.median(mine[:, :2], axis=0) + np.array(frame.frame.T_robot_camera[:2])
                assert np.hypot(*(place - frame.places[who])) < 0.35


def test_what_is_tested_is_not_what_is_trained_on():
    assert not set(TRAIN_SCENES) & set(TEST_SCENES)
    assert all(not set(PROPS[kinds]) & set(PROPS["unseen"]) for kinds in TRAIN_PROPS)
    with pytest.raises(InputError, match="none, training 0, "):
        drawn(props="statues")


def test_buildings_left_out_together_hold_things_that_the_others_do_not():
    assert len(TRAIN_PROPS) == PeopleTrainConfig().folds
    for mine in TRAIN_PROPS:
        others = set().union(*(PROPS[other] for other in TRAIN_PROPS if other != mine))
        assert not set(PROPS[mine]) & others


def test_people_stand_no_farther_off_than_the_picture_shows_floor():
    assert floor_in_sight(tilted_camera(0.0, 1.0)) == REACH_M
    assert floor_in_sight(tilted_camera(45.0, 1.0)) == pytest.approx(1.0 / np.tan(np.radians(15.0)))
    assert floor_in_sight(tilted_camera(45.0, 0.1)) == 1.5
    frames = draw_frames(np.random.default_rng(3), ("office",), "training", "none", 12, reach=2.0)
    away = np.concatenate([np.hypot(*frame.places.T) for frame in frames])
    assert np.count_nonzero(away < 100.0) > 3
    assert away[away < 100.0].max() < 2.0 + 0.75  # who stands beside somebody may be farther off


def labelled(places, whole=200):
    """A frame with people at `places`, each of 200 pixels."""
    frame = drawn(9)[0].frame
    person = np.full(frame.depth.shape, -1, dtype=np.int32)
    for who in range(len(places)):
        person[2 * who : 2 * who + 2, :100] = who
    return LabelledFrame(
        frame, person, np.array(places, dtype=float), np.full(len(places), whole), np.zeros(len(places), bool)
    )


def found(places, likelihood):
    label = np.full((106, 128), -1, dtype=np.int32)
    return RgbdPeople(np.reshape(places, (-1, 2)).astype(float), np.array(likelihood), label)


def test_recall_precision_and_calibration_are_counted_right():
    frame = labelled([[3.0, 0.0], [4.0, 1.0], [9.0, 0.0]])
    scores = score_frame(found([[3.1, 0.0], [3.0, -1.5], [9.0, 0.1]], [0.9, 0.7, 0.9]), frame)
    assert scores.found.tolist() == [0.9, 0.0]
    assert scores.right.tolist() == [True, False]
    assert (scores.recall(), scores.precision()) == (0.5, 0.5)
    assert scores.calibration_error == pytest.approx((0.1 + 0.7) / 2)
    assert (scores.recall_at(0.9), scores.recall_at(1.0)) == (0.5, 0.5)  # the likelier one is right
    twice = joined([scores, scores])
    assert (twice.frames, len(twice.found), twice.recall()) == (2, 4, 0.5)


def test_recall_at_a_precision_is_that_of_the_lowest_threshold_that_is_precise_enough():
    said = {"likelihood": np.array([0.9, 0.8, 0.8, 0.6, 0.5]), "right": np.array([True, True, False, True, True])}
    scores = PeopleScores(np.array([0.9, 0.8, 0.6, 0.5]), np.ones(4), np.ones(4), np.zeros(4), **said, frames=1)
    assert scores.recall_at(0.95) == 0.25
    assert scores.recall_at(0.75) == 1.0
    assert scores.recall_at(0.81) == 0.25
    said["right"] = ~said["right"]
    assert PeopleScores(*np.ones((4, 1)), **said, frames=1).recall_at(0.95) == 0.0


def test_people_hidden_by_half_or_more_do_not_count_and_are_not_false_either():
    scores = score_frame(found([[3.0, 0.0]], [0.9]), labelled([[3.0, 0.0]], whole=500))
    assert scores.visible.tolist() == [0.4]
    assert scores.figures()["people"] == 0
    assert np.isnan(scores.recall())
    assert scores.right.tolist() == [True]
    assert by_visible(scores) == ["-", "1.000 (1)", "-", "-", "-"]
    assert set(by_distance(scores)) == {"-"}
    assert by_distance(score_frame(found([[3.0, 0.0]], [0.9]), labelled([[3.0, 0.0]])))[4] == "1.000 (1)"


def test_a_second_detection_of_a_person_is_false():
    scores = score_frame(found([[3.0, 0.0], [3.2, 0.0]], [0.9, 0.8]), labelled([[3.0, 0.0]]))
    assert scores.right.tolist() == [True, False]


def test_the_command_trains_and_writes_classifier_and_card(tmp_path, capsys):
    numbers = {"--buildings": 15, "--level-buildings": 2, "--tilted-buildings": 2, "--frames": 5, "--test-buildings": 1}
    counts = [str(word) for pair in numbers.items() for word in pair]
    assert main(["train", "people", *counts, "--out", str(tmp_path)]) == 0
    assert "recall" in capsys.readouterr().out
    assert PersonClassifier.load(tmp_path / "people_rgbd.npz").hidden.shape[1] == PeopleTrainConfig().units
    card = json.loads((tmp_path / "people_rgbd.json").read_text())
    assert card["config"]["buildings"] == 15
    assert card["training"]["people"] > 10
    alone = PersonClassifier.load(tmp_path / "people_rgbd_depth.npz")
    assert not alone.hidden[:BRIGHTNESS].any()
    assert alone.hidden[BRIGHTNESS:].any(axis=0).all()
    assert card["without_colour"]["test"]["frames"] == 5


def test_impossible_numbers_are_errors(tmp_path, capsys):
    assert main(["train", "people", "--buildings", "2", "--out", str(tmp_path)]) != 0
    assert "--buildings" in capsys.readouterr().err


def test_frames_that_show_only_people_or_nobody_are_too_few():
    features, everybody = np.zeros((10, 4), np.float32), np.ones(10, bool)
    for persons in (everybody, ~everybody, np.arange(10) == 3):
        with pytest.raises(InputError, match="too few frames to train on"):
            fit_people(PeopleSamples(features, persons, np.arange(10), np.ones(10)), PeopleTrainConfig())
