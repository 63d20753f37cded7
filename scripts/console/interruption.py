"""Ctrl-C, SIGTERM and SIGHUP end a command in order: what it began is undone, its workers end, one line says why."""

import atexit
import os
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from types import FrameType
from typing import Any, NoReturn

from ...slam.processes.brittle import is_brittle, send_again

_WORDS = {"SIGINT": "interrupted", "SIGTERM": "terminated", "SIGHUP": "its terminal is gone"}
_AGAIN_S = 2.0
"""Signals that follow the first sooner than this mean the same: Ctrl-C reaches a program by its shell, too [s]."""
_MOST_PATIENCE_S = 20.0
"""What is brittle may end in peace, but not if it waits for ever [s]."""


class Interruption(KeyboardInterrupt):
    """Raised where the program was when a signal came that ends it."""


class _Signals:
    """Raises `Interruption` on signals, and sees to it that it is not lost.

    Attributes:
        came: Number of the first signal that came; None while none has.
    """

    def __init__(self) -> None:
        self.came: int | None = None
        self._came_s = 0.0
        self._raised_s = float("-inf")
        self._before: dict[int, Any] = {}
        self._hook = sys.unraisablehook

    def take(self) -> None:
        """Take the signals that are not ignored, as those of a program in the background are."""
        for name in _WORDS:
            number = getattr(signal, name, None)
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
                self._before[number] = signal.signal(number, self._raise)
        sys.unraisablehook = self._unraisable

    def give_back(self, *, for_good: bool) -> None:
        """Let others have the signals; those of a program that is over (`for_good`) end it without a word."""
        if self.came is None or not for_good:  # else objects that were half made may complain as the program ends
            sys.unraisablehook = self._hook
        for number, before in self._before.items():
            signal.signal(number, signal.SIG_DFL if for_good else before)

    def _raise(self, number: int, frame: FrameType | None) -> None:
        now = monotonic()
        if now - self._raised_s < _AGAIN_S:
            return
        if self.came is None:
            self.came, self._came_s = number, now
        if is_brittle(frame) and now - self._came_s < _MOST_PATIENCE_S:
            send_again(number)
            return
        self._raised_s = now
        raise Interruption

    def _unraisable(self, lost: Any) -> None:
        """Send the signal again if its exception was lost in a finalizer or a callback from C.

        What else comes out of a finalizer after a signal, comes of it: an object was half made.
        """
        if self.came is None:
            self._hook(lost)
        if self.came is None or not isinstance(lost.exc_value, Interruption):
            return
        self._raised_s = float("-inf")
        send_again(self.came)


def _end(status: int) -> NoReturn:
    """End the process with `status`, and leave the interpreter as it is.

    What a signal has cut off leaves objects of C half made, of which some crash as Python takes them down.
    """
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):  # it is closed, or nobody reads it
            stream.flush()
    os._exit(status)


def interruptible(run: Callable[[], int], *, is_program: bool) -> int:
    """Return the exit status of `run`: its own, or 128 + the number of a signal that ended it (130 for Ctrl-C).

    Args:
        run: What to do. It may handle `KeyboardInterrupt` and return.
        is_program: The process has nothing else to do.
    """
    if threading.current_thread() is not threading.main_thread():  # signals are not for others
        return run()
    signals = _Signals()
    signals.take()
    try:
        return run()
    except BaseException as error:
        if signals.came is None and not isinstance(error, KeyboardInterrupt):
            raise
        # after a signal, whatever comes out comes of it: a kernel turns it into an error of its own
        number = signals.came or signal.SIGINT
        print(f"tagalong: {_WORDS[signal.Signals(number).name]}", file=sys.stderr)
        if is_program and signals.came is not None:
            _end(128 + number)
        return 128 + number
    finally:
        signals.give_back(for_good=is_program)
