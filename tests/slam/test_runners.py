"""Whole drives through engines and localizers give what the scans one by one give."""

import numpy as np
import pytest
from tagalong.slam.engine import SlamUpdate, make_slam
from tagalong.slam.grid import GridConfig, render_map
from tagalong.slam.localization.localizer import Localizer
from tagalong.slam.localization.runner import run_localizer
from tagalong.slam.logs.drive import RecordedDrive
from tagalong.slam.runner import run_slam
from walls import cast

ROOM = np.array([(-4, -3, 5, -3), (5, -3, 5, 4), (5, 4, -4, 4), (-4, 4, -4, -3), (1, 0, 1, 1), (1, 1, 2, 1)], float)


@pytest.fixture(scope="module")
def drive():
    poses = np.stack((0.05 * np.arange(40), np.zeros(40), 0.01 * np.arange(40)), axis=-1)
    rng = np.random.default_rng(0)
    return RecordedDrive(poses, [cast(ROOM, pose, rng) for pose in poses], None, "room")


def test_a_run_holds_what_the_engine_says_scan_by_scan_and_draws_its_map(drive):
    engine, other = (make_slam("gmapping", particles=3, linear_update=0.2, threads=1) for _ in range(2))
    run = run_slam(other, drive)
    updates = [engine.update(odometry, scan) for odometry, scan in zip(drive.odometry, drive.scans, strict=True)]
    np.testing.assert_array_equal(run.online, [update.pose for update in updates])
    np.testing.assert_array_equal(run.integrated, [update.integrated for update in updates])
    assert run.located.all()
    assert run.trajectory.shape == (40, 3)
    assert run.seconds.min() > 0.0
    assert run.map().resolution == engine.map().resolution
    assert run.map(0.2).resolution == 0.2


class Believer:
    """An engine that believes the odometry, and whose clock is its number of scans."""

    def __init__(self):
        self.poses, self.finished = [], False

    def update(self, odometry, scan):
        self.poses.append(odometry)
        return SlamUpdate(odometry, False, {}, located=len(self.poses) > 3)

    def finish(self):
        self.finished = True

    def trajectory(self):
        assert self.finished  # what is told at the end is the best knowledge
        return np.array(self.poses)


def test_progress_sees_every_scan_and_the_clock_is_the_callers(drive):
    seen, engine = [], Believer()
    run = run_slam(engine, drive, progress=lambda scans: (seen.append(s) or s for s in scans), clock=lambda: 2.0)
    assert seen == drive.scans
    np.testing.assert_array_equal(run.trajectory, drive.odometry)
    assert run.located.tolist() == [False] * 3 + [True] * 37
    assert not run.seconds.any()


def test_a_localizer_that_was_at_work_before_tells_of_this_drive_alone(drive):
    grid = render_map(drive.odometry, drive.scans, GridConfig())
    localizer = Localizer(grid, start=drive.odometry[0])
    first = run_localizer(localizer, RecordedDrive(drive.odometry[:20], drive.scans[:20], None, "first"))
    run = run_localizer(localizer, RecordedDrive(drive.odometry[20:], drive.scans[20:], None, "rest"))
    assert first.sure.all()
    assert run.sure.all()
    np.testing.assert_array_equal(np.vstack((first.trajectory, run.trajectory)), localizer.trajectory())
    np.testing.assert_allclose(run.trajectory, drive.odometry[20:], atol=0.03)
    assert run.matched.all()
    assert run.explained.min() > 0.9
    assert run.losses == 0
