"""Pieces of the drive that only odometry ties to each other: local SLAM begins one where it has left its map behind.

How two pieces lie to each other is known as well as the odometry is, until a loop closure joins them.
"""

from bisect import bisect_right
from collections.abc import Iterable
from functools import reduce
from itertools import islice
from operator import add, attrgetter
from typing import NamedTuple

from .constraints import Constraint, Kind
from .slack import Slack
from .trimming import Renumbering


class _Begin(NamedTuple):
    """A piece: its first node and submap, and how far off the odometry may have it, seen from the one before."""

    node: int
    submap: int
    slack: Slack


class Pieces:
    """Which piece each node and submap belongs to, and which pieces are joined."""

    def __init__(self) -> None:
        self._begins = [_Begin(0, 0, Slack())]
        self._joined: list[int] = [0]  # of each piece, the first of those that it is joined with

    def begin(self, node: int, submap: int, slack: Slack) -> None:
        """Begin a piece with a node and a submap, tied to the node before by odometry that may be off by `slack`."""
        if node == 0:
            return
        self._begins.append(_Begin(node, submap, slack))
        self._joined.append(len(self._joined))

    def first_node(self, node: int) -> int:
        """Return the first node of the piece of a node."""
        return self._begins[self._of_node(node)].node

    @property
    def ties(self) -> list[tuple[int, Slack]]:
        """The first node of each piece but the first, and how far off the odometry may have it."""
        return [(begin.node, begin.slack) for begin in self._begins[1:]]

    @property
    def loosest(self) -> Slack:
        """How far off the newest node may be, seen from any submap of before."""
        return _together(begin.slack for begin in self._begins)

    def are_joined(self, submap: int, node: int) -> bool:
        """Return whether more than odometry ties a submap to a node."""
        return self._joined[self._of_submap(submap)] == self._joined[self._of_node(node)]

    def slack(self, submap: int, node: int) -> Slack:
        """Return how far off the odometry may have a node, seen from a submap; nothing where they are joined."""
        if self.are_joined(submap, node):
            return Slack()
        a, b = sorted((self._of_submap(submap), self._of_node(node)))
        return _together(begin.slack for begin in islice(self._begins, a + 1, b + 1))

    def join(self, constraints: Iterable[Constraint]) -> None:
        """Take note of constraints that are new."""
        for constraint in constraints if len(self._begins) > 1 else ():
            if constraint.kind is Kind.INTER:
                a, b = self._of_submap(constraint.submap), self._of_node(constraint.node)
                first, last = sorted((self._joined[a], self._joined[b]))
                self._joined = [first if piece == last else piece for piece in self._joined]

    def rejoin(self, constraints: Iterable[Constraint]) -> None:
        """Take note of all constraints in force, after some have been dropped."""
        self._joined = list(range(len(self._begins)))
        self.join(constraints)

    def _of_node(self, node: int) -> int:
        return bisect_right(self._begins, node, key=attrgetter("node")) - 1

    def _of_submap(self, submap: int) -> int:
        return bisect_right(self._begins, submap, key=attrgetter("submap")) - 1

    def rewind(self, nodes: int, submaps: int, constraints: Iterable[Constraint]) -> None:
        """Forget all but the first so many nodes and submaps."""
        first, *others = self._begins
        self._begins = [first, *(begin for begin in others if begin.node < nodes and begin.submap < submaps)]
        self.rejoin(constraints)

    def renumber(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes and submaps that stay."""
        self._begins = [_Begin(stay.node(node), stay.submap(submap), slack) for node, submap, slack in self._begins]


def _together(slacks: Iterable[Slack]) -> Slack:
    """Return how far off a pose over several ways may be."""
    return reduce(add, slacks, Slack())
