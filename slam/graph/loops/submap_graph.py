"""The state of global SLAM: nodes, submaps, the constraints between them, and where they stand."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose
from ...local.submap import Submap
from ...local.sweep import Sweep
from ...pose_log import PoseLog
from ...scan import LaserScan
from .constraints import Constraint
from .drive_segments import DriveSegments
from .node import Node
from .pieces import Pieces
from .submap_links import SubmapLinks
from .trimming import Renumbering

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GraphMark:
    """A graph as it was.

    Attributes:
        node_poses: (n, 3) T_global_node of its nodes.
        submap_poses: (s, 3) T_global_submap of its submaps.
        constraints: Its constraints.
        growing: Those of its submaps that were not finished.
        local_to_global: (3,) T_global_local.
    """

    node_poses: Array
    submap_poses: Array
    constraints: list[Constraint]
    growing: tuple[int, ...]
    local_to_global: Array


class SubmapGraph:
    """Nodes and submaps with their poses in the global frame.

    Args:
        submaps: The growing list of submaps of local SLAM; the last two still grow.

    Attributes:
        submaps: That list.
        nodes: All nodes.
        constraints: All constraints in force.
        drawn: Of each submap, its nodes and where they stand in its drawing: (3,) T_submap_node.
        node_poses: (3,) T_global_node of each node.
        submap_poses: (3,) T_global_submap of each submap in which a node stands.
        segments: The drive segments that nodes and submaps belong to.
        pieces: The pieces of the drive that local SLAM has mapped without a break.
        links: How far it is from submap to submap over nodes that they share.
    """

    def __init__(self, submaps: list[Submap]) -> None:
        self.submaps = submaps
        self.nodes: list[Node] = []
        self.constraints: list[Constraint] = []
        self.drawn: list[dict[int, Array]] = []
        self.node_poses, self.submap_poses = PoseLog(), PoseLog()
        self._middles: Array | None = None
        self.segments, self.pieces, self.links = DriveSegments(), Pieces(), SubmapLinks()

    def add_submaps(self, T_global_local: Array) -> None:
        """Take in the submaps that local SLAM has begun since the last node."""
        for submap in self.submaps[len(self.submap_poses) :]:
            self.moved()
            self.submap_poses.append(compose(T_global_local, submap.pose_local))
            self.segments.add_submap()
            self.drawn.append({})

    def add_node(self, node: Node, pose: Array) -> int:
        """Add a node at `pose` (3,) T_global_node and return its index."""
        self.segments.add_node()
        self.links.add(len(self.nodes), node.submaps)
        self.nodes.append(node)
        self.node_poses.append(pose)
        return len(self.nodes) - 1

    def ways(self, reach: float, node: int, wanted: Sequence[int]) -> dict[int, float]:
        """Return how long the ways from a node are to those `wanted` of the submaps that are within `reach` [m]."""
        return self.links.ways(reach, node, self.nodes[node].submaps, self.node_poses, wanted)

    def guess(self, submap: int, node: int) -> Array:
        """Return (3,) T_submap_node by the poses that both have now."""
        return between(self.submap_poses[submap], self.node_poses[node])

    def meets(self, constraint: Constraint, within: tuple[float, float]) -> bool:
        """Return whether the graph has a node `within` so much [m, rad] of where a constraint has it."""
        x, y, turn = between(self.guess(constraint.submap, constraint.node), constraint.pose).tolist()
        return hypot(x, y) <= within[0] and abs(turn) <= within[1]

    def near(self, indices: Sequence[int], max_distance: float) -> list[list[int]]:
        """Return the finished submaps near each of some nodes, nearest first.

        Submaps in which the node stands, and those of segments whose place is not known, are left out.

        Args:
            indices: The nodes.
            max_distance: From a node to the mean place of the laser in the submap [m].
        """
        centres, near = self.centres, list[list[int]]()
        for k in indices:
            x, y, _ = self.node_poses[k].tolist()
            distance = np.hypot(centres[:, 0] - x, centres[:, 1] - y)
            wanted = distance <= max_distance
            if self.segments.current:  # in a drive of one segment all are related
                wanted &= self.segments.related(k)[: len(centres)]
            found = np.flatnonzero(wanted)
            order = found[np.argsort(distance[found], kind="stable")].tolist()
            near.append([s for s in order if s not in self.nodes[k].submaps])
        return near

    def moved(self) -> None:
        """Say that poses of submaps have changed, or submaps themselves."""
        self._middles = None

    @property
    def centres(self) -> Array:
        """(n, 2) mean places of the laser in the finished submaps, global frame [m]."""
        if self._middles is None:
            count = max(0, min(len(self.submaps) - 2, len(self.submap_poses)))
            offsets = np.array([(*submap.centre, 0.0) for submap in self.submaps[:count]]).reshape(-1, 3)
            self._middles = compose(self.submap_poses.array()[:count], offsets)[:, :2]
        return self._middles

    def rewind(self, mark: GraphMark, sweep: Callable[[LaserScan], Sweep]) -> None:
        """Take back all nodes, submaps and constraints since `mark`; those to come are a drive segment of their own.

        Args:
            mark: The graph then.
            sweep: What a scan draws into a submap, robot frame: submaps that were growing are drawn anew and finished.
        """
        nodes, submaps = len(mark.node_poses), len(mark.submap_poses)
        del self.nodes[nodes:], self.submaps[submaps:]
        self.constraints = list(mark.constraints)
        self.pieces.rewind(nodes, submaps, self.constraints)
        self.links = SubmapLinks.of(self.nodes, self.constraints)
        self.drawn = [{k: pose for k, pose in drawn.items() if k < nodes} for drawn in self.drawn[:submaps]]
        self.node_poses, self.submap_poses = PoseLog.of(mark.node_poses), PoseLog.of(mark.submap_poses)
        self.segments.begin(nodes, submaps)
        for s in mark.growing:
            self.redraw(s, {k: sweep(self.nodes[k].scan) for k in self.drawn[s]})
        self.moved()

    def redraw(self, submap: int, sweeps: dict[int, Sweep]) -> None:
        """Draw a submap anew, with its nodes where `drawn` has them.

        Args:
            submap: Its index.
            sweeps: What the scan of each of its nodes draws, robot frame.
        """
        old = self.submaps[submap]
        self.submaps[submap] = old.redrawn(
            sweeps[k].at(compose(old.pose_local, pose)) for k, pose in self.drawn[submap].items()
        )

    def renumber(self, stay: Renumbering) -> None:
        """Drop the nodes and submaps that do not stay; the list of submaps itself is local SLAM's to shorten."""
        nodes, submaps = np.flatnonzero(stay.nodes).tolist(), np.flatnonzero(stay.submaps[: len(self.drawn)]).tolist()
        self.drawn = [{stay.node(k): pose for k, pose in self.drawn[s].items()} for s in submaps]
        self.submap_poses = PoseLog.of(self.submap_poses.array()[submaps])
        self.moved()
        self.segments.renumber(stay)
        self.pieces.renumber(stay)
        self.nodes = stay.chain(self.nodes)
        self.node_poses = PoseLog.of(self.node_poses.array()[nodes])
        self.constraints = stay.constraints(self.constraints)
        self.links = SubmapLinks.of(self.nodes, self.constraints)
