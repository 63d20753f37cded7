"""Where a signal must not raise an exception, which would break more than what runs: it is sent again a bit later."""

import os
import threading
from types import FrameType

_CODE = (
    "<frozen importlib._bootstrap>",  # a module of C crashes whose initialisation is cut off
    os.path.join("numba", "core", "serialize.py"),  # a kernel crashes that asks for the class of a named tuple
    os.path.join("llvmlite", "binding", ""),  # its lock is kept for good, or a callback from C loses the exception
    os.path.join("multiprocessing", "popen_spawn_posix.py"),  # a worker that is half started ends in a traceback
)
_AGAIN_S = 0.05


def is_brittle(frame: FrameType | None) -> bool:
    """Return whether an exception that is raised in `frame` would break more than what runs there."""
    while frame is not None:
        if any(code in frame.f_code.co_filename for code in _CODE):
            return True
        frame = frame.f_back
    return False


def send_again(number: int) -> None:
    """Send signal `number` to this process in a twentieth of a second."""
    again = threading.Timer(_AGAIN_S, os.kill, (os.getpid(), number))
    again.daemon = True
    again.start()
