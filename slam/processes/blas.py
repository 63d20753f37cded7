"""Small matrices are multiplied by one thread: a second one costs more than it helps, and may change the last bits."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@cache
def _libraries() -> ThreadpoolController:
    """Return the control of the linear algebra libraries that are loaded; looking for them takes milliseconds."""
    return ThreadpoolController().select(user_api="blas")


@contextmanager
def one_thread() -> Iterator[None]:
    """Let numpy and scipy multiply and factorize in the caller's thread, as long as this is entered.

    Matrices of an EKF have a hundred rows: with two threads that wait for each other an update took four times the
    processor's time, and twice the time by the clock.
    """
    with _libraries().limit(limits=1):
        yield
