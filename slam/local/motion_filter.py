"""Drops scans from the map that hardly moved since the last one that was inserted."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..geometry import between


@dataclass(frozen=True, kw_only=True)
class MotionFilterConfig:
    """Settings of `MotionFilter`: a scan passes when any limit is exceeded.

    Attributes:
        max_distance: Translation since the last scan that passed [m].
        max_angle: Rotation since then [rad].
    """

    max_distance: float = 0.2
    max_angle: float = 0.1

    def __post_init__(self) -> None:
        check_numbers(self)
        if not (self.max_distance >= 0.0 and self.max_angle >= 0.0):
            raise InputError(
                f"`max_distance` and `max_angle` must not be negative, got {self.max_distance} and {self.max_angle}"
            )


class MotionFilter:
    """Says whether a pose is far enough from the last one that passed.

    Args:
        config: Settings.
    """

    def __init__(self, config: MotionFilterConfig) -> None:
        self._config = config
        self._last: NDArray[np.float64] | None = None

    def passes(self, pose: NDArray[np.float64]) -> bool:
        """Return whether `pose` (3,) passes, and remember it if so; the first always does."""
        if self._last is not None:
            x, y, turn = between(self._last, pose).tolist()
            if math.hypot(x, y) <= self._config.max_distance and abs(turn) <= self._config.max_angle:
                return False
        self._last = pose
        return True
