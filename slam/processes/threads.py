"""Shares independent pieces of work among threads; the result never depends on how many there are."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from ..errors import InputError

MOST_THREADS = 64
"""No work here has more pieces worth a thread each."""

_GIVEN, _LEAST = 2 / 3, 1 / 32
"""Parts of a thread's equal share: of what is left, that it is given at once; of all, that is worth handing over."""


class Workers:
    """Runs a function, mostly kernels that release the interpreter's lock, on slices of the pieces.

    Args:
        threads: Number of threads; 1 runs everything in the caller.

    Raises:
        InputError: If there are none, or more than there is work for.
    """

    def __init__(self, threads: int) -> None:
        if not 1 <= threads <= MOST_THREADS:
            raise InputError(f"`threads` must be within 1 .. {MOST_THREADS}, got {threads}")
        self.threads = threads
        self._pool: ThreadPoolExecutor | None = None
        self._process = os.getpid()

    def run(self, work: Callable[[int, int], object], count: int) -> None:
        """Call `work(start, stop)` for slices that cover range(count), each index once."""
        if self.threads == 1 or count <= 1:
            work(0, count)
            return
        turns = iter(slices(count, self.threads))  # each is given out once, by the interpreter's lock

        def share() -> None:
            for start, stop in turns:
                work(start, stop)

        self.together(share)

    def together(self, work: Callable[[], object]) -> None:
        """Call `work()` once in every thread, the caller's among them."""
        if self.threads == 1:
            work()
            return
        if self._pool is None or self._process != os.getpid():  # a forked process has no threads but its own
            self._pool, self._process = ThreadPoolExecutor(self.threads - 1), os.getpid()
        others = [self._pool.submit(work) for _ in range(self.threads - 1)]
        try:
            work()
        finally:
            wait(others)  # before the arrays that they write are looked at, or freed
        for other in others:
            other.result()

    def __getstate__(self) -> dict[str, object]:
        return {"threads": self.threads, "_pool": None, "_process": 0}  # threads are not copied: they start again


def slices(count: int, threads: int) -> list[tuple[int, int]]:
    """Return slices that cover range(count), ever shorter, so that no thread waits long for the last one of another.

    Each is a part of what is left (guided self-scheduling: Polychronopoulos and Kuck, IEEE Transactions on Computers,
    1987), so that few are handed over, and a thread with less of a processor ends with the others.

    Args:
        count: Pieces of work.
        threads: Threads that share them.
    """
    least = max(1, int(_LEAST * count / threads))
    parts, start = list[tuple[int, int]](), 0
    while start < count:
        stop = min(count, start + max(least, int(_GIVEN * (count - start) / threads)))
        parts.append((start, stop))
        start = stop
    return parts
