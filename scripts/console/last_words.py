"""How a command ends: with an exit status, and with one line where something was wrong with what it was given."""

import errno
import os
import select
import sys
from collections.abc import Callable
from contextlib import suppress

from ...slam.errors import InputError, MissingExtraError, WorkerError, one_line
from .interruption import interruptible

MOST_SAID = 500
"""Characters of the line: readers shorten what they show, and this holds for all that they did not write."""
BAD_INPUT, LOST_WORKER, BROKEN_PIPE = 2, 3, 141


def told(run: Callable[[], int], *, is_program: bool = True) -> int:
    """Return the exit status of `run`; what went wrong is told in one line.

    0 fine, 1 a stated bound was missed, 2 bad input, 3 a worker process was lost, 128 + n ended by signal n (130 by
    Ctrl-C, 143 by SIGTERM).

    Args:
        run: What to do.
        is_program: The process has nothing else to do.
    """
    # outermost: after a signal, an error of any kind comes of it, such as that a library is not there
    try:
        return exit_status(lambda: interruptible(run, is_program=is_program))
    except WorkerError as error:
        print(f"tagalong: {one_line(str(error), MOST_SAID)}", file=sys.stderr)
        return LOST_WORKER


def exit_status(run: Callable[[], int]) -> int:
    """Return the exit status of `run`; what went wrong outside of this program is told in one line, with status 2.

    Outside are: what the user gave (`InputError`), what is not installed, what the operating system refuses (a disk
    that is full, also under stdout), and memory. A pipe that nobody reads any more (`tagalong ... | head -1`) ends the
    command without a word, with the status that a shell gives for it (141). Other errors are the program's own: they
    come out as they are.

    Args:
        run: What to do. What it printed is written out when it is over, so that a failure of that is told, too.
    """
    try:
        try:
            return run()
        finally:
            if sys.stdout is not None:  # None: the caller closed it
                sys.stdout.flush()
    except BrokenPipeError as error:
        if not _reader_is_gone():  # it was another pipe
            return _failed(_of_system(error))
        _drop_output()
        return BROKEN_PIPE
    except (InputError, MissingExtraError) as error:
        return _failed(str(error))
    except OSError as error:
        return _failed(_of_system(error))
    except MemoryError as error:
        return _failed(f"there is not enough memory for this ({error or 'no more is to be had'})")
    except RecursionError:
        return _failed("something in what was given is nested too deeply")
    except OverflowError as error:
        return _failed(f"a number in what was given is too large ({error})")


def _failed(message: str) -> int:
    _drop_output()
    # a stderr that cannot be written to must not end in more words on it
    with suppress(OSError):
        print(f"tagalong: {one_line(' '.join(message.split()), MOST_SAID)}", file=sys.stderr or None, flush=True)
    return BAD_INPUT


def _of_system(error: OSError) -> str:
    what = error.strerror or str(error) or type(error).__name__
    if error.filename is None:
        return f"cannot be written ({what})" if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) else what
    return f"{os.fsdecode(error.filename)}: {what}"


def _reader_is_gone() -> bool:
    """Return whether stdout is a pipe that nobody reads any more."""
    try:
        poll = select.poll()
        poll.register(sys.stdout.fileno(), select.POLLOUT)
    except (AttributeError, OSError):  # it is closed, or no file of the system's
        return False
    return any(event & select.POLLERR for _, event in poll.poll(0))


def _drop_output() -> None:
    """Throw away what stdout does not take, so that the interpreter does not try again, and complain, at its exit."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        with suppress(AttributeError, OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # pyright: ignore[reportOptionalMemberAccess]
