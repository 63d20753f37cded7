"""A corridor comes out as long as it is: range noise does not wear away what stands before other things."""

from itertools import pairwise

import numpy as np
from tagalong.slam.engine import make_slam
from tagalong.slam.local.active_submaps import ActiveSubmapsConfig
from tagalong.slam.local.local_slam import LocalSlamConfig
from tagalong.slam.local.submap import SubmapConfig
from tagalong.slam.scan import LaserScan
from walls import cast

LENGTH = 45.0
BEARINGS = np.radians(np.linspace(-135.0, 135.0, 541))


def corridor():
    """Return (m, 4) walls of a corridor 2.4 m wide with recessed doors and pillars, as many on either side."""
    lines = [(-1.0, -1.2, -1.0, 1.2), (LENGTH, -1.2, LENGTH, 1.2)]
    for side, shift in ((-1.0, 0.0), (1.0, 1.7)):
        line = [(-1.0, 1.2)]
        for x in np.arange(1.0 + shift, LENGTH - 4.0, 4.0):
            line += [(x, 1.2), (x, 1.35), (x + 0.9, 1.35), (x + 0.9, 1.2)]
            line += [(x + 2.2, 1.2), (x + 2.2, 1.05), (x + 2.5, 1.05), (x + 2.5, 1.2)]
        line.append((LENGTH, 1.2))
        lines += [(a, side * b, c, side * d) for (a, b), (c, d) in pairwise(line)]
    return np.array(lines)


def drawn_too_long(engine, **options):
    """How much too far the robot believes to have come in 37 m [m]."""
    rng, lines, slam = np.random.default_rng(5), corridor(), make_slam(engine, seed=0, **options)
    truth = np.stack((np.arange(0.0, LENGTH - 8.0, 0.1),) * 3, axis=-1) * [1.0, 0.0, 0.0]
    for pose in truth:
        exact = cast(lines, pose, rng, 30.0, 0.0, BEARINGS)
        noise = np.where(exact.ranges > 10.0, 0.03, 0.01) * rng.standard_normal(len(exact))
        slam.update(pose * [1.01, 1.0, 1.0], LaserScan(exact.ranges + noise, exact.bearings, 0.1, 30.0))
    slam.finish()
    return slam.trajectory()[-1, 0] - truth[-1, 0]


def test_a_corridor_is_drawn_as_long_as_it_is_where_the_ends_of_rays_are_not_taken_for_free():
    worn = LocalSlamConfig(submaps=ActiveSubmapsConfig(submap=SubmapConfig(ray_margin=0.0)))
    assert drawn_too_long("cartographer", local=worn) > 0.02
    assert abs(drawn_too_long("cartographer")) < 0.01
