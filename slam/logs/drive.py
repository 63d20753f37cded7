"""A recorded drive: what a robot's odometry and laser said, scan by scan."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_poses
from ..errors import InputError
from ..scan import LaserScan


@dataclass(frozen=True, eq=False)
class RecordedDrive:
    """Scans in the order of the log, each with the odometry at that time.

    Attributes:
        odometry: (n, 3) T_odom_robot of each scan [m, m, rad].
        scans: The n scans; `time_s` is the log's stamp as written there, which may be rounded or always zero: the
            order of the scans is what counts.
        reference: (n, 3) T_map_robot of each scan, corrected poses that the log carries beside its odometry, or None
            where it carries none.
        name: Name of the drive, for tables and titles.
        has_odometry: Whether the log said how the robot moved; if not, `odometry` is all zeros.
        notes: What the reader had to assume or leave out, a sentence each.

    Raises:
        InputError: If the numbers of poses and scans differ, or a pose is not finite, out of bounds, or far from the
            one before.
    """

    odometry: NDArray[np.float64]
    scans: list[LaserScan]
    reference: NDArray[np.float64] | None
    name: str
    has_odometry: bool = True
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for field, poses in (("odometry", self.odometry), ("reference", self.reference)):
            if poses is None:
                continue
            if poses.shape != (len(self.scans), 3):
                raise InputError(f"`{field}` must have shape ({len(self.scans)}, 3), one per scan, got {poses.shape}")
            check_poses(poses, field)

    def __len__(self) -> int:
        return len(self.scans)

    @property
    def times_s(self) -> NDArray[np.float64]:
        """(n,) stamps of the scans [s], as the log has them."""
        return np.array([scan.time_s for scan in self.scans])
