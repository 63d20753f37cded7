"""How much of a building the robot's laser has seen: truth, for rewards, endings and figures only."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from ...perception.people_filter import FilteredScan
from ...slam.geometry import compose, transform_points
from ...slam.grid import scan_rays
from ..robot.robot import RobotConfig
from ..scenes.occupancy import true_map
from ..scenes.scene import Scene
from .coverage_kernels import sweep

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

CELL_M = 0.1
"""Side of a cell [m]."""
FARTHEST_M = 4.6
"""What is farther away does not count as seen [m]: there, neighbouring beams a quarter of a degree apart leave gaps in
a map with the paper's cells of 0.02 m."""
_STRIDE = 5  # the places looked from lie this many cells apart
_RAYS = 720


class Coverage:
    """The share of the building's floor that was seen.

    Counted are the cells of 0.1 m in the laser's plane that a robot of this width can see from anywhere it can get to,
    up to 4.6 m away: so 1 is what a perfect tour would see. A cell is seen when a beam passed through it, from where
    the robot truly was; beams that met people do not count. How well the robot's own map shows these cells is the
    business of the map's scores.

    Args:
        scene: The building.
        width: The robot's width [m].
    """

    def __init__(self, scene: Scene, width: float = RobotConfig.sizes["differential"][1]) -> None:
        truth = true_map(scene, CELL_M)
        self._origin = np.array(truth.origin)
        self._nothing = np.zeros(truth.probability.shape, dtype=bool)
        self._wanted = truth.free & _visible(~truth.free, self._standing(scene, truth.free, width / 2.0))
        self._seen = np.zeros_like(self._nothing)

    def update(self, filtered_scan: FilteredScan, T_world_robot: Array) -> None:
        """Take a scan, taken at the true pose (3,); its people do not count."""
        scan = filtered_scan.without_people
        T_world_lidar = compose(T_world_robot, scan.T_robot_lidar)
        ends = transform_points(T_world_lidar, scan_rays(scan, FARTHEST_M, clear_no_return=True)[0])
        x, y = (T_world_lidar[:2] - self._origin) / CELL_M
        sweep(x, y, (ends - self._origin) / CELL_M, self._nothing, self._seen)

    @property
    def share(self) -> float:
        """Share of the floor that was seen, 0 .. 1."""
        return float(np.count_nonzero(self._seen & self._wanted)) / float(np.count_nonzero(self._wanted))

    @property
    def cells(self) -> tuple[Mask, Mask, tuple[float, float]]:
        """(rows, cols) what counts, what of it was seen, and the world's (x, y) of the corner of cell [0, 0] [m]."""
        return self._wanted.copy(), self._seen & self._wanted, (float(self._origin[0]), float(self._origin[1]))

    def _standing(self, scene: Scene, free: Mask, half_width: float) -> Array:
        """Return (n, 2) x, y [cells] of places, on a coarse lattice, that the robot can get to."""
        rows, cols = np.nonzero(free)
        centres = (np.stack((cols, rows), axis=-1) + 0.5) * CELL_M + self._origin
        fits = np.zeros_like(free)
        fits[rows, cols] = scene.clearance(centres) > half_width
        start = np.floor((scene.route[0] - self._origin) / CELL_M).astype(int)
        here = np.zeros_like(free)
        here[start[1], start[0]] = True
        reached = np.asarray(ndimage.binary_propagation(here, mask=fits), dtype=bool)
        places = np.argwhere(reached[::_STRIDE, ::_STRIDE]) * _STRIDE
        return np.vstack((start, places[:, ::-1])).astype(np.float64) + 0.5


class NoCoverage:
    """Nobody asks: nothing is measured."""

    share = float("nan")

    def update(self, filtered_scan: FilteredScan, T_world_robot: Array) -> None:
        """Ignore the scan."""


def _visible(blocked: Mask, places: Array) -> Mask:
    """Return (rows, cols) what can be seen from `places` (n, 2) [cells]."""
    seen = np.zeros_like(blocked)
    angles = np.arange(_RAYS) * (2.0 * np.pi / _RAYS)
    rays = np.stack((np.cos(angles), np.sin(angles)), axis=-1) * (FARTHEST_M / CELL_M)
    for x, y in places:
        sweep(x, y, rays + np.array((x, y)), blocked, seen)
    return seen
