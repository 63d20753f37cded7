"""Drive segments: a drive is cut where the robot got lost, and each segment is placed on the map once it is found."""

import numpy as np
from numpy.typing import NDArray

from .trimming import Renumbering

Flags = NDArray[np.bool_]


class DriveSegments:
    """Which drive segment each node and submap belongs to, and which segments have a known place on the map.

    The first segment defines the map. A later one begins where the robot was lost; nothing ties it to the others until
    relocalization has placed it. Where the robot was kidnapped, the odometry knows nothing of how the segment lies to
    the one before; after a gap in a log it knows that badly.
    """

    def __init__(self) -> None:
        self._placed, self._kidnapped = [True], [False]  # of each segment
        self._of_node: list[int] = []
        self._of_submap: list[int] = []

    @property
    def current(self) -> int:
        """The number of the newest segment."""
        return len(self._placed) - 1

    @property
    def current_placed(self) -> bool:
        """Whether the place of the newest segment is known."""
        return self._placed[-1]

    @property
    def current_kidnapped(self) -> bool:
        """Whether the robot was kidnapped before the newest segment."""
        return self._kidnapped[-1]

    @property
    def current_has_nodes(self) -> bool:
        """Whether a node of the newest segment exists already."""
        return bool(self._of_node) and self._of_node[-1] == self.current

    @property
    def placed_nodes(self) -> Flags:
        """(n,) whether the place of each node on the map is known."""
        return np.array([self._placed[segment] for segment in self._of_node], dtype=np.bool_)

    @property
    def placed_submaps(self) -> Flags:
        """(s,) whether the place of each submap on the map is known."""
        return np.array([self._placed[segment] for segment in self._of_submap], dtype=np.bool_)

    @property
    def mappable_nodes(self) -> Flags:
        """(n,) whether the place of each node is known, be it by the odometry alone, as after a gap in a log."""
        known = list(self._placed)
        for segment in range(1, len(known)):
            known[segment] = known[segment] or (not self._kidnapped[segment] and known[segment - 1])
        return np.array([known[segment] for segment in self._of_node], dtype=np.bool_)

    def begin(self, disowned: int, kidnapped: bool) -> None:
        """Begin a segment with the next node.

        Args:
            disowned: So many of the last nodes were added when the robot was lost already: they become a segment of
                their own, whose place is not known any more.
            kidnapped: Whether the odometry knows nothing of how the robot came there.
        """
        if disowned:
            self._of_node[-disowned:] = [len(self._placed)] * disowned
            self._placed.append(False)
            self._kidnapped.append(kidnapped)
        self._placed.append(False)
        self._kidnapped.append(kidnapped)

    def place_current(self) -> None:
        """Say that the place of the newest segment is known now."""
        self._placed[-1] = True

    def place_lost(self) -> None:
        """Say that the newest segment, and nodes that were disowned as it began, lie where the odometry has them."""
        last = len(self._placed)
        while last > 1 and not self._placed[last - 1]:
            last -= 1
            self._placed[last], self._kidnapped[last] = True, False

    def add_node(self) -> None:
        """Let a new node belong to the newest segment."""
        self._of_node.append(self.current)

    def add_submap(self) -> None:
        """Let a new submap belong to the newest segment."""
        self._of_submap.append(self.current)

    def current_nodes(self) -> list[int]:
        """Return the nodes of the newest segment."""
        return [k for k, segment in enumerate(self._of_node) if segment == self.current]

    def current_submaps(self) -> list[int]:
        """Return the submaps of the newest segment."""
        return [s for s, segment in enumerate(self._of_submap) if segment == self.current]

    def related(self, node: int) -> Flags:
        """Return (s,) of which submaps it is known how they lie to a node: of its own segment, or both placed."""
        segment = self._of_node[node]
        segments, placed = np.array(self._of_submap), np.array(self._placed)
        return (segments == segment) | (placed[segments] & placed[segment])

    def renumber(self, stay: Renumbering) -> None:
        """Forget the nodes and submaps that have left the graph."""
        nodes, submaps = stay.nodes.tolist(), stay.submaps[: len(self._of_submap)].tolist()
        self._of_node = [segment for segment, stays in zip(self._of_node, nodes, strict=True) if stays]
        self._of_submap = [segment for segment, stays in zip(self._of_submap, submaps, strict=True) if stays]
