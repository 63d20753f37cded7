"""The inside of a worker process: it answers questions, gives signs of life, and ends when its parent does."""

import ctypes
import multiprocessing as mp
import os
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from types import FrameType
from typing import Any

from ..errors import InputError
from .brittle import is_brittle, send_again

BEAT_S = 1.0
"""A worker shows that it lives, and looks whether its parent does, this often [s]: orphans are gone within two."""
HELD = {signal.SIGINT, signal.SIGTERM}
"""Signals that wait until a new worker has its own way with them."""
_PR_SET_PDEATHSIG = 1


def serve(
    pipe: Connection,
    beats: Connection,
    lasting: bool,
    make: Callable[..., Callable[[Any], Any]],
    arguments: tuple[Any, ...],
) -> None:
    """Answer what comes through `pipe`, until it ends, or SIGTERM comes: what comes out after that comes of it.

    Args:
        pipe: Gives (number, question), takes (number, result, error).
        beats: Takes signs of life.
        lasting: The thread that started this process lives as long as the parent.
        make: Returns what answers a question.
        arguments: Its arguments.
    """
    came = _take_signals()
    if lasting and sys.platform == "linux":  # it acts when the thread ends that started this process
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    threading.Thread(target=_live, args=(beats,), daemon=True).start()
    try:
        _answer(pipe, _made(make, arguments), came)
    except BaseException:
        if not came:
            raise
    if came:  # an extension module that is being imported turns the exit into an error of its own
        raise SystemExit(128 + came[0])


def _answer(pipe: Connection, do: Callable[[Any], Any], came: list[int]) -> None:
    """Answer by `do` until the pipe ends, or a signal `came`."""
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):  # closed, or the parent is gone
        while not came:
            number, task = pipe.recv()
            result, error = answered(do, task)
            if came:
                return
            if error is not None and not isinstance(error, InputError):  # that one says all by itself
                error.add_note("".join(traceback.format_exception(error)))  # a pipe carries no traceback
            try:
                pipe.send((number, result, error))
            except (TypeError, AttributeError, ValueError) as unsendable:
                pipe.send(
                    (number, None, RuntimeError(f"{error or result!r:.200} passes through no pipe: {unsendable}"))
                )


def _made(make: Callable[..., Callable[[Any], Any]], arguments: tuple[Any, ...]) -> Callable[[Any], Any]:
    """Return what `make` makes; where it fails, a function that fails with the same error, for the parent to see."""
    try:
        return make(*arguments)
    except Exception as failure:
        error = failure

    def fail(task: Any) -> Any:
        raise error

    return fail


def answered(do: Callable[[Any], Any], task: Any) -> tuple[Any, Exception | None]:
    """Return (`do(task)`, None), or (None, error)."""
    try:
        return do(task), None
    except Exception as error:  # whatever it is, it is raised where the question was asked, not lost in a process
        return None, error


def _take_signals() -> list[int]:
    """Leave Ctrl-C, which comes to all processes of a terminal, to the parent; let SIGTERM unwind what runs.

    What it leaves half made says nothing of that as it goes.

    Returns:
        The numbers of the signals that came, none yet.
    """
    came: list[int] = []
    hook = sys.unraisablehook

    def leave(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if is_brittle(frame):
            send_again(number)
            return
        raise SystemExit(128 + number)

    sys.unraisablehook = lambda lost: None if came else hook(lost)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, leave)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HELD)
    return came


def _live(beats: Connection) -> None:
    """Give signs of life until the parent is gone; then end this process, whatever it does."""
    parent, home = mp.parent_process(), os.getppid()
    assert parent is not None
    if sys.platform != "win32":
        os.set_blocking(beats.fileno(), False)  # of a parent that has not listened for hours, the rest is lost
    while os.getppid() == home and not wait([parent.sentinel], BEAT_S):
        with suppress(OSError):
            beats.send_bytes(b".")
    os._exit(1)
