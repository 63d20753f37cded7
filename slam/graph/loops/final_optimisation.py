"""What is done once a drive is over: every node is matched with every near submap, and submaps are straightened."""

from collections.abc import Callable

import numpy as np

from ...geometry import between
from ...local.sweep import Sweep
from ...processes.threads import Workers
from ...scan import LaserScan
from .constraints import Constraint, ConstraintBuilder, Kind
from .global_config import GlobalSlamConfig
from .node_matching import NodeMatching
from .stretch import stretch
from .submap_graph import SubmapGraph

_ROUGHLY = 2  # near submaps that a node is matched with before the submaps are straightened


class FinalOptimisation:
    """Matches nodes and submaps of a graph anew.

    Args:
        graph: The graph.
        config: Settings.
        builder: Makes the constraints.
        matching: Matches nodes and adds constraints.
        sweep: What a scan draws into a submap, robot frame.

    Attributes:
        rejected: How many loop closures did not fit any more on straightened submaps.
    """

    def __init__(
        self,
        graph: SubmapGraph,
        config: GlobalSlamConfig,
        builder: ConstraintBuilder,
        matching: NodeMatching,
        sweep: Callable[[LaserScan], Sweep],
    ) -> None:
        self._graph, self._config, self._builder, self._matching = graph, config, builder, matching
        self._sweep, self._workers = sweep, Workers(config.threads)
        self.rejected = 0

    def match_roughly(self) -> None:
        """Match every node with the nearest submaps, as they were drawn while the robot drove."""
        self._match_all(_ROUGHLY, wide=True, kept=self._converged())

    def match_finely(self, kept: bool) -> None:
        """Match every node with all near submaps, starting from where the graph has it.

        Args:
            kept: Whether matches that the graph meets already stay as they are.
        """
        self._match_all(2 * self._config.nearest, wide=False, kept=self._converged() if kept else set())

    def _match_all(self, nearest: int, wide: bool, kept: set[tuple[int, int]]) -> None:
        """Match every node with the `nearest` submaps anew, but for pairs that are `kept` or were searched for."""
        graph = self._graph
        graph.constraints = [
            c for c in graph.constraints if c.kind is Kind.INTRA or c.searched or (c.submap, c.node) in kept
        ]
        near = dict[int, list[int]]()
        for index, submaps in enumerate(graph.near(range(len(graph.nodes)), self._config.max_distance)):
            for s in submaps[:nearest]:
                if (s, index) not in kept:
                    near.setdefault(s, []).append(index)
        submaps = sorted(near)
        found: list[list[Constraint]] = [[] for _ in submaps]

        def match(start: int, stop: int) -> None:
            for k in range(start, stop):
                found[k] = self._matching.match(submaps[k], near[submaps[k]], wide)

        self._workers.run(match, len(submaps))
        for constraints in found:
            self._matching.add(constraints)

    def _converged(self) -> set[tuple[int, int]]:
        """Return submap and node of the INTER constraints that the graph meets so well that matching finds no other."""
        graph = self._graph
        ties = [c for c in graph.constraints if c.kind is Kind.INTER and not c.searched]
        if not ties:
            return set()
        poses = between(
            graph.submap_poses.array()[[c.submap for c in ties]], graph.node_poses.array()[[c.node for c in ties]]
        )
        error = between(np.array([c.pose for c in ties]), poses)
        linear, angular = self._config.converged
        good = (np.hypot(error[:, 0], error[:, 1]) <= linear) & (np.abs(error[:, 2]) <= angular)
        return {(ties[k].submap, ties[k].node) for k in np.flatnonzero(good).tolist()}

    def straighten(self) -> None:
        """Draw every finished submap with its nodes where the graph has them; match loop closures on these anew.

        A submap that was drawn while the robot drove is bent by as much as local SLAM drifted meanwhile, and a match
        on it is turned by up to half a degree.
        """
        graph = self._graph
        count = len(graph.submaps) - 2
        self._workers.run(self._redraw, max(count, 0))
        graph.moved()
        kept = list[Constraint]()
        for c in graph.constraints:
            again = self._builder.rematch(c, graph.submaps[c.submap], stretch(graph, c.node)) if c.searched else c
            kept += [again] if again else []
        self.rejected += len(graph.constraints) - len(kept)
        graph.constraints = kept

    def _redraw(self, start: int, stop: int) -> None:
        """Draw the submaps `start` to `stop` - 1 with their nodes where the graph has them."""
        graph, sweeps = self._graph, dict[int, Sweep]()  # a node stands in two submaps, one after the other
        for s in range(start, stop):
            nodes = list(graph.drawn[s])
            poses = between(graph.submap_poses[s], np.array([graph.node_poses[k] for k in nodes]))
            graph.drawn[s] = dict(zip(nodes, poses, strict=True))
            sweeps = {k: sweeps.get(k) or self._sweep(graph.nodes[k].scan) for k in nodes}
            graph.redraw(s, sweeps)
