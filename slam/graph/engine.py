"""The engine "cartographer": local SLAM, loop closure and pose adjustment behind the one protocol of all engines."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..engine import SlamUpdate
from ..scan import LaserScan
from .local_slam import LocalSlam, LocalSlamConfig


@dataclass(frozen=True, kw_only=True)
class CartographerConfig:
    """Settings of `Cartographer`.

    Attributes:
        local: Settings of local SLAM.
    """

    local: LocalSlamConfig = field(default_factory=LocalSlamConfig)


class Cartographer:
    """Graph SLAM of Cartographer's kind.

    Args:
        config: Settings.
    """

    def __init__(self, config: CartographerConfig) -> None:
        self._local = LocalSlam(config.local)
        self._poses: list[NDArray[np.float64]] = []

    @classmethod
    def from_options(cls, **options: Any) -> "Cartographer":
        """Return an engine with the given fields of `CartographerConfig`."""
        return cls(CartographerConfig(**options))

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        result = self._local.update(np.asarray(odometry, dtype=np.float64), scan)
        self._poses.append(result.pose)
        return SlamUpdate(result.pose, result.insertion is not None, {})

    def trajectory(self):
        return np.array(self._poses)
    def summary(self):
        return f"{len(self._local.submaps)} submaps"
