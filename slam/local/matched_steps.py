"""How the robot moved from scan to scan by what scans tell: what is learned of its odometry is learned from that."""

import numpy as np
from numpy.typing import NDArray

from ..geometry import between, turning
from .local_slam import LocalResult

Array = NDArray[np.float64]


class MatchedSteps:
    """Keeps where the last scan was matched."""

    def __init__(self) -> None:
        self._matched: Array | None = None  # T_local_robot of the last scan, if it was matched as usual

    def follow(self, result: LocalResult, waits: bool) -> tuple[Array, Array] | None:
        """Return how the robot moved since the scan before; None: one of the two was not matched as usual.

        Args:
            result: Where a scan was matched.
            waits: Whether it has to wait for its odometry.

        Returns:
            (3,) the step [m, m, rad] in the robot's frame at the scan before, and (3, 3) its inverse covariance in that
            frame as far as the scan alone tells it.
        """
        sound = result.match and not (waits or result.contradicts or result.odometry_fault or result.jumped)
        before, self._matched = self._matched, result.pose if sound else None
        if before is None or self._matched is None or result.match is None:
            return None
        turn = turning(before.item(2))
        return between(before, result.pose), turn.T @ result.match.told @ turn
