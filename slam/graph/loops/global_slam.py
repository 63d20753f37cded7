"""Global SLAM: nodes and submaps tied by constraints, optimised so that loops close (Hess et al. 2016)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, inverse
from ...local.local_slam import Insertion
from ...local.submap import Submap
from ...local.sweep import Sweep
from ...processes.threads import Workers
from ...revisits import superseded
from ...scan import LaserScan
from ...scan_to_grid.extrapolator import Prediction
from .constraints import Constraint, ConstraintBuilder, Kind
from .final_optimisation import FinalOptimisation
from .global_config import GlobalSlamConfig
from .loop_search import LoopSearch
from .node import Node
from .node_matching import NodeMatching
from .optimisation import optimise
from .pose_uncertainty import PoseUncertainty
from .search_interval import SearchInterval
from .slack import SIGMAS, Slack
from .stretch import STRETCH
from .submap_graph import GraphMark, SubmapGraph
from .submap_links import SubmapLinks
from .trimming import Renumbering, TrimmedNodes

Array = NDArray[np.float64]

_LOOSE = np.array([30.0, 3.0])  # [m, rad] how badly the odometry ties a drive segment that has no place yet
_RELOCALIZED = np.array([0.1, 0.05])  # [m, rad] how well relocalization knows a place
_SURE, _KNOWN = 2.0, 1.0  # standard deviations, nineteen in twenty, within so many metres: the place is known
_YOUNG = 100  # nodes that stay in any case: loops are closed and drive segments are begun by what is recent


class GlobalSlam:
    """Closes loops between the nodes and submaps of local SLAM.

    Args:
        config: Settings.
        submaps: The growing list of submaps of local SLAM.
        sweep: What a scan draws into a submap, robot frame.

    Attributes:
        graph: Nodes, submaps, constraints and their poses.
        uncertainty: How far off the robot may be, seen from where the drive began.
        rejected: Number of INTER constraints that were dropped.
    """

    def __init__(self, config: GlobalSlamConfig, submaps: list[Submap], sweep: Callable[[LaserScan], Sweep]) -> None:
        self._config, self._sweep = config, sweep
        self.graph, self.uncertainty = SubmapGraph(submaps), PoseUncertainty()
        self.rejected = 0
        self._builder = ConstraintBuilder(config.constraints)
        self._near_search, self._far_search = SearchInterval(config.search_every), SearchInterval(STRETCH)
        self._matching = NodeMatching(self.graph, self._builder)
        self._loops = LoopSearch(self.graph, self._builder, config.max_distance, Workers(config.threads))
        self._missed = set[int]()  # submaps where a node should have matched, and did not, since the last search
        self._matched = 0  # nodes that local SLAM has matched, for their mean score
        self._T_global_local = np.zeros(3)  # of a drive segment without any node yet
        self._finished_nodes = self._adjusted = 0  # nodes at the end of the drive, and when the graph was adjusted last
        self._trimmed = TrimmedNodes.none()
        self._trim_due = False

    @property
    def local_to_global(self) -> Array:
        """(3,) T_global_local now: the only bridge between the drifting and the loop-closed frame."""
        if not self.graph.segments.current_has_nodes:
            return self._T_global_local
        return compose(self.graph.node_poses[-1], inverse(self.graph.nodes[-1].pose_local))

    @property
    def node_poses(self) -> Array:
        """(n, 3) T_global_robot of every node."""
        return self.graph.node_poses.array()

    @property
    def trimmed_poses(self) -> Array:
        """(m, 3) T_global_robot of every node that has left the graph, in the order in which they left."""
        return self._trimmed.on(self.graph.submap_poses.array())

    @property
    def is_tied(self) -> bool:
        """Whether the newest node is known to lie within a metre of where it is, seen from where the drive began."""
        newest = len(self.graph.nodes) - 1
        return newest < 0 or _SURE * self.graph.pieces.slack(0, newest).linear <= _KNOWN

    @property
    def closable(self) -> tuple[float, float]:
        """How far off a node may be to lie well inside the window of a loop search [m, rad]."""
        return 0.5 * self._config.constraints.search_linear, 0.5 * self._config.constraints.search_angular

    def mark(self) -> GraphMark:
        """Return what `rewind` needs to take back all that is added from now on."""
        graph = self.graph
        growing = tuple(s for s in range(len(graph.submap_poses)) if not graph.submaps[s].finished)
        return GraphMark(
            self.node_poses, graph.submap_poses.array(), list(graph.constraints), growing, self.local_to_global
        )

    def rewind(self, mark: GraphMark) -> None:
        """Take back all nodes and submaps since `mark`: those to come are a drive segment without a place.

        Nothing may have left the graph since.
        """
        graph = self.graph
        graph.rewind(mark, self._sweep)
        self._T_global_local = mark.local_to_global
        self._finished_nodes, self._adjusted = 0, min(self._adjusted, len(graph.nodes))
        self._missed = set()

    def place_segment(self, pose: Array, pose_local: Array) -> None:
        """Say where the newest segment lies: `pose` (3,) T_global_robot belongs to `pose_local` (3,) T_local_robot.

        It is tied to the submaps around that place: the segment before may have drifted by where the robot was carried.
        """
        graph, segments = self.graph, self.graph.segments
        self._T_global_local = compose(pose, inverse(pose_local))
        for s in segments.current_submaps():
            graph.submap_poses[s] = compose(self._T_global_local, graph.submaps[s].pose_local)
        graph.moved()
        nodes = segments.current_nodes()
        for k in nodes:
            graph.node_poses[k] = compose(self._T_global_local, graph.nodes[k].pose_local)
        if nodes and nodes[0] > 0:
            tie = between(graph.node_poses[nodes[0] - 1], graph.node_poses[nodes[0]])
            graph.nodes[nodes[0]] = replace(graph.nodes[nodes[0]], motion=Prediction(tie, _LOOSE))
        segments.place_current()
        if nodes:
            self._tie_segment(nodes)

    def close_at(self, pose: Array, pose_local: Array) -> bool:
        """Tie the newest node as a loop closure by where the robot was found; return whether the graph agrees with it.

        Args:
            pose: (3,) T_global_robot that belongs to ...
            pose_local: ... (3,) T_local_robot.
        """
        graph, node = self.graph, len(self.graph.nodes) - 1
        there = compose(pose, between(pose_local, graph.nodes[node].pose_local))
        distance = np.hypot(*(graph.centres - there[:2]).T)
        closures = list[Constraint]()
        for s in np.argsort(distance, kind="stable")[: self._config.nearest].tolist():
            if distance[s] <= self._config.max_distance:
                guess, points = between(graph.submap_poses[s], there), graph.nodes[node].points
                found = self._builder.closure(s, graph.submaps[s], node, points, guess)
                closures += [found] if found else []
        if not closures:
            return False
        self._matching.add(closures)
        self.optimise()
        if any(graph.meets(closure, self._config.constraints.max_shift) for closure in closures):
            return True
        graph.constraints = [constraint for constraint in graph.constraints if constraint not in closures]
        return False

    def _tie_segment(self, nodes: list[int]) -> None:
        """Tie the nodes of a segment that was just placed to the submaps around its last node."""
        last = nodes[-1]
        near = self.graph.near([last], self._config.max_distance)[0][: self._config.nearest]
        for s in near[:1]:
            found = Prediction(self.graph.guess(s, last), _RELOCALIZED)
            self._matching.add([Constraint(s, last, found.pose, found.information, Kind.INTER, searched=True)])
        for s in near:
            self._matching.track(s, nodes)

    def add_node(self, pose_local: Array, insertion: Insertion) -> None:
        """Add a scan that local SLAM inserted at `pose_local` (3,) T_local_robot, tied to the submaps it stands in."""
        graph, T_global_local = self.graph, self.local_to_global
        pose = compose(T_global_local, pose_local)
        graph.add_submaps(T_global_local)
        motion = self._motion(insertion, pose)
        if len(insertion.submaps) == 1 and not graph.drawn[insertion.submaps[0]]:
            graph.pieces.begin(len(graph.nodes), insertion.submaps[0], Slack(*insertion.drift.tolist()))
        index = graph.add_node(Node(pose_local, insertion.points, insertion.submaps, motion, insertion.scan), pose)
        told = insertion.match or insertion.motion
        if insertion.match:
            self._matched += 1
            self._builder.typical_score += (insertion.match.score - self._builder.typical_score) / self._matched
        for s in insertion.submaps:
            known = told.information if insertion.match or graph.drawn[s] else None
            graph.constraints.append(self._builder.intra(s, graph.submaps[s], index, pose_local, known))
            graph.drawn[s][index] = graph.constraints[-1].pose
        self.uncertainty.add_node(graph, insertion)

    def _motion(self, insertion: Insertion, pose: Array) -> Prediction:
        """Return how the next node, at `pose` (3,) T_global_node, is tied to the one before by the odometry."""
        if not self.graph.nodes or self.graph.segments.current_has_nodes:
            return insertion.motion
        return Prediction(between(self.graph.node_poses[-1], pose), _LOOSE)

    def close_loops(self) -> None:
        """Match the newest node against older submaps, search for it on one of them, optimise the graph when due."""
        config, nodes, index = self._config, self.graph.nodes, len(self.graph.nodes) - 1
        near = self.graph.near([index], config.max_distance)[0]
        placed = self.graph.ways(config.placed_within, index, near)
        for s in [s for s in near if s in placed][: config.nearest]:
            if self._matching.track(s, [index]):
                self._missed.discard(s)
            else:
                self._missed.add(s)
        moved = float(np.hypot(*between(nodes[index - 1].pose_local, nodes[index].pose_local)[:2]))
        self._search([s for s in near if s not in placed or s in self._missed], index, moved)
        new, due = index + 1 - self._adjusted, (index + 1) % config.adjust_every == 0
        if due and self._matching.news and new >= config.adjust_share * index:
            self.optimise()

    def _search(self, waiting: list[int], node: int, moved: float) -> None:
        """Search for a node, `moved` [m] after the one before, where a search is due.

        Args:
            waiting: Submaps near which the graph has it, but nothing ties it to them closely.
            node: The node.
            moved: How far the robot has driven since the node before [m].
        """
        near: list[int] = []
        if self._near_search.is_over(moved):
            near, self._missed = [s for s in waiting if not self._is_loose(s, node)], set()
        far = self._loose(node) if self._far_search.is_over(moved) else []
        for submaps in near, far:
            closure = self._loops.search(submaps, node) if submaps else None
            self._matching.add([closure] if closure else [])

    def _is_loose(self, submap: int, node: int) -> bool:
        """Return whether a node may stand farther off where the graph has it, seen from a submap, than by drift."""
        return SIGMAS * self.graph.pieces.slack(submap, node).linear > self._config.constraints.search_linear

    def _loose(self, node: int) -> list[int]:
        """Return the submaps that a node may stand near, but that only odometry ties to it."""
        graph, loosest = self.graph, self.graph.pieces.loosest
        if loosest == Slack():
            return []
        near = graph.near([node], self._config.max_distance + SIGMAS * loosest.linear)[0]
        return [s for s in near if self._is_loose(s, node)]

    def optimise(self, final: bool = False) -> None:
        """Adjust all poses; drop INTER constraints that end far off. `final`: as `optimise` of the graph has it."""
        done = optimise(self.graph, self._config, final)
        self.rejected += done.rejected
        self.uncertainty.renew(self.graph, done)
        self._matching.news, self._trim_due = False, not final
        self.graph.pieces.rejoin(self.graph.constraints)
        self.graph.links = SubmapLinks.of(self.graph.nodes, self.graph.constraints)
        self._adjusted = len(self.graph.nodes)

    def finish(self) -> None:
        """Match every node with every near submap and optimise; does nothing where no node is new.

        First roughly, then on submaps that the adjusted graph has straightened. Last, those that found no match are
        tried again from where the graph has them then.
        """
        if self._finished_nodes == len(self.graph.nodes):
            return
        self._finished_nodes = len(self.graph.nodes)
        final = FinalOptimisation(self.graph, self._config, self._builder, self._matching, self._sweep)
        self.optimise()
        final.match_roughly()
        self.optimise()
        final.straighten()
        self.rejected += final.rejected
        final.match_finely(kept=False)
        self.optimise()
        final.match_finely(kept=True)
        self.optimise(final=True)

    def trim(self) -> Renumbering | None:
        """Let the submaps leave all of whose nodes are superseded, and the nodes that stand in no other.

        Returns:
            What stays, for whoever counts nodes or submaps; None: all.
        """
        if not self._trim_due:
            return None
        self._trim_due = False
        graph, poses, submap_poses = self.graph, self.node_poses, self.graph.submap_poses.array()
        old = superseded(poses, self._config.revisits) & graph.segments.placed_nodes
        old[-_YOUNG:] = False
        submaps = np.ones(len(graph.submaps), dtype=np.bool_)
        submaps[: len(graph.drawn)] = [not (nodes and old[list(nodes)].all()) for nodes in graph.drawn]
        anchors = np.flatnonzero(submaps[: len(graph.drawn)] & graph.segments.placed_submaps)
        if submaps.all() or not len(anchors):
            return None
        stay = Renumbering(np.array([submaps[list(node.submaps)].any() for node in graph.nodes]), submaps)
        self._trimmed = self._trimmed.after(stay, poses, submap_poses, anchors)
        graph.renumber(stay)
        self._finished_nodes, self._adjusted = 0, len(graph.nodes)
        self._missed = set()
        return stay
