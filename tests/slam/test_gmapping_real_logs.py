"""A real building, recorded: bounds far above what is reached, so that a broken matcher shows, noise does not."""

import os
from pathlib import Path

import numpy as np
import pytest
from tagalong.slam.engine import make_slam
from tagalong.slam.logs.carmen import read_carmen
from tagalong.slam.quality.trajectory import absolute_error

pytestmark = pytest.mark.skipif("TAGALONG_DATA" not in os.environ, reason="TAGALONG_DATA names no recorded logs")


def test_a_castle_is_mapped_through_its_loops_with_few_particles():
    drive = read_carmen(Path(os.environ["TAGALONG_DATA"]) / "slam_logs" / "belgioioso_with_odometry.log.gz")
    assert drive.reference is not None
    slam = make_slam("gmapping", particles=10, seed=0)
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        slam.update(odometry, scan)
    assert absolute_error(slam.trajectory(), drive.reference).translation.rmse < 0.4
    assert absolute_error(drive.odometry, drive.reference).translation.rmse > 1.5
    area = np.ptp(slam.map().occupied_points, axis=0)
    assert (area > [15.0, 60.0]).all()
