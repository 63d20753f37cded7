"""A long list of poses, kept as numbers: a list of arrays would take five times the memory."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

BLOCK = 1024
"""Poses of a block, 24 kB. Blocks stay where they are: one array that grows is moved again and again, and leaves holes
behind it in which nothing finds a place, 6 MB after 136,000 scans of GMapping."""


class PoseLog:
    """Poses (x, y, theta) one after the other, 24 bytes each."""

    def __init__(self) -> None:
        self._blocks: list[NDArray[np.float64]] = []
        self._count = 0

    @classmethod
    def of(cls, poses: ArrayLike) -> "PoseLog":
        """Return a log of `poses` (n, 3)."""
        log = cls()
        log.extend(np.asarray(poses, dtype=np.float64).reshape(-1, 3))
        return log

    def __len__(self) -> int:
        return self._count

    def append(self, pose: ArrayLike) -> None:
        """Add `pose` (3,)."""
        if self._count == BLOCK * len(self._blocks):
            self._blocks.append(np.empty((BLOCK, 3)))
        block, place = divmod(self._count, BLOCK)
        self._blocks[block][place] = pose
        self._count += 1

    def extend(self, poses: NDArray[np.float64]) -> None:
        """Add `poses` (n, 3)."""
        while len(poses):
            if self._count == BLOCK * len(self._blocks):
                self._blocks.append(np.empty((BLOCK, 3)))
            block, place = divmod(self._count, BLOCK)
            fitting = poses[: BLOCK - place]
            self._blocks[block][place : place + len(fitting)] = fitting
            self._count += len(fitting)
            poses = poses[len(fitting) :]

    def cut(self, start: int, stop: int) -> None:
        """Forget the poses from `start` up to `stop`."""
        after = self.take(np.arange(stop, self._count))
        self._count = start
        del self._blocks[-(-start // BLOCK) :]
        self.extend(after)

    def __getitem__(self, index: int) -> NDArray[np.float64]:
        block, place = divmod(range(self._count)[index], BLOCK)
        return self._blocks[block][place].copy()

    def place(self, index: int) -> tuple[float, float]:
        """Return x and y [m] of the pose with an index of 0 or more, at two fifths of the cost of the whole pose."""
        block, row = divmod(index, BLOCK)
        poses = self._blocks[block]
        return poses.item(row, 0), poses.item(row, 1)

    def __setitem__(self, index: int, pose: ArrayLike) -> None:
        block, place = divmod(range(self._count)[index], BLOCK)
        self._blocks[block][place] = pose

    def take(self, indices: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return (n, 3) the poses of `indices` (n,), without a copy of all."""
        if len(indices) and not 0 <= indices.min() <= indices.max() < self._count:
            raise IndexError(f"poses {indices.min()} to {indices.max()} of {self._count}")
        blocks, places = np.divmod(indices, BLOCK)
        taken = np.empty((len(indices), 3))
        for block in np.unique(blocks).tolist():
            here = blocks == block
            taken[here] = self._blocks[block][places[here]]
        return taken

    def array(self) -> NDArray[np.float64]:
        """Return (n, 3) a copy of all poses."""
        poses = np.empty((self._count, 3))
        for number, block in enumerate(self._blocks):
            part = poses[number * BLOCK : (number + 1) * BLOCK]
            part[:] = block[: len(part)]
        return poses
