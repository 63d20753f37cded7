"""Pieces of the drive that only odometry ties to each other: local SLAM begins one where it has left its map behind.

How two pieces lie to each other is known as well as the odometry is, until a loop closure joins them.
"""

from collections.abc import Iterable
from itertools import islice

from ...scan_to_grid.extrapolator import Prediction
from .constraints import Constraint, Kind
from .slack import Slack
from .trimming import Renumbering


class Pieces:
    """Which piece each node and submap belongs to, and which pieces are joined."""

    def __init__(self) -> None:
        self._begins: list[tuple[int, int, Slack]] = [(0, 0, Slack())]  # first node, first submap, how loosely it hangs
        self._joined: list[int] = [0]  # of each piece, the first of those that it is joined with

    def begin(self, node: int, submap: int, motion: Prediction) -> None:
        """Begin a piece with a node and a submap, tied to the node before by a `motion` of the odometry.

        The less is known of the heading, the less is known of where that leads.
        """
        if node == 0:
            return
        self._begins.append((node, submap, Slack(*motion.sigma.tolist()).after(motion.pose)))
        self._joined.append(len(self._joined))

    def first_node(self, node: int) -> int:
        """Return the first node of the piece of a node."""
        return self._begins[self._of(node, 0)][0]

    @property
    def first_submap(self) -> int:
        """The first submap of the newest piece."""
        return self._begins[-1][1]

    @property
    def loosest(self) -> Slack:
        """How far off the newest node may be, seen from any submap of before."""
        return sum((slack for _, _, slack in self._begins), Slack())

    def are_joined(self, submap: int, node: int) -> bool:
        """Return whether more than odometry ties a submap to a node."""
        return self._joined[self._of(submap, 1)] == self._joined[self._of(node, 0)]

    def slack(self, submap: int, node: int) -> Slack:
        """Return how far off the odometry may have a node, seen from a submap; nothing where they are joined."""
        if self.are_joined(submap, node):
            return Slack()
        a, b = sorted((self._of(submap, 1), self._of(node, 0)))
        return sum((slack for _, _, slack in islice(self._begins, a + 1, b + 1)), Slack())

    def join(self, constraints: Iterable[Constraint]) -> None:
        """Take note of constraints that are new."""
        for constraint in constraints if len(self._begins) > 1 else ():
            if constraint.kind is Kind.INTER:
                a, b = self._of(constraint.submap, 1), self._of(constraint.node, 0)
                first, last = sorted((self._joined[a], self._joined[b]))
                self._joined = [first if piece == last else piece for piece in self._joined]

    def rejoin(self, constraints: Iterable[Constraint]) -> None:
        """Take note of all constraints in force, after some have been dropped."""
        self._joined = list(range(len(self._begins)))
        self.join(constraints)

    def _of(self, index: int, kind: int) -> int:
        """Return the piece of a node (`kind` 0) or submap (1)."""
        piece = len(self._begins) - 1
        while self._begins[piece][kind] > index:
            piece -= 1
        return piece

    def rewind(self, nodes: int, submaps: int, constraints: Iterable[Constraint]) -> None:
        """Forget all but the first so many nodes and submaps."""
        self._begins = [
            begin for k, begin in enumerate(self._begins) if k == 0 or (begin[0] < nodes and begin[1] < submaps)
        ]
        self.rejoin(constraints)

    def renumber(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes and submaps that stay."""
        self._begins = [(stay.node(node), stay.submap(submap), slack) for node, submap, slack in self._begins]
