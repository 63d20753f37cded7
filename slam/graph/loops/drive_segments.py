"""Drive segments: a drive is cut where the robot was carried; each segment is placed on the map once it is found."""

import numpy as np
from numpy.typing import NDArray

from .trimming import Renumbering

Flags = NDArray[np.bool_]


class DriveSegments:
    """Which drive segment each node and submap belongs to, and which segments have a known place on the map.

    The first segment defines the map. A later one begins where the robot was carried; nothing ties it to the others
    until relocalization has placed it.
    """

    def __init__(self) -> None:
        self._placed = [True]  # of each segment
        self._of_node: list[int] = []
        self._of_submap: list[int] = []

    @property
    def current(self) -> int:
        """The number of the newest segment."""
        return len(self._placed) - 1

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

    def begin(self, nodes: int, submaps: int) -> None:
        """Begin a segment: the first so many nodes and submaps stay as they are, those after are taken back."""
        del self._of_node[nodes:], self._of_submap[submaps:]
        self._placed.append(False)

    def place_current(self) -> None:
        """Say that the place of the newest segment is known now."""
        self._placed[-1] = True

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
