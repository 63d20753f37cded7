"""A gamepad by Linux's joystick interface (`/dev/input/js0`); needs no library and no display.

Events are those of the kernel's `linux/joystick.h`, 8 bytes each: time [ms], value, kind (1 button, 2 axis, +128 for
the state at opening), number.
"""

import os
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from errno import EISDIR
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from .operator_model import OperatorConfig, OperatorView

HELP = "left stick: drive and turn; back, start or Ctrl-C: end"
EVENT = struct.Struct("IhBB")
BUTTON, AXIS, AT_OPENING = 1, 2, 128
SIDEWAYS, UPRIGHT = 0, 1
"""Axes of the left stick: right and down are positive."""
END_BUTTONS = (6, 7)
"""Back and start of the common pads."""
FULL = 32767
DEAD = 0.08
"""Share of the way around the middle that counts as the middle: sticks do not come back exactly."""


class GamepadStick:
    """Turns the events of a gamepad into the position of a stick.

    Args:
        events: Returns the bytes that came since the last call, whole events.
        step_s: Real time of a step [s]; 0 does not wait.
        config: Speeds at full stick.
    """

    def __init__(self, events: Callable[[], bytes], step_s: float, config: OperatorConfig | None = None) -> None:
        self._events, self._step_s, self._config = events, step_s, config or OperatorConfig()
        self._axes = {SIDEWAYS: 0.0, UPRIGHT: 0.0}
        self._next_s = time.monotonic()

    def act(self, sight: OperatorView) -> NDArray[np.float64]:
        """Return (2,) forward speed [m/s] and turn rate [rad/s].

        Raises:
            EOFError: When back or start was pressed, or the gamepad is gone.
        """
        self._next_s = max(self._next_s + self._step_s, time.monotonic() - self._step_s)
        time.sleep(max(0.0, self._next_s - time.monotonic()))
        for _, value, kind, number in EVENT.iter_unpack(self._events()):
            if kind == BUTTON and value and number in END_BUTTONS:
                raise EOFError
            if kind & ~AT_OPENING == AXIS and number in self._axes:
                self._axes[number] = value / FULL
        stick = np.array([-self._axes[UPRIGHT], -self._axes[SIDEWAYS]])
        stick = np.sign(stick) * np.clip((np.abs(stick) - DEAD) / (1.0 - DEAD), 0.0, 1.0)
        return stick * (self._config.full_speed, self._config.full_turn)


@contextmanager
def gamepad_events(device: str | os.PathLike[str] = "/dev/input/js0") -> Iterator[Callable[[], bytes]]:
    """Give a function that returns the events since its last call, without waiting.

    Raises:
        InputError: If there is no such gamepad, or it may not be read.
    """
    try:
        number = os.open(Path(device), os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
        if Path(device).is_dir():
            os.close(number)
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
    except OSError as error:
        raise InputError(
            f"no gamepad at {device} ({error.strerror}); --operator keyboard or model need none"
        ) from error
    try:
        yield lambda: _waiting(number)
    finally:
        os.close(number)


def _waiting(number: int) -> bytes:
    """Return what waits at an open device.

    Raises:
        EOFError: When it was unplugged.
    """
    found = b""
    while True:
        try:
            piece = os.read(number, 64 * EVENT.size)
        except BlockingIOError:
            return found
        except OSError as error:
            raise EOFError from error
        if not piece:
            if found:
                return found
            raise EOFError
        found += piece
