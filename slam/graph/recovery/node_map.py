"""The map on which a lost robot is searched for, drawn from the nodes of the graph."""

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...grid import GridConfig, ScanRays, draw
from ...localization.place_map import PlaceMap
from ...occupancy_map import OccupancyMap
from ..loops.drive_record import DriveRecord
from ..loops.global_slam import GlobalSlam

Array = NDArray[np.float64]

_GRID = GridConfig(resolution=0.05)
_NEW_NODES = 10  # a map without so many of the last nodes still serves: to draw it anew takes long ...
_AROUND = 15.0  # [m] from the robot: a laser sees no more of a building, but for long corridors
_MOVED = 0.1  # [m] ... if no node has been moved farther since
_MOST_AROUND = 300  # nodes around the robot that are drawn, evenly spread: however often it has been there


def searchable(grid: OccupancyMap) -> PlaceMap | None:
    """Return a map made ready to be searched; None: hardly anything is mapped yet."""
    try:
        return PlaceMap(grid)
    except InputError:
        return None


class NodeMap:
    """The map of the nodes whose place is known, kept until enough is new.

    Args:
        graph: Global SLAM.
        record: The drive, with the scans of the nodes.
    """

    def __init__(self, graph: GlobalSlam, record: DriveRecord) -> None:
        self._graph, self._record = graph, record
        self._poses: Array | None = None  # of the nodes that the map is of
        self._map: PlaceMap | None = None

    def of(self, poses: Array) -> PlaceMap | None:
        """Return the map of the first nodes, at `poses` (n, 3) T_map_robot; None: hardly anything is mapped yet."""
        if self._poses is None or not self._serves(self._poses, poses):
            self._poses, self._map = poses, searchable(self._drawn(poses, np.ones(len(poses), dtype=np.bool_)))
        return self._map

    def around(self, poses: Array) -> PlaceMap | None:
        """Return the map of those of the first nodes, at `poses` (n, 3), that are near the last of them."""
        x, y = (poses[:, :2] - poses[-1:, :2]).T
        near = np.flatnonzero(np.hypot(x, y) <= _AROUND)
        wanted = np.zeros(len(poses), dtype=np.bool_)
        wanted[near[:: 1 + len(near) // _MOST_AROUND]] = True
        return searchable(self._drawn(poses, wanted))

    def _drawn(self, poses: Array, wanted: NDArray[np.bool_]) -> OccupancyMap:
        placed = np.flatnonzero(wanted & self._graph.graph.segments.placed_nodes[: len(poses)])
        return draw(poses[placed], [ScanRays.of(self._record.scans[k], _GRID) for k in placed], _GRID)

    @staticmethod
    def _serves(drawn: Array, poses: Array) -> bool:
        """Return whether what was `drawn` (m, 3) is nearly all of the nodes at `poses` (n, 3), and where these are."""
        both = min(len(drawn), len(poses))
        moved = np.abs(drawn[:both, :2] - poses[:both, :2]).max(initial=0.0)
        return 0 <= len(poses) - len(drawn) < _NEW_NODES and bool(moved < _MOVED)

    def forget(self) -> None:
        """Draw the map anew next time: nodes have left the graph."""
        self._poses = None
