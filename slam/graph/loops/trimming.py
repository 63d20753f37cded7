"""Parts of the graph that were seen again often enough leave it; where the robot was then stays known.

The idea is Cartographer's trimmer of overlapping submaps. A node that leaves hangs on a submap that stays, so that the
trajectory follows later loop closures there, too.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose
from ...scan_to_grid.extrapolator import Prediction
from .constraints import Constraint
from .node import Node

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


class Renumbering:
    """Which nodes and submaps stay, and their numbers then.

    Args:
        nodes: (n,) whether each node stays.
        submaps: (s,) whether each submap stays.
    """

    def __init__(self, nodes: Flags, submaps: Flags) -> None:
        self.nodes, self.submaps = nodes, submaps
        self._node = np.concatenate(([0], np.cumsum(nodes))).tolist()
        self._submap = np.concatenate(([0], np.cumsum(submaps))).tolist()

    def node(self, index: int) -> int:
        """Return the new number of a node that stays; of another, that of the next one that does."""
        return self._node[index]

    def submap(self, index: int) -> int:
        """Return the new number of a submap that stays; of another, that of the next one that does."""
        return self._submap[index]

    def constraints(self, constraints: list[Constraint]) -> list[Constraint]:
        """Return the constraints between submaps and nodes that stay."""
        kept = [c for c in constraints if self.submaps[c.submap] and self.nodes[c.node]]
        return [replace(c, submap=self.submap(c.submap), node=self.node(c.node)) for c in kept]

    def chain(self, nodes: list[Node]) -> list[Node]:
        """Return the nodes that stay; the odometry since the one before leads over those between that do not."""
        chain: list[Node] = []
        gap: Prediction | None = None
        for node, stays in zip(nodes, self.nodes.tolist(), strict=True):
            motion = node.motion if gap is None else gap.then(node.motion)
            gap = None if stays else motion
            if stays:
                submaps = tuple(self.submap(s) for s in node.submaps if self.submaps[s])
                chain.append(replace(node, motion=motion, submaps=submaps))
        return chain


@dataclass(frozen=True, eq=False)
class TrimmedNodes:
    """Nodes that have left the graph.

    Attributes:
        submaps: (m,) the submap that each hangs on.
        poses: (m, 3) T_submap_node of each.
    """

    submaps: NDArray[np.int64]
    poses: Array

    @classmethod
    def none(cls) -> "TrimmedNodes":
        """Return no nodes."""
        return cls(np.zeros(0, dtype=np.int64), np.zeros((0, 3)))

    def __len__(self) -> int:
        return len(self.submaps)

    def on(self, submap_poses: Array) -> Array:
        """Return (m, 3) T_global_node, where the submaps have the poses (s, 3)."""
        return compose(submap_poses[self.submaps], self.poses)

    def after(
        self, stay: Renumbering, node_poses: Array, submap_poses: Array, anchors: NDArray[np.int64]
    ) -> "TrimmedNodes":
        """Return the trimmed nodes once those that do not stay have left, too.

        Args:
            stay: What stays.
            node_poses: (n, 3) T_global_node of the nodes until then.
            submap_poses: (s, 3) T_global_submap of the submaps until then.
            anchors: (a,) submaps that stay, one at least; a node hangs on the nearest of them.
        """
        leave = np.flatnonzero(~stay.nodes)
        submaps = np.concatenate((self.submaps, np.full(len(leave), -1)))
        places = np.concatenate((self.on(submap_poses), node_poses[leave]))
        poses = np.concatenate((self.poses, places[len(self) :]))
        loose = (submaps < 0) | ~stay.submaps[submaps]
        apart = places[loose][:, None, :2] - submap_poses[anchors][None, :, :2]
        submaps[loose] = anchors[np.argmin((apart**2).sum(axis=-1), axis=1)]
        poses[loose] = between(submap_poses[submaps[loose]], places[loose])
        return TrimmedNodes(np.array([stay.submap(s) for s in submaps.tolist()], dtype=np.int64), poses)
