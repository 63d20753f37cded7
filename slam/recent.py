"""What was made last, as far as it fits in memory; the rest is made again when it is asked for."""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


class Recent(Generic[Key, Value]):
    """Values of the keys that were asked for last. Threads may share it.

    Args:
        make: Makes the value of a key.
        size: Bytes of a value.
        most: So many bytes are kept ...
        least: ... but so many values in any case.
    """

    def __init__(self, make: Callable[[Key], Value], size: Callable[[Value], int], most: int, least: int) -> None:
        self._make, self._size, self._most, self._least = make, size, most, least
        self._values: OrderedDict[Key, Value] = OrderedDict()  # each of its methods is one step for other threads

    def __getitem__(self, key: Key) -> Value:
        value = self._values.pop(key, None)
        if value is not None:
            self._values[key] = value
            return value
        value = self._values[key] = self._make(key)
        while len(self._values) > self._least and sum(map(self._size, list(self._values.values()))) > self._most:
            self._values.popitem(last=False)
        return value
