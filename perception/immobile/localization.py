"""Where the robot is, by the immobile-area map that it draws: SLAM by one map (Zhang et al. 2019).

The paper conducts SLAM by its map and leaves open how the robot is localized. Here each scan, without the returns on
people, is matched on the laser's layer of the map that the scans before it drew (correlative search and least squares,
as in local SLAM of graph SLAM). No loop is closed: the drift of a long way stays.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import check_numbers, checked_pose
from ...slam.errors import InputError
from ...slam.immobile.layers import ImmobileLayers
from ...slam.scan import LaserScan
from ...slam.scan_to_grid.degenerate_direction import degenerate_direction
from ...slam.scan_to_grid.extrapolator import ExtrapolatorConfig, OdometryExtrapolator
from ...slam.scan_to_grid.scan_matcher import GridScanMatcher, GridScanMatcherConfig
from ...slam.scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter

Array = NDArray[np.float64]

_MARGIN = 8  # unknown cells around the known ones: all that the spline of the matcher looks at


@dataclass(frozen=True, kw_only=True)
class ImmobileLocalizationConfig:
    """Settings of `ImmobileLocalization`.

    Attributes:
        extrapolator: Error model of the odometry.
        voxel_filter: How returns are thinned.
        matcher: How they are matched.
        most_likely: Returns that are more likely than this on a person match nothing, in [0, 1].
    """

    extrapolator: ExtrapolatorConfig = field(default_factory=ExtrapolatorConfig)
    voxel_filter: AdaptiveVoxelConfig = field(default_factory=AdaptiveVoxelConfig)
    matcher: GridScanMatcherConfig = field(default_factory=GridScanMatcherConfig)
    most_likely: float = 0.5

    def __post_init__(self) -> None:
        check_numbers(self)
        if not 0.0 <= self.most_likely <= 1.0:
            raise InputError(f"`most_likely` must be in [0, 1], got {self.most_likely}")


@dataclass(eq=False)
class LaserWalls:
    """The laser's layer of a map, for the matcher.

    Attributes:
        field: (rows, cols) odds as probabilities; 0 where no ray came.
        corner: (2,) centre of cell [0, 0] [m].
        resolution: Side of a cell [m].
    """

    field: NDArray[np.float32]
    corner: Array
    resolution: float

    @classmethod
    def of(cls, grid: ImmobileLayers) -> "LaserWalls":
        """Return those of a grid."""
        known = grid.laser_map()
        field = np.pad(np.nan_to_num(known.probability, nan=0.0), _MARGIN)
        corner = np.array(known.origin) + (0.5 - _MARGIN) * known.resolution
        return cls(field, corner, known.resolution)


class ImmobileLocalization:
    """Carries the robot's pose on, scan by scan; who draws the map writes each scan at the pose that it is told.

    Args:
        config: Settings.
    """

    def __init__(self, config: ImmobileLocalizationConfig | None = None) -> None:
        self._config = config or ImmobileLocalizationConfig()
        self._extrapolator: OdometryExtrapolator | None = None
        self._voxel_filter = AdaptiveVoxelFilter(self._config.voxel_filter)
        self._matcher = GridScanMatcher(self._config.matcher)
        self._odometry: Array | None = None

    def locate(
        self, grid: ImmobileLayers, odometry: ArrayLike, scan: LaserScan, people: ArrayLike | float = 0.0
    ) -> Array:
        """Return (3,) T_map_robot of a scan; the first one is where its odometry says.

        Args:
            grid: What the scans before it drew.
            odometry: (3,) T_odom_robot at the scan.
            scan: The scan.
            people: (N,) or one: how likely each beam met a person, in [0, 1].
        """
        now = self._odometry = checked_pose(odometry, before=self._odometry)
        if self._extrapolator is None:
            self._extrapolator = OdometryExtrapolator(self._config.extrapolator, now)
            return now
        prediction = self._extrapolator.predict(now)
        stays = (np.broadcast_to(people, scan.ranges.shape) <= self._config.most_likely)[scan.is_return]
        points = self._voxel_filter.apply(scan.points_robot[stays])
        match = self._matcher.match_anyhow(LaserWalls.of(grid), points, prediction, degenerate_direction(scan, points))
        if match:
            self._matcher.believe(match)
        pose = prediction.pose if match is None else match.pose
        self._extrapolator.correct(now, pose)
        return pose
