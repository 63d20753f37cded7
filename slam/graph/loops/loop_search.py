"""Where a stretch of the drive was driven before: the search for loop closures."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose
from ...processes.threads import Workers
from ...scan_to_grid.scan_matcher import DOUBT
from .constraints import APART, Constraint, ConstraintBuilder, Place
from .piece_fit import agrees
from .stretch import stretch
from .submap_graph import SubmapGraph

Array = NDArray[np.float64]

Found = tuple[float, int, Array]


class LoopSearch:
    """Searches for the stretch of the drive that ends at a node, since one scan fits many places.

    Args:
        graph: The graph.
        builder: Matches it with submaps.
        max_distance: Submaps whose middle is farther off a node say nothing of it [m].
        workers: Share the submaps.
    """

    def __init__(self, graph: SubmapGraph, builder: ConstraintBuilder, max_distance: float, workers: Workers) -> None:
        self._graph, self._builder, self._max_distance, self._workers = graph, builder, max_distance, workers

    def search(self, submaps: Sequence[int], node: int) -> Constraint | None:
        """Return the loop closure of a node with one of some submaps.

        None: the stretch is nowhere so likely that it must have been driven before, or at two places that are about as
        likely, as along a corridor: one closure at a wrong place bends the graph so far that right ones are dropped.
        Where most of the stretch may be new, since the robot has just come to what it knows, its last scan is searched
        for alone.

        Args:
            submaps: Indices of all submaps that it may stand near.
            node: Index of the node.
        """
        joined = all(self._graph.pieces.are_joined(s, node) for s in submaps)
        clouds = (stretch(self._graph, node), self._graph.nodes[node].points)[: 1 + joined]
        for points, found in zip(clouds, self._places(submaps, node, clouds), strict=True):
            if found:
                return self._closure(submaps, node, points, found)
        return None

    def _places(self, submaps: Sequence[int], node: int, clouds: Sequence[Array]) -> list[list[Found]]:
        """Return where each of some `clouds` (N, 2) fits well: what each place leads by, its submap, T_submap_node.

        All are searched for on one submap before the next, for its search tree takes as long to make as a search.
        """
        graph = self._graph
        begin = between(graph.nodes[node].pose_local, graph.nodes[graph.pieces.first_node(node)].pose_local)
        guesses = [(graph.guess(s, node), graph.pieces.slack(s, node)) for s in submaps]
        ways = graph.ways(self._builder.longest_way, node, submaps)
        places: list[list[list[Place]]] = [[] for _ in submaps]

        def search(start: int, stop: int) -> None:
            for k in range(start, stop):
                submap, (guess, slack) = graph.submaps[submaps[k]], guesses[k]
                way, after = ways.get(submaps[k], np.inf), slack.after(begin)
                places[k] = [self._builder.places(submap, points, guess, after, way) for points in clouds]

        self._workers.run(search, len(submaps))
        found: list[list[Found]] = [[] for _ in clouds]
        for s, (guess, slack), here in zip(submaps, guesses, places, strict=True):
            for of_cloud, all_found in zip(here, found, strict=True):
                for place in of_cloud:
                    off = between(compose(guess, begin), compose(place.pose, begin))
                    all_found.append((place.lead - slack.cost(off), s, place.pose))
        return found

    def _closure(self, submaps: Sequence[int], node: int, points: Array, found: list[Found]) -> Constraint | None:
        """Return the closure at the likeliest of the places that were `found`, if it counts."""
        graph = self._graph
        lead, submap, pose = max(found, key=lambda place: place[0])
        there = compose(graph.submap_poses[submap], pose)
        alike = any(
            lead - other < DOUBT and are_apart(there, compose(graph.submap_poses[s], at)) for other, s, at in found
        )
        if lead < DOUBT or alike or not self._may_lie(submap, node, there, submaps):
            return None
        return self._builder.closure(submap, graph.submaps[submap], node, points, pose)

    def _may_lie(self, submap: int, node: int, pose: Array, submaps: Sequence[int]) -> bool:
        """Return whether the piece of a node may lie so that the node is at `pose` (3,), global frame."""
        pieces = self._graph.pieces
        if pieces.are_joined(submap, node):
            return True
        before = [s for s in submaps if not pieces.are_joined(s, node)]
        return agrees(self._graph, before, node, pose, self._max_distance)


def are_apart(pose: Array, other: Array) -> bool:
    """Return whether two poses (3,) are of different places."""
    x, y, turn = between(pose, other).tolist()
    return math.hypot(x, y) > APART[0] or abs(turn) > APART[1]
