"""Worker processes that end when their parent does, and whose own end the parent notices within a bounded time.

A worker ends by itself, on every platform, when its parent is gone, however that came: idle, since its pipe ends; while
it works, since a thread in it watches the parent. On Linux the kernel ends it at once, even one that was stopped. The
same thread gives a sign of life every second; a parent that waits for an answer misses them after `silent_s`.
"""

import multiprocessing as mp
import os
import signal
import socket
import struct
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import forkserver, resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.util import Finalize
from time import monotonic
from typing import Any
from weakref import WeakSet

from ..errors import WorkerError
from .inside import BEAT_S, HELD, serve

SILENT_S = 60.0
"""A worker that shows nothing for so long counts as lost [s]: the longest kernels that let no thread run take seconds,
and a loaded machine may need as many to start one, which imports all anew where it is not forked."""
PATIENCE_S = 2.0
"""How long a worker that has to go is waited for before the next harder means: pipe closed, SIGTERM, SIGKILL [s]."""
_ENDS: WeakSet[Connection] = WeakSet()
"""This process's ends of the pipes to its workers. A forked worker inherits those of all workers before it, and must
not keep them: a pipe ends when its last holder is gone."""


class Worker:
    """One process that answers questions, one at a time.

    Args:
        name: For messages, such as "worker 2 of 4".
        make: Module-level function that returns, in the process, the function that answers a question.
        arguments: Its arguments.
        context: How the process starts: "fork", "forkserver", "spawn"; None takes the platform's way.
        silent_s: Time without a sign of life after which the process counts as lost [s]; to start it has `SILENT_S` at
            least.
    """

    def __init__(
        self,
        name: str,
        make: Callable[..., Callable[[Any], Any]],
        arguments: tuple[Any, ...] = (),
        *,
        context: str | None = None,
        silent_s: float = SILENT_S,
    ) -> None:
        start: Any = mp.get_context(context)
        self.name, self._silent_s, self._started = name, silent_s, False
        self.pipe, theirs = start.Pipe()
        _bound_waits(self.pipe, self._patience_s)
        self._beats, their_beats = start.Pipe(duplex=False)
        _ENDS.update((self.pipe, self._beats))
        self._asked, self._missed = 0, 0
        method = start.get_start_method()
        lasting = method == "forkserver" or threading.current_thread() is threading.main_thread()
        given = (theirs, their_beats, lasting, make, arguments)
        self.process = start.Process(target=_inside, args=given, name=name, daemon=True)
        with _interrupts_held(method):
            self.process.start()
        theirs.close()
        their_beats.close()
        self._end = Finalize(self, _end, args=([self.process], [self.pipe, self._beats]), exitpriority=1)

    def ask(self, task: Any) -> None:
        """Send a question.

        Raises:
            WorkerError: If the process is gone, or takes nothing for `silent_s`.
        """
        self._asked, self._missed = self._asked + 1, 0
        try:
            self.pipe.send((self._asked, task))
        except OSError:
            raise self._lost() from None

    def answer(self) -> tuple[Any, Exception | None]:
        """Wait for the answer to the last question: (result, None) or (None, the error that it ended with).

        Raises:
            WorkerError: If the process is gone, or gives no sign of life for `silent_s`.
        """
        while True:
            while not self.pipe.poll(BEAT_S):
                self.listen()
            try:
                number, result, error = self.pipe.recv()
            except (EOFError, OSError):
                raise self._lost() from None
            self._lives()
            if number == self._asked:  # an older one answers a question whose asker was interrupted
                return result, error

    def listen(self) -> None:
        """Count a second without an answer.

        Raises:
            WorkerError: If there was no sign of life in `silent_s` of them, in more if there was none ever.
        """
        self._missed += 1
        with suppress(EOFError, OSError):  # it has ended: its pipe tells that, too
            while self._beats.poll(0):
                self._beats.recv_bytes()
                self._missed = 0
                self._lives()
        if self._missed * BEAT_S >= self._patience_s:
            raise self._lost()

    @property
    def _patience_s(self) -> float:
        return self._silent_s if self._started else max(self._silent_s, SILENT_S)

    def _lives(self) -> None:
        """Take note of a sign of life: the first one says that the process has started."""
        if not self._started:
            self._started = True
            _bound_waits(self.pipe, self._patience_s)

    def close(self) -> None:
        """End the process, within a few seconds whatever it does."""
        end_all([self])

    def _lost(self) -> WorkerError:
        """Return what became of the process."""
        self.process.join(BEAT_S)
        code = self.process.exitcode
        if code is not None and code > 128:  # SIGTERM came while Python code could still answer it
            code = 128 - code
        who = f"{self.name} (process {self.process.pid})"
        if code is None:
            return WorkerError(f"{who} gave no sign of life for {self._patience_s:g} s: stopped, or hung")
        if code < 0:
            hint = "; the system may have run out of memory" if code == -getattr(signal, "SIGKILL", 9) else ""
            return WorkerError(f"{who} was ended by {signal.Signals(-code).name}{hint}")
        return WorkerError(f"{who} has ended with exit code {code}")


def end_all(workers: Sequence[Worker], *, at_once: bool = False) -> None:
    """End processes together, within a few seconds whatever they do.

    Args:
        workers: Whose; those that have ended may be among them.
        at_once: Do not wait for one that works.
    """
    for worker in workers:
        worker._end.cancel()
    pipes = [pipe for worker in workers for pipe in (worker.pipe, worker._beats)]
    _end([worker.process for worker in workers], pipes, at_once=at_once)


def _inside(*given: Any) -> None:
    """Run in the process: let go of the parent's ends, then serve."""
    for end in list(_ENDS):
        end.close()
    server: Any = getattr(forkserver, "_forkserver", None)
    alive = getattr(server, "_forkserver_alive_fd", None)
    if alive is not None:  # the fork server ends with the last holder of this, and its workers end with it
        os.close(alive)
        server._forkserver_alive_fd = None
    serve(*given)


@contextmanager
def _interrupts_held(method: str) -> Iterator[None]:
    """Let a process that starts inside be born deaf to signals: it takes a while until it has its own way with them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    if method != "fork":
        resource_tracker.ensure_running()  # its start would take the mask away
    if method == "forkserver":
        forkserver.ensure_running()  # others start processes by it, too, and may want to be interrupted
    before = signal.pthread_sigmask(signal.SIG_BLOCK, HELD)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _bound_waits(pipe: Connection, seconds: float) -> None:
    """Bound how long a message that was begun may take through `pipe`, where pipes are sockets."""
    if sys.platform == "win32":
        return
    limit = struct.pack("@ll", int(seconds), int(1e6 * (seconds % 1.0)))
    with socket.socket(fileno=os.dup(pipe.fileno())) as ours:
        ours.settimeout(None)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, limit)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, limit)


def _end(processes: Sequence[Any], pipes: Sequence[Connection], *, at_once: bool = False) -> None:
    """End processes by closing their pipes; by SIGTERM who does not go; by SIGKILL who does not even then."""
    for pipe in pipes:
        pipe.close()
    if not at_once:
        _join(processes, PATIENCE_S)
    for means in ("terminate", "kill"):
        for process in processes:
            if process.is_alive():
                getattr(process, means)()
        _join(processes, PATIENCE_S)


def _join(processes: Sequence[Any], seconds: float) -> None:
    deadline = monotonic() + seconds
    for process in processes:
        process.join(max(0.0, deadline - monotonic()))
