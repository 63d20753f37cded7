"""The engine "cartographer": local SLAM, loop closure and pose adjustment behind the one protocol of all engines."""

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..engine import SlamUpdate
from ..errors import InputError
from ..grid import GridConfig, render_map
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .local_slam import LocalSlam, LocalSlamConfig

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CartographerConfig:
    """Settings of `Cartographer`.

    Attributes:
        local: Settings of local SLAM.
        resolution: Side of a cell of the map that `map` returns [m].
    """

    local: LocalSlamConfig = field(default_factory=LocalSlamConfig)
    resolution: float = 0.05

    def __post_init__(self) -> None:
        if not self.resolution > 0.0:
            raise InputError(f"`resolution` must be positive [m], got {self.resolution}")


class Cartographer:
    """Graph SLAM of Cartographer's kind (Hess, Kohler, Rapp, Andor 2016); a `SlamEngine`.

    `SlamUpdate.diagnostics`: `score` (mean occupancy of the submap under the scan's points, 0 .. 1).

    Args:
        config: Settings.
    """

    def __init__(self, config: CartographerConfig | None = None) -> None:
        self.config = config or CartographerConfig()
        self._local = LocalSlam(self.config.local)
        self._online: list[Array] = []
        self._inserted: list[tuple[Array, LaserScan]] = []

    @classmethod
    def from_options(cls, seed: int = 0, **options: Any) -> Self:
        """Return an engine with fields of `CartographerConfig` as keywords; nothing is random, so `seed` says nothing.

        Raises:
            TypeError: If a field is unknown.
            InputError: If a value is out of its range.
        """
        return cls(CartographerConfig(**options))

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        odometry = np.array(odometry, dtype=np.float64)
        if odometry.shape != (3,) or not np.isfinite(odometry).all():
            raise InputError(f"`odometry` must be a finite pose of shape (3,), got {odometry}")
        result = self._local.update(odometry, scan)
        self._online.append(result.pose)
        if result.insertion:
            self._inserted.append((result.pose, scan))
        diagnostics = {"score": result.match.score} if result.match else {}
        return SlamUpdate(self.pose, result.insertion is not None, diagnostics)

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot, the best estimate now."""
        return self._online[-1].copy() if self._online else np.zeros(3)

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan so far, by the best knowledge now."""
        return self.online_trajectory()

    def online_trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them, each the best knowledge of its time."""
        return np.array(self._online).reshape(-1, 3)

    def map(self) -> OccupancyMap:
        """Return the map that the inserted scans draw, with cells of `resolution`."""
        return self.map_at(self.config.resolution)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map with cells of `resolution` [m], drawn anew from the inserted scans."""
        poses = np.array([pose for pose, _ in self._inserted]).reshape(-1, 3)
        return render_map(poses, (scan for _, scan in self._inserted), GridConfig(resolution=resolution))
