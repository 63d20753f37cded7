"""A joystick of keys: the terminal's keyboard moves the stick one notch at a time."""

import os
import select
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from .operator_model import OperatorConfig, OperatorView

HELP = "arrows or w a s d: move the stick a notch; space: let go; q or Ctrl-C: end"
_KEYS = {
    "w": (1, 0),
    "s": (-1, 0),
    "a": (0, 1),
    "d": (0, -1),
    "\x1b[A": (1, 0),
    "\x1b[B": (-1, 0),
    "\x1b[D": (0, 1),
    "\x1b[C": (0, -1),
}


class KeyboardStick:
    """Stays where the keys moved it.

    Args:
        keys: Returns what was typed since the last call.
        step_s: Real time of a step [s]; 0 does not wait.
        config: Notches, and speeds at full stick.
    """

    def __init__(self, keys: Callable[[], str], step_s: float, config: OperatorConfig | None = None) -> None:
        self._keys, self._step_s, self._config = keys, step_s, config or OperatorConfig()
        self._notch = np.zeros(2)
        self._next_s = time.monotonic()

    def act(self, sight: OperatorView) -> NDArray[np.float64]:
        """Return (2,) forward speed [m/s] and turn rate [rad/s].

        Raises:
            EOFError: When q was typed.
        """
        self._wait()
        typed = self._keys()
        while typed:
            key = next((k for k in _KEYS if typed.startswith(k)), typed[0])
            typed = typed[len(key) :]
            if key == "q":
                raise EOFError
            self._notch = np.zeros(2) if key == " " else self._notch + _KEYS.get(key, (0, 0))
        levels = self._config.levels
        self._notch = np.clip(self._notch, -levels, levels)
        return self._notch / levels * (self._config.full_speed, self._config.full_turn)

    def _wait(self) -> None:
        self._next_s = max(self._next_s + self._step_s, time.monotonic() - self._step_s)
        time.sleep(max(0.0, self._next_s - time.monotonic()))


@contextmanager
def terminal_keys() -> Iterator[Callable[[], str]]:
    """Give a function that returns what was typed since its last call, without waiting for the return key.

    Raises:
        InputError: If the input is no terminal, or one that cannot be read key by key.
    """
    if not sys.stdin.isatty():
        raise InputError("the keyboard needs a terminal; --operator model needs none")
    try:
        import termios
        import tty
    except ImportError:
        raise InputError("the keyboard is read on Linux and macOS; --operator model needs none") from None

    number = sys.stdin.fileno()
    before = termios.tcgetattr(number)
    try:
        tty.setcbreak(number)
        yield lambda: _typed(number)
    finally:
        termios.tcsetattr(number, termios.TCSADRAIN, before)


def _typed(number: int) -> str:
    text = b""
    while select.select([number], [], [], 0.0)[0]:
        piece = os.read(number, 64)
        if not piece:
            return "q"
        text += piece
    return text.decode("utf-8", errors="ignore")
