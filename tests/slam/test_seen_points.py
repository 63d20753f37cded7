"""What a scan sees for the first time does not hold the robot back."""

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.geometry import between, compose
from tagalong.slam.local.seen_points import near_visits, telling
from walls import cast

AHEAD = np.linspace(-np.pi / 2, np.pi / 2, 181)
CORRIDOR = np.array(
    [(-40.0, -1.2, 6.0, -1.2), (6.0, -1.2, 6.0, 1.3)]
    + [(x, 1.3, x + 2.5, 1.3) for x in np.arange(-40.0, 6.0, 3.5)]
    + [(x + 2.5, 1.3, x + 2.5, 1.6) for x in np.arange(-40.0, 6.0, 3.5)]
    + [(x + 2.5, 1.6, x + 3.5, 1.6) for x in np.arange(-40.0, 6.0, 3.5)]
    + [(x + 3.5, 1.6, x + 3.5, 1.3) for x in np.arange(-40.0, 6.0, 3.5)]
)


def test_points_count_that_fall_near_what_was_seen():
    visits = np.zeros((20, 20), np.float32)
    visits[:, :10] = 1.0
    points = np.array([(0.2, 0.5), (0.58, 0.5), (0.8, 0.5), (3.0, 3.0)])
    near = near_visits(visits, np.zeros(2), 0.05, points, np.zeros(3), 0.1, 0.0)
    assert near.tolist() == [True, True, False, False]
    turned = near_visits(visits, np.zeros(2), 0.05, points, np.zeros(3), 0.1, 0.3)
    assert turned.tolist() == [True, True, True, False]


def test_points_tell_that_lie_where_something_was_seen_or_that_only_a_beam_through_a_wall_could_see():
    visits, field = np.zeros((40, 40), np.float32), np.zeros((40, 40), np.float32)
    visits[:, :10] = 1.0
    field[5:15, 12] = 1.0
    points = np.array([(0.2, 0.5), (1.9, 0.5), (1.9, 1.9), (0.7, 0.5)])  # seen; behind the wall; past it; at the wall
    for chosen, tells in zip(points, (1, 1, 0, 0), strict=True):
        count = telling(field, visits, np.zeros(2), 0.05, np.array([0.1, 0.5]), chosen[None], np.zeros(3))
        assert count == tells


@pytest.mark.parametrize("step", [-1.2, -0.6])
def test_a_robot_that_drives_backwards_down_a_corridor_lags_little(step):
    rng, engine = np.random.default_rng(2), make_slam("cartographer", global_=None)
    truth = np.array([(3.0 + step * k, 0.0, 0.0) for k in range(int(36 / -step))])
    odometry = [truth[0]]
    for move in between(truth[:-1], truth[1:]):
        odometry.append(compose(odometry[-1], move + rng.normal(0.0, (0.01, 0.005, 0.002))))
    for pose, at in zip(odometry, truth, strict=True):
        engine.update(pose, cast(CORRIDOR, at, rng, bearings=AHEAD))
    off = between(truth[-1], compose(truth[0], between(engine.trajectory()[0], engine.trajectory()[-1])))
    assert abs(off[0]) < 0.05 * 36
