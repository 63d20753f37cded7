"""Memory of large arrays that come and go by the hundred, used again and again.

Given back to malloc, a block of megabytes is a hole in which small things settle that stay; the next such block finds
no place any more, and after 50 laps of a log by graph SLAM 29 MB were free in holes. Pages that the system takes back
leave none, but fresh ones cost five to ten times what clearing used ones does.
"""

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", bound=np.generic)
Block = NDArray[np.uint8]

_LEAST = 1 << 17
"""Bytes from which an array is large: where malloc of glibc draws its line (M_MMAP_THRESHOLD)."""
_KEPT = 32 << 20
"""Bytes that are kept for what comes next: the grids of two submaps of 60 m x 60 m."""


class ReusedMemory:
    """Blocks of memory that no array lies on, in the order in which they became free. Threads may share it.

    Args:
        kept: Bytes that are kept at most.
    """

    def __init__(self, kept: int = _KEPT) -> None:
        self._kept = kept
        self._free: dict[int, Block] = {}  # by their ids; each change is one step for other threads

    @property
    def nbytes(self) -> int:
        """Bytes that are kept."""
        return sum(map(len, list(self._free.values())))

    def take(self, size: int) -> Block:
        """Return a block of at least `size` bytes: the smallest of the free ones, unless it is twice as large."""
        free = list(self._free.items())
        for key, block in sorted((item for item in free if size <= len(item[1]) <= 2 * size), key=_length):
            if self._free.pop(key, None) is not None:
                return block
        step = 1 << max(size.bit_length() - 3, 0)  # four sizes from one power of two to the next
        return np.empty(-(-size // step) * step, np.uint8)

    def give(self, block: Block) -> None:
        """Take a block back; those that have been free for longest go where there are too many."""
        self._free[id(block)] = block
        for key in list(self._free):
            if self.nbytes <= self._kept:
                break
            self._free.pop(key, None)


def _length(item: tuple[int, Block]) -> int:
    return len(item[1])


class _Lease:
    """What an array lies on: gives the block back once neither the array nor a view of it lives."""

    def __init__(self, memory: ReusedMemory, size: int, shape: Sequence[int], typestr: str) -> None:
        self._memory, self._block = memory, memory.take(size)
        place = self._block.__array_interface__["data"]
        self.__array_interface__ = {"shape": tuple(shape), "typestr": typestr, "data": place, "version": 3}

    def __del__(self) -> None:
        self._memory.give(self._block)


_MEMORY = ReusedMemory()


def reused_array(
    shape: Sequence[int], dtype: type[Number] | np.dtype[Number], memory: ReusedMemory = _MEMORY
) -> NDArray[Number]:
    """Return an array of that shape and kind with any content, as `numpy.empty` does.

    Raises:
        MemoryError: If there is no memory for it.
    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    if size < _LEAST:
        return np.empty(shape, dtype)
    return np.asarray(_Lease(memory, size, shape, np.dtype(dtype).str))
