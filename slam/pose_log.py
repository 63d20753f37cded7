"""A long list of poses, kept as numbers: a list of arrays would take five times the memory."""

from array import array

import numpy as np
from numpy.typing import ArrayLike, NDArray


class PoseLog:
    """Poses (x, y, theta) one after the other, 24 bytes each."""

    def __init__(self) -> None:
        self._numbers = array("d")

    @classmethod
    def of(cls, poses: ArrayLike) -> "PoseLog":
        """Return a log of `poses` (n, 3)."""
        log = cls()
        log._numbers.extend(np.asarray(poses, dtype=np.float64).ravel().tolist())
        return log

    def __len__(self) -> int:
        return len(self._numbers) // 3

    def append(self, pose: ArrayLike) -> None:
        """Add `pose` (3,)."""
        self._numbers.extend(np.asarray(pose, dtype=np.float64).tolist())

    def extend(self, poses: NDArray[np.float64]) -> None:
        """Add `poses` (n, 3)."""
        self._numbers.frombytes(poses.tobytes())

    def cut(self, start: int, stop: int) -> None:
        """Forget the poses from `start` up to `stop`."""
        del self._numbers[3 * start : 3 * stop]

    def __getitem__(self, index: int) -> NDArray[np.float64]:
        start = 3 * range(len(self))[index]
        return np.array(self._numbers[start : start + 3])

    def __setitem__(self, index: int, pose: ArrayLike) -> None:
        start = 3 * range(len(self))[index]
        self._numbers[start : start + 3] = array("d", np.asarray(pose, dtype=np.float64).tolist())

    def take(self, indices: NDArray[np.intp]) -> NDArray[np.float64]:
        """Return (n, 3) the poses of `indices` (n,), without a copy of all."""
        return np.frombuffer(self._numbers).reshape(-1, 3)[indices]

    def array(self) -> NDArray[np.float64]:
        """Return (n, 3) a copy of all poses."""
        return np.array(self._numbers).reshape(-1, 3)
