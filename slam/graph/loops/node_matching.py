"""Nodes are matched against submaps near where the graph has them; what is found becomes a constraint."""

from collections.abc import Sequence

import numpy as np

from .constraints import Constraint, ConstraintBuilder
from .submap_graph import SubmapGraph


class NodeMatching:
    """Matches nodes of a graph and adds the constraints.

    Args:
        graph: The graph.
        builder: Makes the constraints.

    Attributes:
        news: Whether a constraint was added since this was last set to false.
    """

    def __init__(self, graph: SubmapGraph, builder: ConstraintBuilder) -> None:
        self._graph, self._builder = graph, builder
        self.news = False

    def match(self, submap: int, nodes: list[int], wide: bool) -> list[Constraint]:
        """Return the constraints of those `nodes` that match a submap near where the graph has them.

        Args:
            submap: Index of the submap.
            nodes: Indices of the nodes.
            wide: Whether the surroundings are searched first; otherwise the graph must be right to a cell.
        """
        graph = self._graph
        place, poses = graph.submap_poses[submap], np.array([graph.node_poses[k] for k in nodes])
        points = [graph.nodes[k].points for k in nodes]
        return self._builder.track(submap, graph.submaps[submap], place, nodes, points, poses, wide)

    def add(self, constraints: Sequence[Constraint]) -> None:
        """Add constraints to the graph."""
        graph = self._graph
        graph.pieces.join(constraints)
        for constraint in constraints:
            graph.constraints.append(constraint)
            if not constraint.searched:  # else the poses between are not adjusted to it yet
                graph.links.add(constraint.node, (constraint.submap, *graph.nodes[constraint.node].submaps))
            self.news = True

    def track(self, submap: int, nodes: list[int]) -> bool:
        """Match some nodes against a submap and their surroundings there, add what is found, return whether any is."""
        found = self.match(submap, nodes, True)
        self.add(found)
        return bool(found)
