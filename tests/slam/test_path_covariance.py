"""How far off GMapping says that it may be: what a way of matches adds up to, and what coming back is worth."""

import numpy as np
import pytest
from long_corridor import along, drive
from tagalong.slam.engine import make_slam
from tagalong.slam.gmapping.path_covariance import PathCovariance
from tagalong.slam.quality.consistency import beyond, squared_distances

MATCH = np.diag([0.01, 0.01, 0.002]) ** 2
ALL_AROUND = 2.0 * np.pi


def driven(path, poses, field_of_view=ALL_AROUND, **options):
    """Let a path go on over `poses`, and return the standard deviation of the position [m] at each."""
    for pose in np.array(poses, dtype=np.float64):
        path.append(pose, MATCH, field_of_view, **options)
        yield float(np.sqrt(np.trace(path.at(pose)[:2, :2])))


def straight(start, end, heading=0.0):
    xs = np.arange(start, end, 0.4 if end > start else -0.4)
    return np.stack((xs, np.zeros_like(xs), np.full_like(xs, heading)), axis=-1)


def test_each_match_on_the_way_adds_its_own():
    path = PathCovariance(np.zeros(3), 0.3)
    sigma = list(driven(path, straight(0.4, 8.2)))
    assert len(sigma) == 20
    along_way = np.sqrt(path.at(np.array([8.0, 0.0, 0.0]))[0, 0])
    assert along_way == pytest.approx(0.01 * np.sqrt(20))
    drift = 0.002 * 0.4 * np.sqrt(sum(k**2 for k in range(20)))  # of the headings, over what comes after each
    assert sigma[-1] == pytest.approx(np.sqrt(20 * 2 * 0.01**2 + drift**2))


def test_who_is_back_is_as_far_off_as_when_it_was_there_first():
    path = PathCovariance(np.zeros(3), 0.5)
    there = list(driven(path, straight(0.4, 20.0)))
    back = list(driven(path, straight(19.8, 0.0, np.pi)))
    assert there[-1] > 10.0 * there[0]
    assert back[-1] < 1.2 * there[0]
    assert max(back) < 1.1 * there[-1]


def test_what_is_seen_the_other_way_by_half_a_turn_is_something_else():
    path = PathCovariance(np.zeros(3), 0.5)
    there = list(driven(path, straight(0.4, 20.0), np.pi / 2))
    back = list(driven(path, straight(19.8, 0.0, np.pi), np.pi / 2))
    again = list(driven(path, straight(0.2, 4.0), np.pi / 2))
    assert back[-1] > there[-1]
    assert again[-1] < there[12]


def test_a_scan_that_fits_nowhere_is_no_better_known_for_the_place():
    path = PathCovariance(np.zeros(3), 0.5)
    there = list(driven(path, straight(0.4, 20.0)))
    assert next(driven(path, [np.zeros(3)], fits=False)) > there[-1]
    assert next(driven(path, [np.zeros(3)])) < 2.0 * there[0]


def test_laps_of_a_building_cost_no_memory():
    angles, path = np.arange(0.05, 40.0 * np.pi, 0.05), PathCovariance(np.array([5.0, 0.0, 0.0]), 0.5)
    lap = np.stack((5.0 * np.cos(angles), 5.0 * np.sin(angles), angles + np.pi / 2), axis=-1)
    kept = []
    for k, _ in enumerate(driven(path, lap)):
        if k % 126 == 125:
            kept.append(sum(map(len, path._views.values())))
    assert kept[1] == kept[-1] < 80


def test_gmapping_knows_less_the_farther_it_drives_and_more_where_it_has_been():
    engine = make_slam("gmapping", seed=0)  # its laser looks ahead
    updates, _, _ = drive(engine, [along(2.0, 22.0), along(22.0, 2.0), along(2.0, 6.0)], np.zeros(3))
    sigma = np.array([np.sqrt(np.trace(update.covariance[:2, :2])) for update in updates])
    assert sigma[200] > 3.0 * sigma[40] > 0.0
    assert sigma[-5:].max() < 0.3 * sigma.max()


def test_few_poses_lie_where_none_should_by_what_it_says():
    shares = []
    for seed in range(3):
        updates, truth, _ = drive(make_slam("gmapping", seed=seed), [along(2.0, 32.0), along(32.0, 2.0)], np.zeros(3))
        poses, covariances = (np.array([getattr(u, name) for u in updates]) for name in ("pose", "covariance"))
        shares.append(beyond(squared_distances(poses, covariances, truth)))
    assert np.mean(shares) < 0.05
