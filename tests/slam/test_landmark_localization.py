"""Localization on a known map of landmarks: posts, wheels with systematic errors, map files good and bad."""

import json

import numpy as np
import pytest
from landmark_worlds import cast, circle_path, draw_posts, typical_wheels
from tagalong.scripts import cli
from tagalong.slam.ekf.landmark_localizer import LandmarkLocalizer, LandmarkLocalizerConfig
from tagalong.slam.engine import make_slam
from tagalong.slam.errors import InputError
from tagalong.slam.geometry import between, inverse, transform_points
from tagalong.slam.landmarks.clustering import METHODS, make_clusterer
from tagalong.slam.landmarks.landmark_map import LandmarkMap, read_landmark_map, write_landmark_map
from tagalong.slam.localization.localizer import State
from tagalong.slam.localization.runner import run_localizer
from tagalong.slam.logs.carmen_writer import write_carmen
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.logs.tum import read_tum


def world(seed=0, laps=0.3):
    """Return a drive, its true poses (n, 3) and its posts (k, 2), both in the frame of the first pose."""
    rng, path = np.random.default_rng(seed), circle_path(laps=laps)
    posts = draw_posts(rng, 24, path)
    scans = [cast(pose, posts, rng) for pose in path]
    drive = RecordedDrive(typical_wheels(path, rng), scans, None, "posts")
    return drive, between(path[0], path), transform_points(inverse(path[0]), posts)


def exact(posts):
    return LandmarkMap(posts, np.zeros((len(posts), 2, 2)), np.zeros(len(posts), dtype=np.int64))


def errors(run, truth):
    return np.hypot(*(run.trajectory - truth)[:, :2].T)


@pytest.mark.parametrize("clustering", METHODS)
def test_every_clustering_follows_the_robot_better_than_its_wheels_do(clustering):
    drive, truth, posts = world(laps=0.2)
    config = LandmarkLocalizerConfig(clustering=clustering, travel=1.5, turn=1.0)
    run = run_localizer(LandmarkLocalizer(exact(posts), config), drive)
    assert run.sure.all()
    assert run.losses == 0
    assert errors(run, truth).max() < 0.15
    assert np.nanmedian(run.explained) >= 0.5


@pytest.mark.parametrize("clustering", METHODS)
def test_every_clustering_maps(clustering):
    drive, truth, _ = world(laps=0.1)
    engine = make_slam("ekf", clustering=clustering, travel=1.2, turn=1.0)
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        engine.update(odometry, scan)
    assert np.hypot(*(engine.pose - truth[-1])[:2]) < 0.2
    assert len(engine.times_seen) >= 2


def test_a_start_that_is_somewhat_wrong_is_put_right():
    drive, truth, posts = world()
    run = run_localizer(LandmarkLocalizer(exact(posts), start=(0.3, -0.2, 0.1)), drive)
    assert errors(run, truth)[20:].max() < 0.1


def test_landmarks_that_the_map_does_not_know_make_it_unsure_and_known_ones_sure_again():
    drive, truth, posts = world()
    elsewhere = world(seed=5)[0].scans
    scans = drive.scans[:40] + elsewhere[40:70] + drive.scans[70:]
    localizer = LandmarkLocalizer(exact(posts))
    run = run_localizer(localizer, RecordedDrive(drive.odometry, scans, None, "swapped"))
    assert run.sure[:40].all()
    assert not run.sure[60:70].any()
    assert run.losses == 1
    assert errors(run, truth)[80:].max() < 0.15
    assert localizer.pose is not None


def test_without_landmarks_in_view_it_ends_unsure():
    drive, _, posts = world()
    config = LandmarkLocalizerConfig(lost_sigma=0.2)
    localizer = LandmarkLocalizer(exact(posts), config)
    for k, scan in enumerate([*drive.scans[:5], *[drive.scans[0].without(np.ones(181, dtype=bool))] * 300]):
        update = localizer.update(drive.odometry[min(k, 5)], scan)
    assert update.state is State.SEARCHING
    assert update.pose is None


def test_what_slam_maps_the_localizer_reads(tmp_path, capsys):
    drive, truth, posts = world(laps=0.6)
    write_carmen(tmp_path / "posts.log", drive)
    words = [str(tmp_path / "posts.log"), "--quiet", "--out"]
    assert cli.main(["slam", *words, str(tmp_path / "map"), "--method", "ekf"]) == 0
    landmarks = read_landmark_map(tmp_path / "map" / "landmarks.json")
    apart = np.hypot(*(landmarks.places[:, None] - posts).transpose(2, 0, 1)).min(axis=1)
    assert len(landmarks) >= 8
    assert np.median(apart) < 0.1
    assert landmarks.times_seen.min() >= 3
    onto = ["--map", str(tmp_path / "map" / "landmarks.json"), "--method", "landmarks", "--clustering", "heuristic"]
    assert cli.main(["localize", *words, str(tmp_path / "out"), *onto, "--set", "travel=0.3"]) == 0
    assert "explained by the map" in capsys.readouterr().out
    metrics = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert (metrics["method"], metrics["config"]["clustering"], metrics["config"]["travel"]) == (
        "landmarks",
        "heuristic",
        0.3,
    )
    assert metrics["sure_share"] > 0.9
    found = read_tum(tmp_path / "out" / "trajectory.tum").poses
    assert np.hypot(*(found - truth[-len(found) :])[:, :2].T).max() < 0.3


