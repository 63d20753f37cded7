"""How far it is from submap to submap over nodes that they share, by local SLAM or by a closure."""

from collections import defaultdict
from collections.abc import Collection, Iterable, Sequence
from heapq import heappop, heappush
from math import hypot
from operator import itemgetter

from ...pose_log import PoseLog
from .constraints import Constraint
from .node import Node


class SubmapLinks:
    """Of each submap the others that share a node with it, and the newest such node."""

    def __init__(self) -> None:
        self._links: defaultdict[int, dict[int, int]] = defaultdict(dict)

    def add(self, node: int, submaps: Sequence[int]) -> None:
        """Link the `submaps` of a node."""
        for a in submaps:
            for b in submaps:
                if a != b:
                    self._links[a][b] = node

    def ways(
        self, reach: float, node: int, submaps: Sequence[int], poses: PoseLog, wanted: Collection[int]
    ) -> dict[int, float]:
        """Return how long the way from a node is to those `wanted` of the submaps where it is no longer than `reach`.

        The error of where one is seen from the other grows with that way [m].

        Args:
            reach: Longest way, from one shared node to the next [m].
            node: Where the way begins.
            submaps: Those that the node stands in.
            poses: (3,) pose of each node.
            wanted: Those that are asked for; the search ends when all are found.
        """
        waiting, reached, left = [(0.0, s, node) for s in submaps], dict[int, float](), set(wanted)
        while waiting and left:
            way, submap, at = heappop(waiting)
            if submap in reached:
                continue
            reached[submap] = way
            left.discard(submap)
            x, y = poses.place(at)
            for other, shared in self._links[submap].items():
                if other not in reached:
                    there_x, there_y = poses.place(shared)
                    longer = way + hypot(there_x - x, there_y - y)
                    if longer <= reach:
                        heappush(waiting, (longer, other, shared))
        return {s: reached[s] for s in wanted if s in reached}

    @classmethod
    def of(cls, nodes: Sequence[Node], constraints: Iterable[Constraint]) -> "SubmapLinks":
        """Return the links by the submaps in which nodes stand, and by all constraints in force."""
        links, last = cls(), dict[tuple[int, ...], int]()  # hundreds of nodes in a row stand in the same submaps
        for k, node in enumerate(nodes):
            last[node.submaps] = k
        for constraint in constraints:
            submaps = constraint.submap, *nodes[constraint.node].submaps
            last[submaps] = max(constraint.node, last.get(submaps, 0))
        for submaps, node in sorted(last.items(), key=itemgetter(1)):
            links.add(node, submaps)
        return links
