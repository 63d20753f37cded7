"""Points beside each other err alike: a scan outvotes the odometry only where it clearly fits elsewhere."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray
from tagalong.slam.scan_to_grid.extrapolator import Prediction
from tagalong.slam.scan_to_grid.scan_matcher import GridScanMatcher, GridScanMatcherConfig

AWAY = 0.4  # another place where the scan fits, ahead [m]


@dataclass
class Walls:
    field: NDArray[np.float32]
    corner: NDArray[np.float64]
    resolution: float = 0.05


def spots() -> NDArray[np.float64]:
    """Return (N, 2) places half a metre and more from each other, none of them `AWAY` ahead of another."""
    x, y = np.meshgrid(np.arange(0.0, 6.0, 0.6), np.arange(-6.0, 6.0, 0.6))
    return np.stack((x.ravel() + 1.0, y.ravel()), axis=-1)


def walls(here: float, away: float) -> Walls:
    """Return small walls at a share of the spots where the robot is at the origin, and where it is `AWAY` ahead."""
    field, corner, points = np.zeros((300, 240), np.float32), np.array([-2.0, -7.5]), spots()
    order = np.random.default_rng(1).permutation(len(points))
    for share, ahead in ((here, 0.0), (away, AWAY)):
        chosen = points[order[: round(share * len(points))]] + [ahead, 0.0]
        for col, row in np.rint((chosen - corner) / 0.05).astype(int):
            field[row - 1 : row + 2, col - 1 : col + 2] = 0.6
    return Walls(field, corner)


@pytest.mark.parametrize(("away", "x"), [(0.535, 0.0), (0.95, AWAY)])
def test_a_scan_leaves_the_odometry_only_for_a_place_where_it_fits_much_better(away, x):
    # 200 points, of which 0.5 fit here: 7 or 90 more fit 2.7 standard deviations away
    prediction = Prediction(np.zeros(3), np.array([0.15, 0.02]))
    match = GridScanMatcher(GridScanMatcherConfig()).match(walls(0.5, away), spots(), prediction)
    assert match is not None
    assert match.pose[0] == pytest.approx(x, abs=0.06)


def test_a_few_points_outvote_the_odometry_and_as_many_again_beside_each_of_them_change_nothing():
    # 25 points, of which 0.5 fit here and 0.95 fit 2.7 standard deviations away
    prediction, points = Prediction(np.zeros(3), np.array([0.15, 0.02])), spots()[4::8]
    place, matcher = walls(0.5, 0.95), GridScanMatcher(GridScanMatcherConfig())
    few = matcher.match(place, points, prediction)
    many = matcher.match(place, np.repeat(points, 8, axis=0), prediction)
    assert few is not None
    assert many is not None
    assert few.pose[0] == pytest.approx(AWAY, abs=0.06)
    assert many.pose == pytest.approx(few.pose, abs=1e-4)
    np.testing.assert_allclose(many.told, few.told, rtol=1e-3, atol=1e-3 * np.abs(few.told).max())
    assert matcher.independent(np.repeat(points, 8, axis=0)) == matcher.independent(points) == 25
