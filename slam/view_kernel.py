"""The decorator of kernels that are handed many arrays and make none."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def view_kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that work on views of arrays that others own.

    Numba counts the references to each array that a function is handed: for a function of a hundred arrays (a tuple of
    them) that takes longer than its work, at every call. Such a kernel counts nothing; so it can neither make arrays,
    copies of arrays among them, nor return any to a caller that counts, and the caller keeps alive what it hands over.
    """
    compiled: Any = njit(cache=True, nogil=True, _nrt=False)(function)  # pyright: ignore[reportCallIssue]
    return cast(Function, compiled)
