"""Global SLAM: nodes and submaps tied by constraints, adjusted so that loops close (Hess et al. 2016)."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose, inverse
from ...pose_graph.adjustment import adjust
from ...processes.threads import Workers
from ...revisits import superseded
from ...scan import LaserScan
from ...scan_to_grid.extrapolator import Prediction
from ..local.local_slam import Insertion
from ..local.submap import Submap
from ..local.sweep import Sweep
from .assembly import assemble
from .constraints import Constraint, ConstraintBuilder, Kind
from .global_config import GlobalSlamConfig
from .node import Node
from .trimming import Renumbering, TrimmedNodes

Array = NDArray[np.float64]

_LOOSE = np.array([30.0, 3.0])  # [m, rad] how badly the odometry ties a piece of the drive that has no place yet
_ROUGHLY = 2  # near submaps that a node is matched with before the submaps are straightened
_AT_ONCE = 256  # nodes whose distances to all submaps are held at once
_PLACED = np.array([0.1, 0.05])  # [m, rad] how well relocalization does
_YOUNG = 100  # nodes that stay in any case: loops are closed and pieces are begun by what is recent


class GlobalSlam:
    """Closes loops between the nodes and submaps of local SLAM.

    Args:
        config: Settings.
        submaps: The growing list of submaps of local SLAM.
        sweep: What a scan draws into a submap, robot frame.

    Attributes:
        constraints: All constraints in force.
        drawn: Of each submap, its nodes and where they stand in its drawing: (3,) T_submap_node.
        rejected: Number of INTER constraints that were dropped.
    """

    def __init__(self, config: GlobalSlamConfig, submaps: list[Submap], sweep: Callable[[LaserScan], Sweep]) -> None:
        self._config = config
        self._submaps = submaps
        self._sweep = sweep
        self._builder = ConstraintBuilder(config.constraints)
        self._workers = Workers(config.threads)
        self.nodes: list[Node] = []
        self.constraints: list[Constraint] = []
        self.drawn: list[dict[int, Array]] = []
        self.rejected = 0
        self._node_poses: list[Array] = []
        self._submap_poses: list[Array] = []
        self._tied_at: dict[int, int] = {}
        self._returned_at = self._returning_at = 0
        self._tried_at: dict[int, int] = {}
        self._matched = 0
        self._travelled = np.inf
        self._new = False
        self._finished_nodes = 0
        self._stretch = (0, 0)  # first node and submap since local SLAM last began anew
        # A piece of the drive begins where the robot got lost; `_placed` says for each whether its place is known.
        self._placed, self._carried = [True], [False]
        self._bridge = np.zeros(3)
        self._piece_of_node: list[int] = []
        self._piece_of_submap: list[int] = []
        self._trimmed = TrimmedNodes.none()
        self._trim_due = False

    @property
    def local_to_global(self) -> Array:
        """(3,) T_global_local now: the only bridge between the drifting and the loop-closed frame."""
        if not self.nodes or self._piece_of_node[-1] != len(self._placed) - 1:
            return self._bridge
        return compose(self._node_poses[-1], inverse(self.nodes[-1].pose_local))

    @property
    def node_poses(self) -> Array:
        """(n, 3) T_global_robot of every node."""
        return np.array(self._node_poses).reshape(-1, 3)

    @property
    def trimmed_poses(self) -> Array:
        """(m, 3) T_global_robot of every node that has left the graph, in the order in which they left."""
        return self._trimmed.on(np.array(self._submap_poses).reshape(-1, 3))

    @property
    def submaps(self) -> int:
        """How many submaps there are in which a node stands."""
        return len(self._submap_poses)

    @property
    def reach(self) -> Array:
        """(2,) how far off a node may be for a loop search to find it, as standard deviations [m, rad]."""
        constraints = self._config.constraints
        return np.array([0.5 * constraints.search_linear, constraints.search_angular])

    @property
    def drift(self) -> float:
        """Standard deviation of the way since the robot came back to old submaps, as the odometry would know it [m].

        It is that over as many nodes as a submap that tied one counts as well placed for, at least.
        """
        since = min(self._returned_at, len(self.nodes) - self._config.known_for)
        steps = np.array([node.motion.sigma[0] for node in self.nodes[max(since, 0) :]])
        return float(np.sqrt((steps**2).sum()))

    @property
    def placed(self) -> NDArray[np.bool_]:
        """(n,) whether the place of each node on the map is known: not so for pieces after a kidnapping."""
        return np.array([self._placed[piece] for piece in self._piece_of_node], dtype=np.bool_)

    @property
    def mappable(self) -> NDArray[np.bool_]:
        """(n,) whether the place of each node is known, if by the odometry alone: so it is after a gap in a log."""
        known = list(self._placed)
        for piece in range(1, len(known)):
            known[piece] = known[piece] or (not self._carried[piece] and known[piece - 1])
        return np.array([known[piece] for piece in self._piece_of_node], dtype=np.bool_)

    def begin_piece(self, disowned: int = 0, carried: bool = True) -> None:
        """The robot is lost: nodes from now on are a piece of their own, tied to nothing until it is placed.

        Args:
            disowned: So many of the last nodes were added when it was lost already; their place is not known any more.
            carried: Whether the odometry knows nothing of how the robot came there.
        """
        self._bridge = self.local_to_global
        if disowned:
            self._piece_of_node[-disowned:] = [len(self._placed)] * disowned
            self._placed.append(False)
            self._carried.append(carried)
        self._placed.append(False)
        self._carried.append(carried)

    def place_piece(self, pose: Array, pose_local: Array) -> None:
        """Say where the newest piece lies: `pose` (3,) T_global_robot belongs to `pose_local` (3,) T_local_robot.

        It is tied to the submaps around that place: the piece before may have drifted by where the robot was lost.
        """
        piece = len(self._placed) - 1
        self._placed[piece] = True
        self._bridge = compose(pose, inverse(pose_local))
        for s, of in enumerate(self._piece_of_submap):
            if of == piece:
                self._submap_poses[s] = compose(self._bridge, self._submaps[s].pose_local)
        nodes = [k for k, of in enumerate(self._piece_of_node) if of == piece]
        for k in nodes:
            self._node_poses[k] = compose(self._bridge, self.nodes[k].pose_local)
        if nodes and nodes[0] > 0 and self._carried[piece]:
            tie = between(self._node_poses[nodes[0] - 1], self._node_poses[nodes[0]])
            self.nodes[nodes[0]] = replace(self.nodes[nodes[0]], motion=Prediction(tie, _LOOSE))
        for k in nodes[-1:]:
            near = self._near([k])[0][: self._config.nearest]
            for s in near[:1]:
                found = Prediction(self._guess(s, k), _PLACED)
                self._take([Constraint(s, k, found.pose, found.information, Kind.INTER, searched=True)])
            for s in near:
                self._tied_at[s] = k
                self._track(s, nodes, True)

    def add_node(self, pose_local: Array, insertion: Insertion) -> None:
        """Add a scan that local SLAM inserted, match it against older submaps, adjust the graph when it is due."""
        bridge = self.local_to_global
        index = len(self.nodes)
        for submap in self._submaps[len(self._submap_poses) :]:
            self._submap_poses.append(compose(bridge, submap.pose_local))
            self._piece_of_submap.append(len(self._placed) - 1)
            self.drawn.append({})
        motion = insertion.motion
        if self.nodes and self._piece_of_node[-1] != len(self._placed) - 1 and self._carried[-1]:
            sigma = _PLACED if self._placed[-1] else _LOOSE
            motion = Prediction(between(self._node_poses[-1], compose(bridge, pose_local)), sigma)
        if len(insertion.submaps) == 1 and insertion.match is None:
            self._stretch = index, insertion.submaps[0]
        self._piece_of_node.append(len(self._placed) - 1)
        self.nodes.append(Node(pose_local, insertion.points, insertion.submaps, motion, insertion.scan))
        self._node_poses.append(compose(bridge, pose_local))
        curvature = insertion.match.information if insertion.match else None
        if insertion.match:
            self._matched += 1
            self._builder.typical_score += (insertion.match.score - self._builder.typical_score) / self._matched
        for s in insertion.submaps:
            self.constraints.append(self._builder.intra(s, self._submaps[s], index, pose_local, curvature))
            self.drawn[s][index] = self.constraints[-1].pose
        self._close_loops(index)
        if self._new and (index + 1) % self._config.adjust_every == 0:
            self._adjust()

    def trim(self) -> Renumbering | None:
        """Let the submaps leave all of whose nodes are superseded, and the nodes that stand in no other.

        Returns:
            What stays, for whoever counts nodes or submaps; None: all.
        """
        if not self._trim_due:
            return None
        self._trim_due = False
        poses, submap_poses = self.node_poses, np.array(self._submap_poses)
        old = superseded(poses, self._config.revisits) & self.placed
        old[-_YOUNG:] = False
        submaps = np.ones(len(self._submaps), dtype=np.bool_)
        submaps[: len(self.drawn)] = [not (nodes and old[list(nodes)].all()) for nodes in self.drawn]
        anchors = np.flatnonzero(submaps[: len(self.drawn)] & np.array(self._placed)[self._piece_of_submap])
        if submaps.all() or not len(anchors):
            return None
        stay = Renumbering(np.array([submaps[list(node.submaps)].any() for node in self.nodes]), submaps)
        self._trimmed = self._trimmed.after(stay, poses, submap_poses, anchors)
        self._renumber(stay)
        return stay

    def _renumber(self, stay: Renumbering) -> None:
        """Drop the nodes and submaps that do not stay; the list of submaps is local SLAM's."""
        nodes, submaps = np.flatnonzero(stay.nodes).tolist(), np.flatnonzero(stay.submaps[: len(self.drawn)]).tolist()
        self.drawn = [{stay.node(k): pose for k, pose in self.drawn[s].items()} for s in submaps]
        self._submap_poses = [self._submap_poses[s] for s in submaps]
        self._piece_of_submap = [self._piece_of_submap[s] for s in submaps]
        self.nodes = stay.chain(self.nodes)
        self._node_poses = [self._node_poses[k] for k in nodes]
        self._piece_of_node = [self._piece_of_node[k] for k in nodes]
        self.constraints = stay.constraints(self.constraints)
        self._builder.renumber(stay.submap_numbers)
        self._tied_at, self._tried_at = stay.by_submap(self._tied_at), stay.by_submap(self._tried_at)
        self._returned_at, self._returning_at = stay.node(self._returned_at), stay.node(self._returning_at)
        self._stretch = stay.node(self._stretch[0]), stay.submap(self._stretch[1])
        self._finished_nodes = 0

    def finish(self) -> None:
        """Match every node with every near submap and adjust; does nothing where no node is new.

        First roughly, then on submaps that the adjusted graph has straightened: one that was drawn while the robot
        drove is bent by as much as local SLAM drifted meanwhile, and a match on it is turned by up to half a degree.
        Last, those that found no match are tried again from where the graph has them then.
        """
        if self._finished_nodes == len(self.nodes):
            return
        self._finished_nodes = len(self.nodes)
        self._adjust()
        self._match_all(_ROUGHLY, wide=True, kept=self._settled())
        self._adjust()
        self._straighten()
        self._match_all(2 * self._config.nearest, wide=False, kept=set())
        self._adjust()
        self._match_all(2 * self._config.nearest, wide=False, kept=self._settled())
        self._adjust(final=True)

    def _match_all(self, nearest: int, wide: bool, kept: set[tuple[int, int]]) -> None:
        """Match every node with the `nearest` submaps anew, but for pairs that are `kept` or were searched for."""
        self.constraints = [
            c for c in self.constraints if c.kind is Kind.INTRA or c.searched or (c.submap, c.node) in kept
        ]
        near = dict[int, list[int]]()
        for index, submaps in enumerate(self._near(range(len(self.nodes)))):
            for s in submaps[:nearest]:
                if (s, index) not in kept:
                    near.setdefault(s, []).append(index)
        submaps = sorted(near)
        found: list[list[Constraint]] = [[] for _ in submaps]

        def match(start: int, stop: int) -> None:
            for k in range(start, stop):
                found[k] = self._match(submaps[k], near[submaps[k]], wide)

        self._workers.run(match, len(submaps))
        for constraints in found:
            self._take(constraints)

    def _settled(self) -> set[tuple[int, int]]:
        """Return submap and node of the INTER constraints that the graph meets so well that matching finds no other."""
        ties = [c for c in self.constraints if c.kind is Kind.INTER and not c.searched]
        if not ties:
            return set()
        poses = between(
            np.array([self._submap_poses[c.submap] for c in ties]), np.array([self._node_poses[c.node] for c in ties])
        )
        error = between(np.array([c.pose for c in ties]), poses)
        linear, angular = self._config.settled
        good = (np.hypot(error[:, 0], error[:, 1]) <= linear) & (np.abs(error[:, 2]) <= angular)
        return {(ties[k].submap, ties[k].node) for k in np.flatnonzero(good).tolist()}

    def _straighten(self) -> None:
        """Draw every finished submap with its nodes where the graph has them; match what was searched for on these."""
        count = len(self._submaps) - 2
        self._workers.run(self._draw_anew, max(count, 0))
        for s in range(count):
            self._builder.forget(s)
        kept = list[Constraint]()
        for c in self.constraints:
            again = self._builder.again(c, self._submaps[c.submap], self.nodes[c.node].points) if c.searched else c
            kept += [again] if again else []
        self.rejected += len(self.constraints) - len(kept)
        self.constraints = kept

    def _draw_anew(self, start: int, stop: int) -> None:
        """Draw the submaps `start` to `stop` - 1 with their nodes where the graph has them."""
        sweeps = dict[int, Sweep]()  # a node stands in two submaps, one after the other
        for s in range(start, stop):
            submap, nodes = self._submaps[s], list(self.drawn[s])
            poses = between(self._submap_poses[s], np.array([self._node_poses[k] for k in nodes]))
            self.drawn[s] = dict(zip(nodes, poses, strict=True))
            places = compose(submap.pose_local, poses)
            sweeps = {k: sweeps.get(k) or self._sweep(self.nodes[k].scan) for k in nodes}
            self._submaps[s] = submap.redrawn(sweeps[k].at(place) for k, place in zip(nodes, places, strict=True))

    def _centres(self) -> Array:
        """Return (n, 2) the mean places of the laser in the finished submaps, global frame [m]."""
        count = max(0, min(len(self._submaps) - 2, len(self._submap_poses)))
        offsets = np.array([(*submap.centre, 0.0) for submap in self._submaps[:count]]).reshape(-1, 3)
        return compose(np.array(self._submap_poses[:count]).reshape(-1, 3), offsets)[:, :2]

    def _near(self, indices: Sequence[int]) -> list[list[int]]:
        """Return the finished submaps near each of some nodes that it does not stand in, nearest first."""
        centres, near = self._centres(), list[list[int]]()
        for first in range(0, len(indices), _AT_ONCE):
            some = indices[first : first + _AT_ONCE]
            x, y, _ = np.array([self._node_poses[k] for k in some]).T[..., None]
            distance = np.hypot(centres[:, 0] - x, centres[:, 1] - y)
            wanted = distance <= self._config.max_distance
            for row, k in enumerate(some):
                wanted[row, [s for s in self.nodes[k].submaps if s < len(centres)]] = False
                if len(self._placed) > 1:
                    wanted[row] &= self._related(self._piece_of_node[k])[: len(centres)]
            order = np.argsort(distance, axis=1, kind="stable")
            wanted = np.take_along_axis(wanted, order, axis=1)
            near += [row[keep].tolist() for row, keep in zip(order, wanted, strict=True)]
        return near

    def _related(self, piece: int) -> NDArray[np.bool_]:
        """Return (n,) of which submaps it is known how they lie to a piece of the drive."""
        pieces, placed = np.array(self._piece_of_submap), np.array(self._placed)
        return (pieces == piece) | (placed[pieces] & placed[piece])

    def _close_loops(self, index: int) -> None:
        """Track the nearest submaps whose place is known, search for the one that waits longest."""
        config, node = self._config, self.nodes[index]
        known, waiting = [], []
        newest = max(node.submaps[0] - 2, self._stretch[1])
        for s in self._near([index])[0]:
            tied = index - self._tied_at.get(s, -(10**9)) <= config.known_for or s >= newest
            (known if tied else waiting).append(s)
        for s in known[: config.nearest]:
            self._track(s, [index], True)
        self._travelled += float(np.hypot(*between(self.nodes[index - 1].pose_local, node.pose_local)[:2]))
        if waiting and self._travelled >= config.search_every:
            self._travelled = 0.0
            s = min(waiting, key=lambda s: (self._tried_at.get(s, -1), s))
            self._tried_at[s] = index
            found = self._builder.search(s, self._submaps[s], index, node.points, self._guess(s, index))
            self._take([found] if found else [])

    def _guess(self, s: int, index: int) -> Array:
        return between(self._submap_poses[s], self._node_poses[index])

    def _track(self, s: int, nodes: list[int], wide: bool) -> None:
        self._take(self._match(s, nodes, wide))

    def _match(self, s: int, nodes: list[int], wide: bool) -> list[Constraint]:
        """Return the constraints of those `nodes` that match a submap near where the graph has them."""
        guesses = between(self._submap_poses[s], np.array([self._node_poses[k] for k in nodes]))
        points = [self.nodes[k].points for k in nodes]
        return self._builder.track(s, self._submaps[s], nodes, points, guesses, wide)

    def _take(self, constraints: list[Constraint]) -> None:
        for constraint in constraints:
            self.constraints.append(constraint)
            self._tied_at[constraint.submap] = constraint.node
            if constraint.node - next(reversed(self.drawn[constraint.submap]), 0) > self._config.known_for:
                self._returning_at = max(self._returning_at, constraint.node)
            self._new = True

    def _adjust(self, final: bool = False) -> None:
        """Adjust all poses; drop INTER constraints that end far off and adjust again."""
        share, width = self._config.odometry_share, self._config.kernel_width
        graph = assemble(self._submap_poses, self._node_poses, self.nodes, self.constraints, share, width)
        while True:
            graph = graph.with_poses(adjust(graph, self._config.adjustment).poses)
            error, count = graph.errors(), len(self.constraints)
            bad = np.sqrt(graph.squared_distances(error)) > self._config.reject_beyond
            if final:
                bad |= np.hypot(error[:, 0], error[:, 1]) > self._config.final_residual[0]
                bad |= np.abs(error[:, 2]) > self._config.final_residual[1]
            bad[:count] &= np.array([c.kind is Kind.INTER for c in self.constraints])
            bad[count:] = False
            self.constraints = [c for c, wrong in zip(self.constraints, bad[:count], strict=True) if not wrong]
            self.rejected += int(bad.sum())
            if not bad.any():
                break
            graph = graph.with_edges(~bad)
        self._new, self._returned_at, self._trim_due = False, self._returning_at, not final
        submaps = len(self._submap_poses)
        self._submap_poses, self._node_poses = list(graph.poses[:submaps]), list(graph.poses[submaps:])
