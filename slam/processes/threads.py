"""Shares independent pieces of work among threads; the result never depends on how many there are."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from ..errors import InputError

MOST_THREADS = 64
"""No work here has more pieces worth a thread each."""


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
        if self._pool is None or self._process != os.getpid():  # a forked process has no threads but its own
            self._pool, self._process = ThreadPoolExecutor(self.threads - 1), os.getpid()
        slices = min(count, 4 * self.threads)  # smaller than a thread's share, so that none waits long for another
        turns = iter(range(slices))  # each is given out once, by the interpreter's lock

        def share() -> None:
            for k in turns:
                work(count * k // slices, count * (k + 1) // slices)

        others = [self._pool.submit(share) for _ in range(self.threads - 1)]
        try:
            share()  # the caller works, too: to hand over a slice takes as long as some slices do
        finally:
            wait(others)  # before the arrays that they write are looked at, or freed
        for other in others:
            other.result()

    def __getstate__(self) -> dict[str, object]:
        return {"threads": self.threads, "_pool": None, "_process": 0}  # threads are not copied: they start again
