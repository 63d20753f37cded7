"""The first use on a machine: what must be compiled is compiled by several processes at once.

A kernel is compiled when it is first called, and kept on the disk. For all that a command needs one core takes more
than a minute, in which the others would rest: numba compiles in one thread.
"""

import logging
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import parent_process
from time import monotonic, sleep
from typing import Any

from numba.core.event import Listener, install_listener

from ..errors import InputError

COMPILERS = "TAGALONG_COMPILERS"
"""Environment variable: how many processes compile at the first use; 1: none beside the one that asks for a kernel."""
PATIENCE_S = 600.0
"""Processes that take longer are given up: what they should have compiled is compiled when it is called [s]."""
Part = Callable[[], object]
"""A function of a module that calls, on little data, all that is to be compiled."""

_PROGRAM = "import sys; from importlib import import_module; getattr(import_module(sys.argv[1]), sys.argv[2])()"
_LOOK_S = 0.05
_log = logging.getLogger("tagalong")


@contextmanager
def compiled_together(*parts: Part) -> Iterator[None]:
    """Let the first kernel that must be compiled in this block wait until processes of their own have compiled `parts`.

    Where every kernel is found on the disk nothing happens; so it is in worker processes, which may be many, on a
    single core, and where there is one part only.

    Args:
        parts: What the block will need, that which takes longest first.

    Raises:
        InputError: If the environment variable `TAGALONG_COMPILERS` is no whole number from 1 on.
    """
    count = min(len(parts), most_compilers())
    if count < 2 or parent_process() is not None:
        yield
        return
    with install_listener("numba:compile", _FirstKernel(parts, count)):
        yield


def most_compilers() -> int:
    """Return how many processes may compile at once: `TAGALONG_COMPILERS`, or one a core.

    Raises:
        InputError: If the variable is no whole number from 1 on.
    """
    told = os.environ.get(COMPILERS)
    if told is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not told.isdecimal() or int(told) < 1:
        raise InputError(f"the environment variable {COMPILERS} must be a whole number from 1 on, got {told!r}")
    return int(told)


class _FirstKernel(Listener):
    """Is told of each kernel that is to be compiled; has the parts compiled at the first."""

    def __init__(self, parts: Sequence[Part], count: int) -> None:
        self._parts, self._count = parts, count

    def on_start(self, event: Any) -> None:
        parts, self._parts = self._parts, ()
        if parts:
            compile_parts(parts, self._count)

    def on_end(self, event: Any) -> None:
        pass


def compile_parts(parts: Sequence[Part], count: int) -> None:
    """Call each of the parts in a process of its own, `count` at a time, and wait for them.

    One that fails leaves its kernels to whoever calls them.
    """
    _log.warning("compiling by %d processes: once on this machine, about a minute", count)
    waiting, running = list(parts), list["subprocess.Popen[bytes]"]()
    end_s = monotonic() + PATIENCE_S
    try:
        while (waiting or running) and monotonic() < end_s:
            running = [process for process in running if process.poll() is None]
            while waiting and len(running) < count:
                running.append(_started(waiting.pop(0)))
            sleep(_LOOK_S)
    except OSError:  # no process can be had
        pass
    finally:
        for process in running:
            process.kill()
            process.wait()


def _started(part: Part) -> "subprocess.Popen[bytes]":
    path = os.pathsep.join(place or os.getcwd() for place in sys.path)
    return subprocess.Popen(  # noqa: S603 (this Python, the program above, a function of this package)
        [sys.executable, "-P", "-c", _PROGRAM, part.__module__, part.__name__],
        env={**os.environ, COMPILERS: "1", "PYTHONPATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
