"""A query of a SLAM engine changes nothing, `finish` does what is left to do, and the live map follows the drive."""

import numpy as np
import pytest
from tagalong.slam.engine import ENGINES, make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.growing_map import GrowingMap
from walls import cast

HALL = np.array(
    [(0, 0, 12, 0), (12, 0, 12, 9), (12, 9, 0, 9), (0, 9, 0, 0), (4, 3.5, 4.5, 3.5), (8, 5, 8, 5.5), (5, 6, 6, 5.5)],
    dtype=np.float64,
)
FEW = {"gmapping": {"particles": 4, "threads": 1}, "cartographer": {}, "ekf": {}}


@pytest.fixture(scope="module")
def rounds():
    """Return odometry poses and scans of two rounds through a hall, with wheels that slip: loops are closed."""
    rng, t = np.random.default_rng(0), np.linspace(0.0, 4.0 * np.pi, 240)
    ellipse = 6.0 + 4.0 * np.cos(t), 4.5 + 3.0 * np.sin(t), np.arctan2(3.0 * np.cos(t), -4.0 * np.sin(t))
    truth = np.stack(ellipse, axis=-1)
    odometry = [truth[0]]
    for motion in between(truth[:-1], truth[1:]):
        slipped = motion * [1.05, 1.0, 1.05] + rng.normal(0.0, 1.0, 3) * [0.01, 0.005, 0.01]
        odometry.append(compose(odometry[-1], slipped))
    return odometry, [cast(HALL, place, rng, 5.0) for place in truth]


def driven(name, rounds, every=None):
    """Return the engine after the rounds; after each `every` scans, all that it can be asked was asked."""
    engine = make_slam(name, **FEW[name])
    for k, (odometry, scan) in enumerate(zip(*rounds, strict=True)):
        engine.update(odometry, scan)
        if every and k % every == 0:
            for ask in (engine.trajectory, engine.map, engine.live_map):
                ask()
            engine.map_at(0.1)
    return engine


def answers(engine):
    return [engine.trajectory().tobytes(), engine.map().probability.tobytes(), engine.pose.tobytes()]


@pytest.mark.parametrize("name", ENGINES)
def test_a_run_that_is_queried_ends_with_the_same_bytes_as_one_that_is_not(name, rounds):
    asked, left_alone = driven(name, rounds, every=40), driven(name, rounds)
    assert answers(asked) == answers(left_alone)
    for engine in (asked, left_alone):
        engine.finish()
    final = answers(left_alone)
    assert answers(asked) == final
    left_alone.finish()
    assert answers(left_alone) == final
    assert len(left_alone.trajectory()) == len(rounds[0])


def test_only_finish_optimises_the_graph_once_more(rounds):
    engine = driven("cartographer", rounds)
    before = engine.trajectory()
    assert (engine.trajectory() == before).all()
    engine.finish()
    assert (engine.trajectory() != before).any()


@pytest.mark.parametrize("name", ENGINES)
def test_the_live_map_shows_the_walls_of_the_map_whenever_it_is_first_asked_for(name, rounds):
    for every in (40, 239):
        engine = driven(name, rounds, every=every)
        live, drawn = engine.live_map(), engine.map()
        assert live is engine.live_map() or name == "gmapping"
        away = np.linalg.norm(live.occupied_points[:, None] - drawn.occupied_points[None], axis=-1)
        assert np.median(away.min(axis=1)) < 0.1
        assert np.median(away.min(axis=0)) < 0.1


def test_a_growing_map_draws_everything_anew_once_a_scan_has_moved_by_more_than_a_cell(rounds):
    odometry, scans = np.array(rounds[0][:3]), rounds[1][:3]
    for moved, anew in ((0.04, False), (0.06, True)):
        growing, fresh = GrowingMap(), GrowingMap()
        growing.follow(odometry[:2], [0, 1], scans[:2])
        poses = odometry + np.array([[moved], [0.0], [0.0]]) * [1.0, 0.0, 0.0]
        growing.follow(poses, [0, 1, 2], scans)
        fresh.follow(poses, [0, 1, 2], scans)
        assert (growing.map.probability.tobytes() == fresh.map.probability.tobytes()) == anew


def test_what_a_forgotten_scan_drew_stays_until_the_map_is_drawn_anew(rounds):
    odometry, scans = np.array(rounds[0][:80:40]), rounds[1][:80:40]
    both, second = GrowingMap(), GrowingMap()
    both.follow(odometry, [0, 7], scans)
    second.follow(odometry[1:], [7], scans[1:])
    known = both.map.known.sum()
    both.follow(odometry[1:], [7], scans[1:])
    assert both.map.known.sum() == known > second.map.known.sum()
    both.follow(odometry[1:] + 1.0, [7], scans[1:])
    second.follow(odometry[1:] + 1.0, [7], scans[1:])
    assert both.map.probability.tobytes() == second.map.probability.tobytes()
