"""Which submaps a new node is matched with: all that are well tied already, and one at a time that is searched."""

from .global_config import GlobalSlamConfig
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
        self._searched_at: dict[int, int] = {}
        self._travelled = float("inf")  # since the last search [m]: the first one is due at once
        self._first_submap = 0  # since local SLAM last began anew

    def begin_anew(self, submap: int) -> None:
        """Local SLAM has begun anew with this submap: nothing ties it to those before."""
        self._first_submap = submap

    def place(self, submap: int, node: int) -> None:
        """Count a submap as tied at a node."""
        self._tied_at[submap] = node

    def split(self, near: list[int], node: int, own_submap: int) -> tuple[list[int], list[int]]:
        """Return which submaps near a node are well placed, so that a match suffices, and which need a search.

        Args:
            near: The submaps.
            node: The node.
            own_submap: The first submap in which it stands: the two before count as well placed, by local SLAM.
        """
        tracked: list[int] = []
        waiting: list[int] = []
        newest = max(own_submap - 2, self._first_submap)
        for s in near:
            tied = node - self._tied_at.get(s, _NEVER) <= self._config.known_for or s >= newest
            (tracked if tied else waiting).append(s)
        return tracked, waiting

    def next_search(self, waiting: list[int], node: int, moved: float) -> int | None:
        """Return the submap that has waited longest for a search; None where none waits, or no search is due.

        Args:
            waiting: The submaps that need a search.
            node: The node that is searched for.
            moved: How far the robot has driven since the node before [m].
        """
        self._travelled += moved
        if not waiting or self._travelled < self._config.search_every:
            return None
        self._travelled = 0.0
        submap = min(waiting, key=lambda s: (self._searched_at.get(s, -1), s))
        self._searched_at[submap] = node
        return submap

    def rewind(self, nodes: int, submaps: int) -> None:
        """Forget all but the first so many nodes and submaps."""
        self._tied_at = {s: min(k, nodes) for s, k in self._tied_at.items() if s < submaps}
        self._searched_at = {s: min(k, nodes) for s, k in self._searched_at.items() if s < submaps}
        self._first_submap = min(self._first_submap, submaps)

    def renumber(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes and submaps that stay."""
        self._tied_at, self._searched_at = stay.by_submap(self._tied_at), stay.by_submap(self._searched_at)
        self._first_submap = stay.submap(self._first_submap)
