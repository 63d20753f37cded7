"""Odometry with what is learned of its wheels and its clock, by the steps between scans that were matched."""

import numpy as np
from numpy.typing import NDArray

from ..scan import LaserScan
from ..scan_to_grid.extrapolator import ExtrapolatorConfig
from ..scan_to_scan.stopped_odometry import StoppedOdometry
from .local_slam import LocalResult
from .matched_steps import MatchedSteps
from .odometry_calibration import OdometryCalibration
from .odometry_clock import OdometryClock

Array = NDArray[np.float64]


class LearnedOdometry:
    """Turns the odometry that a robot tells into what it would tell, were its wheels and its clock known, and sound.

    Args:
        config: Error model of the odometry.

    Attributes:
        calibration: What was learned of the wheels.
        clock: What was learned of how late the odometry is.
    """

    def __init__(self, config: ExtrapolatorConfig) -> None:
        self.calibration, self.clock = OdometryCalibration(), OdometryClock(config)
        self._steps = MatchedSteps()
        self._stopped = StoppedOdometry()

    @property
    def has_stopped(self) -> bool:
        """Whether the odometry has stopped while the robot drives on, so that its scans stand for it."""
        return self._stopped.has_stopped

    @property
    def is_lost(self) -> bool:
        """Whether those scans do not show, either, where the robot went since the last one."""
        return self._stopped.is_lost

    def apply(self, odometry: Array, scan: LaserScan) -> Array:
        """Return T_odom_robot (3,) as it is learned to be, of a scan that is told with `odometry` (3,)."""
        return self._stopped.apply(self.clock.apply(self.calibration.apply(odometry), scan.time_s), scan)

    def learn(self, result: LocalResult, waits: bool) -> None:
        """Learn from where the last scan was matched, or seems to be as long as it `waits`."""
        if (step := self._steps.follow(result, waits)) and not self.has_stopped:
            self.calibration.learn(*step)
            self.clock.learn(*step)
