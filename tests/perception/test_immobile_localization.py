"""SLAM by the immobile-area map: the robot is where its scans fit on what earlier scans drew."""

import numpy as np
import pytest
from tagalong.perception.immobile.localization import ImmobileLocalization, ImmobileLocalizationConfig, LaserWalls
from tagalong.perception.immobile.mapper import ImmobileMapper
from tagalong.slam import InputError, LaserScan
from tagalong.slam.geometry import between, compose

BEARINGS = np.linspace(-np.pi, np.pi, 360, endpoint=False)


def room_scan(pose, time_s, person=None):
    """A scan of a room of 8.04 by 6.04 m around the origin, and of a person of radius 0.3 at `person`.

    No wall lies on the border of two cells, where a grid draws it half a cell to one side.
    """
    heading = BEARINGS + pose[2]
    with np.errstate(divide="ignore"):
        across = np.where(np.cos(heading) > 0.0, 4.02 - pose[0], -4.02 - pose[0]) / np.cos(heading)
        along = np.where(np.sin(heading) > 0.0, 3.02 - pose[1], -3.02 - pose[1]) / np.sin(heading)
    ranges = np.minimum(across, along)
    met = np.zeros(len(ranges), dtype=bool)
    if person is not None:
        towards = np.subtract(person, pose[:2])
        ahead = towards[0] * np.cos(heading) + towards[1] * np.sin(heading)
        aside = towards[1] * np.cos(heading) - towards[0] * np.sin(heading)
        met = (ahead > 0.0) & (np.abs(aside) < 0.3)
        ranges = np.where(met, ahead - np.sqrt(np.maximum(0.09 - aside**2, 0.0)), ranges)
    return LaserScan(ranges, BEARINGS, 0.1, 20.0, time_s), met


def driven(count=200):
    """The true path and odometry that is 6 % too long and turns 4 % too little."""
    truth, odometry = [np.zeros(3)], [np.zeros(3)]
    for k in range(count):
        motion = np.array([0.03, 0.0, 0.03 if k % 100 < 50 else -0.02])
        truth.append(compose(truth[-1], motion))
        odometry.append(compose(odometry[-1], motion * (1.06, 1.0, 0.96)))
    return np.array(truth), np.array(odometry)


def test_it_stays_on_the_map_where_the_odometry_does_not():
    truth, odometry = driven()
    mapper, localization = ImmobileMapper(), ImmobileLocalization()
    for k, (true, driven_to) in enumerate(zip(truth, odometry, strict=True)):
        beside = compose(true, (1.0, 0.3, 0.0))[:2]  # a person who walks along with the robot
        scan, met = room_scan(true, 0.1 + 0.1 * k, beside)
        pose = localization.locate(mapper.grid, driven_to, scan, met.astype(float))
        mapper.add_scan(pose, scan, met.astype(float))
    assert np.hypot(*between(truth[-1], odometry[-1])[:2]) > 0.2
    assert np.hypot(*between(truth[-1], pose)[:2]) < 0.05  # a cell


def test_the_walls_that_it_matches_lie_where_the_map_has_them():
    mapper = ImmobileMapper()
    for k in range(5):
        mapper.add_scan(np.zeros(3), room_scan(np.zeros(3), 0.1 + 0.1 * k)[0])
    walls = LaserWalls.of(mapper.grid)
    rows, cols = np.nonzero(walls.field > 0.5)
    x, y = (walls.corner + walls.resolution * np.stack((cols, rows), axis=-1)).T
    assert np.abs(np.maximum(np.abs(x) - 4.02, np.abs(y) - 3.02)).max() < 0.08
    assert not walls.field[:8].any()
    assert not walls.field[:, -8:].any()


def test_a_likelihood_beyond_one_is_refused():
    with pytest.raises(InputError, match="most_likely"):
        ImmobileLocalizationConfig(most_likely=1.5)


def test_what_is_surely_people_moves_nobody():
    mapper, localization = ImmobileMapper(), ImmobileLocalization()
    for k in range(5):
        scan, _ = room_scan(np.zeros(3), 0.1 + 0.1 * k)
        mapper.add_scan(localization.locate(mapper.grid, np.zeros(3), scan), scan)
    beside = np.array([0.1, 0.0, 0.0])  # the odometry slips; the walls say that the robot stands
    believing = localization.locate(mapper.grid, beside, scan, people=1.0)
    np.testing.assert_allclose(believing, beside, atol=0.005)
    seeing = localization.locate(mapper.grid, beside, scan)
    assert abs(seeing[0]) < 0.03
