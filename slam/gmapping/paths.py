"""Where each particle came from: a tree of poses, one layer per matched scan."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class PathTree:
    """Layers of poses; each particle of a layer knows its ancestor in the layer before."""

    def __init__(self) -> None:
        self._poses: list[Array] = []
        self._parents: list[NDArray[np.intp]] = []

    def append(self, poses: Array) -> None:
        """Add a layer of poses (P, 3), particle i following particle i (see `resample`)."""
        self._poses.append(poses.copy())
        self._parents.append(np.arange(len(poses)))

    def resample(self, parents: NDArray[np.intp]) -> None:
        """Let particle i of the next layer follow particle `parents[i]` of the last one."""
        self._poses[-1] = self._poses[-1][parents]
        self._parents[-1] = self._parents[-1][parents]

    def path(self, particle: int) -> Array:
        """Return (layers, 3), the poses that led to `particle` of the last layer."""
        path = np.empty((len(self._poses), 3))
        for layer in range(len(path) - 1, -1, -1):
            path[layer] = self._poses[layer][particle]
            particle = int(self._parents[layer][particle])
        return path
