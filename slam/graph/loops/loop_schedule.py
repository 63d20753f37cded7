"""Which submaps a new node is matched with: all that are well tied already, and one at a time that is searched."""

from .global_config import GlobalSlamConfig
from .stretch import STRETCH
from .trimming import Renumbering

_NEVER = -(10**9)  # earlier than any node


class LoopSchedule:
    """Remembers when each submap was last tied to a node and last searched for.

    Args:
        config: Settings of global SLAM.
    """

    def __init__(self, config: GlobalSlamConfig) -> None:
        self._config = config
        self._tied_at: dict[int, int] = {}
        self._travelled = self._travelled_widely = 0.0  # since the last search [m]

    def place(self, submap: int, node: int) -> None:
        """Count a submap as tied at a node."""
        self._tied_at[submap] = node

    def split(self, near: list[int], node: int, own_submap: int, first_submap: int) -> tuple[list[int], list[int]]:
        """Return which submaps near a node are well placed, so that a match suffices, and which need a search.

        Args:
            near: The submaps.
            node: The node.
            own_submap: The first submap in which it stands: the two before count as well placed, by local SLAM, ...
            first_submap: ... but none before this, with which local SLAM began anew.
        """
        tracked: list[int] = []
        waiting: list[int] = []
        newest = max(own_submap - 2, first_submap)
        for s in near:
            tied = node - self._tied_at.get(s, _NEVER) <= self._config.known_for or s >= newest
            (tracked if tied else waiting).append(s)
        return tracked, waiting

    def search_is_due(self, moved: float) -> bool:
        """Return whether a node is searched for, `moved` [m] after the one before."""
        self._travelled += moved
        due = self._travelled >= self._config.search_every
        self._travelled = 0.0 if due else self._travelled
        return due

    def wide_search_is_due(self, moved: float) -> bool:
        """Return whether a node is searched for on all that only odometry ties to it: once each stretch."""
        self._travelled_widely += moved
        due = self._travelled_widely >= STRETCH
        self._travelled_widely = 0.0 if due else self._travelled_widely
        return due

    def rewind(self, nodes: int, submaps: int) -> None:
        """Forget all but the first so many nodes and submaps."""
        self._tied_at = {s: min(k, nodes) for s, k in self._tied_at.items() if s < submaps}

    def renumber(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes and submaps that stay."""
        self._tied_at = stay.by_submap(self._tied_at)
