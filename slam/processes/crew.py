"""Independent calls of functions, shared among worker processes."""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing.connection import Connection, wait
from time import monotonic
from typing import Any

from ..errors import InputError
from .inside import BEAT_S
from .supervised import SILENT_S, Worker, end_all

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def most_workers() -> int:
    """Return how many processes may be asked for: four a core, since more only wait for each other; at least eight."""
    return max(8, 4 * (os.cpu_count() or 1))


def require_workers(count: int, name: str) -> None:
    """Check a number of processes that was asked for under `name`.

    Raises:
        InputError: If there are none, or more than `most_workers`.
    """
    if count < 1:
        raise InputError(f"{name} must be at least 1, got {count}")
    if count > most_workers():
        reason = f"4 a core, each takes 200 to 400 MB and more only wait: at most {most_workers()} here"
        raise InputError(f"{name} must not exceed what this machine has use for ({reason}), got {count}")


class Crew:
    """Worker processes for independent calls of functions; used as a context, they end with it.

    Args:
        count: How many processes; they start when they are needed.
        silent_s: Time without a sign of life after which one counts as lost [s].
    """

    def __init__(self, count: int, *, silent_s: float = SILENT_S) -> None:
        self._count, self._silent_s = count, silent_s
        self._workers: list[Worker] = []

    def __enter__(self) -> "Crew":
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        end_all(self._workers, at_once=kind is not None)
        self._workers = []

    def results(self, function: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Iterator[tuple[int, Any]]:
        """Yield (index, `function(*calls[index])`) in the order in which they end.

        Args:
            function: Of a module.
            calls: The arguments of each call.

        Raises:
            WorkerError: If a process is gone, or gives no sign of life.
            Exception: What a call ended with; the others are given up.
        """
        while len(self._workers) < min(self._count, len(calls)):
            name = f"worker {len(self._workers) + 1} of {self._count}"
            with _cores_shared(self._count):
                self._workers.append(Worker(name, caller, context="spawn", silent_s=self._silent_s))
        waiting = iter(range(len(calls)))
        busy: dict[Connection, tuple[Worker, int]] = {}
        for worker, index in zip(self._workers, waiting, strict=False):
            worker.ask((function, calls[index]))
            busy[worker.pipe] = worker, index
        for pipe in _ready(busy):
            worker, index = busy.pop(pipe)
            result, error = worker.answer()
            if error is not None:
                raise error
            following = next(waiting, None)
            if following is not None:
                worker.ask((function, calls[following]))
                busy[pipe] = worker, following
            yield index, result


def _ready(busy: dict[Connection, tuple[Worker, int]]) -> Iterator[Connection]:
    """Yield pipes with an answer, or whose worker is gone, as long as any are `busy`; listen to the others."""
    listened = monotonic()
    while busy:
        ready = wait(list(busy), BEAT_S)
        if monotonic() - listened >= BEAT_S:
            listened = monotonic()
            for worker in [worker for pipe, (worker, _) in busy.items() if pipe not in ready]:
                worker.listen()
        yield from ready  # pyright: ignore[reportReturnType]


def caller() -> Callable[[tuple[Callable[..., Any], tuple[Any, ...]]], Any]:
    """Return what answers (function, arguments) by calling it."""
    return lambda call: call[0](*call[1])


@contextmanager
def _cores_shared(count: int) -> Iterator[None]:
    """Let the numerical libraries of a process that starts inside use its share of the cores, unless others are set."""
    share = str(max(1, (os.cpu_count() or 1) // count))
    ours = {name: share for name in _THREADS if name not in os.environ}
    os.environ.update(ours)
    try:
        yield
    finally:
        for name in ours:
            os.environ.pop(name, None)
