"""Arrays over worlds that grow as larger buildings or more people come."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


class Records:
    """Rows of equal arrays, by name; a row may hold less than there is room for.

    Args:
        count: How many rows.

    Attributes:
        arrays: Name -> (count, ...).
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self.arrays: dict[str, Array] = {}
        self._used = np.zeros(count, dtype=bool)

    def put(self, row: int, values: Mapping[str, Array]) -> None:
        """Write `values` into a row; what has grown is made larger for all rows, what is behind is left 0."""
        self._used[row] = True
        for name, value in values.items():
            array = self._with_room(name, value)
            array[row] = 0
            array[(row, *(slice(size) for size in value.shape))] = value

    def _with_room(self, name: str, value: Array) -> Array:
        old = self.arrays.get(name)
        if old is None:
            self.arrays[name] = np.zeros((self.count, *value.shape), dtype=value.dtype)
        elif any(size > room for size, room in zip(value.shape, old.shape[1:], strict=True)):
            shape = tuple(_roomy(size, room) for size, room in zip(value.shape, old.shape[1:], strict=True))
            larger = self.arrays[name] = np.zeros((self.count, *shape), dtype=old.dtype)
            for row in np.flatnonzero(self._used):  # rows that were never used take no memory
                larger[(row, *(slice(size) for size in old.shape[1:]))] = old[row]
        return self.arrays[name]

    @property
    def in_use(self) -> dict[str, Array]:
        """The rows up to the last one that is used, as views."""
        behind = int(np.flatnonzero(self._used)[-1]) + 1 if self._used.any() else 0
        return {name: array[:behind] for name, array in self.arrays.items()}

    @property
    def size(self) -> int:
        """Memory of the rows that are used [bytes]."""
        return sum(array.nbytes for array in self.arrays.values()) * int(self._used.sum()) // self.count


def _roomy(size: int, room: int) -> int:
    """Return the room for `size`, a little more than needed where it grows."""
    return room if size <= room else size + size // 8
