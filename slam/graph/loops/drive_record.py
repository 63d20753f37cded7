"""What graph SLAM keeps of a drive: the local pose of every scan, and the scans that are nodes of the graph."""

from array import array
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...pose_log import PoseLog
from ...scan import LaserScan
from .between_nodes import between_nodes
from .trimming import Renumbering

Array = NDArray[np.float64]


class DriveRecord:
    """The drive so far.

    Attributes:
        nodes: The number of the scan that each node of the graph is, ascending.
        scans: Those scans.
        way: How far the robot has driven [m].
    """

    def __init__(self) -> None:
        self._poses = PoseLog()  # T_local_robot
        self.nodes: list[int] = []
        self.scans: list[LaserScan] = []
        self._trimmed = array("q")  # scans that were nodes and have left the graph
        self._breaks: list[int] = []  # first scans of drive segments
        self.way = 0.0

    def __len__(self) -> int:
        return len(self._poses)

    @property
    def last_pose(self) -> Array:
        """(3,) T_local_robot of the last scan."""
        return self._poses[-1]

    def add_node(self, scan: LaserScan) -> None:
        """Let the scan that comes next be a node."""
        self.nodes.append(len(self))
        self.scans.append(scan)

    def append(self, pose: Array) -> None:
        """Append a scan at `pose` (3,) T_local_robot."""
        if len(self):
            self.way += float(np.hypot(*(pose - self.last_pose)[:2]))
        self._poses.append(pose)

    def take_back(self, scans: int) -> None:
        """Take back the newest so many scans, none of which is a node."""
        self._poses.cut(len(self) - scans, len(self))

    def rewind(self, scans: int, known: Sequence[Array] = ()) -> None:
        """Take back all but the first so many scans and add some at `known` T_local_robot; then a segment begins."""
        self._poses = PoseLog.of(np.concatenate((self._poses.array()[:scans], np.array(known).reshape(-1, 3))))
        stay = sum(k < scans for k in self.nodes)
        del self.nodes[stay:], self.scans[stay:]
        self._breaks.append(len(self))

    def trim(self, stay: Renumbering) -> None:
        """Forget the scans of nodes that have left the graph, but not where they were taken."""
        self._trimmed.extend(self.nodes[k] for k in np.flatnonzero(~stay.nodes).tolist())
        kept = np.flatnonzero(stay.nodes).tolist()
        self.nodes, self.scans = [self.nodes[k] for k in kept], [self.scans[k] for k in kept]

    def local_trajectory(self) -> Array:
        """Return (n, 3) T_local_robot of every scan, continuous and without loop closure."""
        return self._poses.array()

    def trajectory(self, node_poses: Array, trimmed_poses: Array) -> Array:
        """Return (n, 3) T_global_robot of every scan.

        Args:
            node_poses: (k, 3) T_global_robot of the nodes.
            trimmed_poses: (m, 3) T_global_robot of those that have left the graph, in the order in which they left.
        """
        scans = np.concatenate((np.array(self._trimmed, dtype=np.int64), self.nodes)).astype(np.int64)
        poses = np.concatenate((trimmed_poses, node_poses))
        order = np.argsort(scans)
        return between_nodes(self.local_trajectory(), scans[order], poses[order], self._breaks)
