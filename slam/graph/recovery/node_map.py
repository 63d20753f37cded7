"""The map on which a lost robot is searched for, drawn from the nodes of the graph."""

import numpy as np

from ...errors import InputError
from ...grid import GridConfig, ScanRays, draw
from ...localization.place_map import PlaceMap
from ...occupancy_map import OccupancyMap
from ..loops.drive_record import DriveRecord
from ..loops.global_slam import GlobalSlam
from ..loops.trimming import Renumbering

_GRID = GridConfig(resolution=0.05)
_NEW_NODES = 10  # a map without so many of the last nodes still serves: to draw it anew takes long


def searchable(grid: OccupancyMap) -> PlaceMap | None:
    """Return a map made ready to be searched; None: hardly anything is mapped yet."""
    try:
        return PlaceMap(grid)
    except InputError:
        return None


class NodeMap:
    """The map of all nodes whose place is known, kept until enough new nodes are there.

    Args:
        graph: Global SLAM.
        record: The drive, with the scans of the nodes.
    """

    def __init__(self, graph: GlobalSlam, record: DriveRecord) -> None:
        self._graph, self._record = graph, record
        self._rays: list[ScanRays] = []  # of each node, as far as maps were drawn
        self._nodes = -_NEW_NODES  # so many nodes the map is of
        self._map: PlaceMap | None = None

    def up_to(self, nodes: int | None) -> PlaceMap | None:
        """Return the map of the first so many nodes, all if `nodes` is None; None: hardly anything is mapped yet."""
        scans = self._record.scans
        known = len(scans) if nodes is None else nodes
        if known >= self._nodes + _NEW_NODES:
            placed = np.flatnonzero(self._graph.graph.segments.placed_nodes[:known])
            self._rays += [ScanRays.of(scan, _GRID) for scan in scans[len(self._rays) :]]
            grid = draw(self._graph.node_poses[placed], [self._rays[k] for k in placed], _GRID)
            self._nodes, self._map = known, searchable(grid)
        return self._map

    def trim(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes that stay in the graph; the map itself stays as it is drawn."""
        kept = np.flatnonzero(stay.nodes).tolist()
        self._rays = [self._rays[k] for k in kept if k < len(self._rays)]
        if self._map:
            self._nodes = stay.node(self._nodes)
