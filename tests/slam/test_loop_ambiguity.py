"""A loop is closed where a place stands out, and not where another looks alike."""

import numpy as np
from tagalong.slam.graph.loops.constraints import ConstraintBuilder, ConstraintConfig
from tagalong.slam.graph.loops.slack import Slack
from tagalong.slam.local.submap import Submap, SubmapConfig
from tagalong.slam.local.sweep import Sweep
from tagalong.slam.scan_to_grid.scan_matcher import DOUBT
from walls import cast

BEARINGS = np.deg2rad(np.arange(-180.0, 180.0, 1.0))
CORRIDOR = np.array([[-30.0, -1.0, 30.0, -1.0], [-30.0, 1.0, 30.0, 1.0]])
"""Without doors or ends in sight: along it, all places look alike."""
CROSSING = np.array([[-30.0, -1.0, 30.0, -1.0], [-30.0, 1.0, 1.0, 1.0], [3.0, 1.0, 30.0, 1.0], [1.0, 1.0, 1.0, 9.0],
                     [3.0, 1.0, 3.0, 9.0]])  # fmt: skip


def places(walls, off):
    """Return where a scan fits a submap of the same place, from a guess `off` (3,) beside the truth."""
    rng, submap = np.random.default_rng(0), Submap(SubmapConfig(), np.zeros(3))
    for x in np.linspace(-1.0, 1.0, 9):
        pose = np.array([x, 0.0, 0.0])
        submap.insert(Sweep.of(cast(walls, pose, rng, bearings=BEARINGS, reach=6.0), 0.05, 2.0).at(pose))
    submap.finish()
    builder = ConstraintBuilder(ConstraintConfig())
    builder.typical_score = 0.6
    points = cast(walls, np.zeros(3), rng, bearings=BEARINGS, reach=6.0).points_robot
    return builder.places(submap, points, np.array(off), Slack(), np.inf)


def test_a_place_that_stands_out_is_the_only_one():
    (found,) = places(CROSSING, (1.5, 0.3, 0.2))
    np.testing.assert_allclose(found.pose, 0.0, atol=0.05)
    assert found.lead > DOUBT


def test_of_a_corridor_where_all_places_look_alike_two_are_told():
    first, second = places(CORRIDOR, (1.5, 0.3, 0.2))
    assert np.hypot(*(second.pose - first.pose)[:2]) > 1.0  # nearer ones would count as the same