@pytest.mark.parametrize("name", ["map.json", "map.csv"])
def test_a_map_of_landmarks_survives_being_written(tmp_path, name):
    places = np.array([[1.25, -2.5], [0.1, 1e6]])
    covariances = np.array([[[1e-4, 2e-5], [2e-5, 3e-4]], np.zeros((2, 2))])
    write_landmark_map(tmp_path / name, LandmarkMap(places, covariances, np.array([7, 0])))
    again = read_landmark_map(tmp_path / name)
    np.testing.assert_array_equal(again.places, places)
    np.testing.assert_array_equal(again.covariances, covariances)
    assert again.times_seen.tolist() == ([7, 0] if name == "map.json" else [0, 0])


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        ("a.json", "{", "a.json:1:2: no JSON"),
        ("a.json", "[1]", 'a.json: must be {"landmarks":'),
        ("a.json", '{"landmarks": []}', "has 1 .. 10000 landmarks, got 0"),
        ("a.json", '{"landmarks": [{"x": 1}]}', "landmark 0 must have `x`, `y`"),
        ("a.json", '{"landmarks": [{"x": 1, "y": 2, "z": 3}]}', "landmark 0 must have `x`, `y`"),
        ("a.json", '{"landmarks": [{"x": 1, "y": "far"}]}', "landmark 0: finite numbers needed, got 'far'"),
        ("a.json", '{"landmarks": [{"x": 1, "y": 1e9}]}', "`places` must lie within 1e+07 m"),
        ("a.json", '{"landmarks": [{"x": 1, "y": 1, "covariance": [1, 2]}]}', "`covariance` must be three numbers"),
        ("a.json", '{"landmarks": [{"x": 1, "y": 1, "covariance": [1, 2, 1]}]}', "the covariance of landmark 0"),
        ("a.json", '{"landmarks": [{"x": 1, "y": 1, "seen": -1}]}', "`seen` must be a whole number"),
        ("a.json", '{"landmarks": [{"x": 0, "y": 0}, {"x": 1e6, "y": 1e6}]}', "would grow to"),
        ("a.csv", "1,2\n", "a.csv:1: the first line must be `x,y`"),
        ("a.csv", "x,y\n1,2,3\n", "a.csv:2: 2 numbers needed"),
        ("a.csv", "x,y\n1,zwei\n", "a.csv:2"),
        ("a.csv", "", "has 1 .. 10000 landmarks, got 0"),
        ("a.txt", "x,y\n1,2\n", "a map of landmarks is a .json or .csv file"),
    ],
)
def test_bad_maps_end_in_one_line(tmp_path, capsys, name, text, complaint):
    (tmp_path / name).write_text(text)
    words = ["localize", "none.log", "--map", str(tmp_path / name), "--method", "landmarks"]
    assert cli.main([*words, "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1
    assert name in said


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (["--method", "stars"], "unknown localization method 'stars'; localization methods: grid, landmarks"),
        (["--method", "landmarks", "--clustering", "optics"], "unknown clustering method 'optics'"),
        (["--method", "landmarks", "--set", "gait=1"], "unknown LandmarkLocalizerConfig field 'gait'"),
        (["--clustering", "gmm"], "--clustering is for --method landmarks"),
        (["--set", "gait=1"], "unknown LocalizerConfig field 'gait'"),
    ],
)
def test_wrong_options_of_localization_end_in_one_line(tmp_path, capsys, words, complaint):
    (tmp_path / "map.json").write_text('{"landmarks": [{"x": 1, "y": 2}]}')
    assert cli.main(["localize", "none.log", "--map", str(tmp_path / "map.json"), "--out", "out", *words]) == 2
    said = capsys.readouterr().err
    assert complaint in said
    assert said.count("\n") == 1


def test_the_gaussian_mixture_tells_its_means_and_covariances():
    rng = np.random.default_rng(0)
    spread = np.array([[0.04, 0.0], [0.0, 0.01]])
    points = np.concatenate([rng.multivariate_normal(centre, spread, 200) for centre in ((0.0, 0.0), (5.0, 1.0))])
    gmm = make_clusterer("gmm", choice="bic", most=3)
    mixture = gmm.fit(points)
    order = np.argsort(mixture.means[:, 0])
    np.testing.assert_allclose(mixture.means[order], [(0.0, 0.0), (5.0, 1.0)], atol=0.05)
    np.testing.assert_allclose(mixture.covariances[order], [spread] * 2, atol=0.015)
    assert mixture.weights.sum() == pytest.approx(1.0)
    np.testing.assert_array_equal(mixture.labels, gmm.fit_predict(points))
    with pytest.raises(InputError, match="two points that differ"):
        gmm.fit(np.ones((4, 2)))
