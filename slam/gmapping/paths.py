"""Where each particle came from: a tree of poses, one layer per matched scan."""

import numpy as np
from numpy.typing import NDArray

from ..pose_log import PoseLog

Array = NDArray[np.float64]

_MOST_LAYERS = 64  # above the trunk, before a common ancestor is looked for


class PathTree:
    """Layers of poses; each particle of a layer knows its ancestor in the layer before.

    Up to the last common ancestor of all particles the path is the same for all, and is kept once: the trunk.
    """

    def __init__(self) -> None:
        self._trunk = PoseLog()
        self._poses: list[Array] = []
        self._parents: list[NDArray[np.intp]] = []

    def __len__(self) -> int:
        return len(self._trunk) + len(self._poses)

    def append(self, poses: Array) -> None:
        """Add a layer of poses (P, 3), particle i following particle i (see `resample`)."""
        self._poses.append(poses.copy())
        self._parents.append(np.arange(len(poses)))

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Let particle i of the next layer follow particle `parents[i]` of the last one."""
        self._poses[-1] = self._poses[-1][parents]
        self._parents[-1] = self._parents[-1][parents]
        if len(self._poses) >= _MOST_LAYERS:
            self._join()

    def _join(self) -> None:
        """Move the layers that all particles share to the trunk."""
        ancestors = np.arange(len(self._parents[-1]))
        for layer in range(len(self._poses) - 1, 0, -1):
            ancestors = np.unique(self._parents[layer][ancestors])
            if len(ancestors) == 1:
                self._grow_trunk(layer, int(ancestors[0]))
                return

    def _grow_trunk(self, layers: int, particle: int) -> None:
        """Keep of the first so many `layers` only the poses that led to `particle` of the last of them."""
        for pose in self._back(layers, particle):
            self._trunk.append(pose)
        del self._poses[:layers], self._parents[:layers]

    def _back(self, layers: int, particle: int) -> Array:
        """Return (layers, 3), the poses of the first so many `layers` that led to `particle` of the last of them."""
        path = np.empty((layers, 3))
        for layer in range(layers - 1, -1, -1):
            path[layer] = self._poses[layer][particle]
            particle = int(self._parents[layer][particle])
        return path

    def path(self, particle: int) -> Array:
        """Return (layers, 3), the poses that led to `particle` of the last layer."""
        return np.concatenate((self._trunk.array(), self._back(len(self._poses), particle)))
