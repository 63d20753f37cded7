"""The one protocol of every SLAM engine, and the table of engines."""

from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import unknown_name
from .occupancy_map import OccupancyMap
from .scan import LaserScan


@dataclass(frozen=True, eq=False)
class SlamUpdate:
    """What an engine made of one scan.

    Attributes:
        pose: (3,) T_map_robot, the best estimate now [m, m, rad].
        integrated: Whether the scan was matched and written into the map; False where the motion since the last
            integrated scan was too small and the pose was predicted by odometry only.
        diagnostics: Numbers of the engine's own (documented there), e.g. the effective number of particles.
        located: Whether the engine knows where on its map the robot is; False after a kidnapping or a long gap in the
            log, until it has found the place again: then `pose` is only carried on by the odometry.
        covariance: (3, 3) of the pose, map frame [m, m, rad]; None: the engine has none.
    """

    pose: NDArray[np.float64]
    integrated: bool
    diagnostics: dict[str, float]
    located: bool = True
    covariance: NDArray[np.float64] | None = None


class SlamEngine(Protocol):
    """Turns odometry and scans into a pose, a trajectory and a map.

    The map frame is the frame of the first odometry pose, so the first estimate equals the first odometry.

    Only `update` and `finish` change what the engine believes. All the others are queries: they tell what is known now,
    and a run in which they are asked ends with the same poses and maps, to the byte, as one in which they are not.
    """

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        ...

    def finish(self) -> None:
        """Improve the poses as far as the engine can once a drive, or a part of it, is over.

        Graph SLAM matches each scan with all submaps around it and optimises its graph, which takes seconds. Engines
        that do all their work scan by scan (GMapping, EKF) do nothing. A second call without a scan in between does
        nothing, too, and the drive may go on afterwards.
        """
        ...

    @property
    def config(self) -> Any:
        """The resolved configuration, a frozen dataclass."""
        ...

    @property
    def pose(self) -> NDArray[np.float64]:
        """(3,) T_map_robot, the best estimate now."""
        ...

    def trajectory(self) -> NDArray[np.float64]:
        """Return (n, 3) T_map_robot for every scan so far, by what is known now; after a drive, `finish` first."""
        ...

    def map(self) -> OccupancyMap:
        """Return the map as it is now; it never shares memory with the engine."""
        ...

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map as it is now with cells of `resolution` [m] instead of the engine's own."""
        ...

    def live_map(self) -> OccupancyMap:
        """Return the map that a robot uses while it drives: cheap enough to be asked for at every scan.

        It may be coarser than `map`: earlier scans may stand up to a cell from where they are believed to be now. From
        the first call on the engine keeps it up to date; one that is never asked spends no time on it. It must not be
        written to.
        """
        ...


_ENGINES = {
    "gmapping": ("gmapping.engine", "GMapping"),
    "cartographer": ("graph.engine", "Cartographer"),
    "ekf": ("ekf.engine", "EkfSlam"),
}
ENGINES = tuple(_ENGINES)
"""Names that `make_slam` knows."""


def make_slam(name: str, **config: Any) -> SlamEngine:
    """Return a new SLAM engine.

    Args:
        name: "gmapping", "cartographer" or "ekf" (landmarks).
        config: Fields of the engine's configuration, e.g. `particles=30, seed=0`; those of a part of it by their path,
            e.g. `**{"local.insertion_voxel": 0.1}`.

    Raises:
        InputError: If the name or a field is unknown, or a value is out of its range.
    """
    if name not in _ENGINES:
        raise unknown_name("SLAM engine", name, tuple(_ENGINES))
    module, kind = _ENGINES[name]
    engine = getattr(import_module(f".{module}", __package__), kind)
    return engine.from_options(**config)
