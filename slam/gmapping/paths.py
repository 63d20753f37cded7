"""Where each particle came from: a tree of poses, one layer per matched scan."""

import numpy as np
from numpy.typing import NDArray

from ..pose_log import PoseLog

Array = NDArray[np.float64]

_MOST_LAYERS = 64  # above the trunk, before a common ancestor is looked for


class PathTree:
    """Layers of poses; each particle of a layer knows its ancestor in the layer before.

    Up to the last common ancestor of all particles the path is the same for all, and is kept once: the trunk. Where
    the map is known all particles explain the scans alike, so that none dies for thousands of layers; a layer that
    follows no resampling is therefore nothing but its poses.
    """

    def __init__(self) -> None:
        self._trunk = PoseLog()
        self._particles = 0
        self._poses = PoseLog()  # of all particles, layer after layer
        self._parents: list[NDArray[np.uint16] | None] = []  # None: each particle follows the one of its own number

    def __len__(self) -> int:
        return len(self._trunk) + len(self._parents)

    def append(self, poses: Array) -> None:
        """Add a layer of poses (P, 3), particle i following particle i (see `resample`)."""
        self._particles = len(poses)
        self._poses.extend(poses)
        self._parents.append(None)

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Let particle i of the next layer follow particle `parents[i]` of the last one."""
        first, stop = len(self._poses) - self._particles, len(self._poses)
        chosen = self._poses.take(first + parents)
        self._poses.cut(first, stop)
        self._poses.extend(chosen)
        before = self._parents[-1]
        self._parents[-1] = parents.astype(np.uint16) if before is None else before[parents]
        if len(self._parents) >= _MOST_LAYERS:
            self._join()

    def _join(self) -> None:
        """Move the layers that all particles share to the trunk."""
        ancestors = np.arange(self._particles)
        for layer in range(len(self._parents) - 1, 0, -1):
            parents = self._parents[layer]
            if parents is not None:
                ancestors = np.unique(parents[ancestors])
            if len(ancestors) == 1:
                self._grow_trunk(layer, int(ancestors[0]))
                return

    def _grow_trunk(self, layers: int, particle: int) -> None:
        """Keep of the first so many `layers` only the poses that led to `particle` of the last of them."""
        self._trunk.extend(self._back(layers, particle))
        self._poses.cut(0, layers * self._particles)
        del self._parents[:layers]

    def _back(self, layers: int, particle: int) -> Array:
        """Return (layers, 3), the poses of the first so many `layers` that led to `particle` of the last of them."""
        places = np.empty(layers, dtype=np.intp)
        for layer in range(layers - 1, -1, -1):
            places[layer] = layer * self._particles + particle
            parents = self._parents[layer]
            particle = particle if parents is None else int(parents[particle])
        return self._poses.take(places)

    def path(self, particle: int) -> Array:
        """Return (layers, 3), the poses that led to `particle` of the last layer."""
        return np.concatenate((self._trunk.array(), self._back(len(self._parents), particle)))
