"""Decorators of kernels: compiled once on a machine, run without the interpreter's lock.

What numba makes for callers that a kernel does not have takes up to half of the time of compiling it.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def view_kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that work on views of arrays that others own.

    Numba counts the references to each array that a function is handed: for a function of a hundred arrays (a tuple of
    them) that takes longer than its work, at every call. Such a kernel counts nothing; so it can neither make arrays,
    copies of arrays among them, nor return any to a caller that counts, and the caller keeps alive what it hands over.
    """
    compiled: Any = njit(cache=True, nogil=True, _nrt=False, no_cfunc_wrapper=True)(function)  # pyright: ignore[reportCallIssue]
    return cast(Function, compiled)


def inner_view_kernel(function: Function) -> Function:
    """Return a `view_kernel` that only kernels call: what reads Python's objects for it would be half of its code."""
    bare: dict[str, Any] = {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    compiled: Any = njit(cache=True, nogil=True, **bare)(function)
    return cast(Function, compiled)


def spliced_kernel(function: Function) -> Function:
    """Return a kernel whose lines are put into the kernels that call it, as if they stood there."""
    compiled: Any = njit(inline="always")(function)
    return cast(Function, compiled)


def as_record(numbers: Any) -> Any:
    """Return a NamedTuple of floats as a record, which kernels hand on by its place in memory, not number by number."""
    return np.array([tuple(numbers)], dtype=[(name, np.float64) for name in numbers._fields])[0]


def kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that other code than C calls."""
    compiled: Any = njit(cache=True, nogil=True, no_cfunc_wrapper=True)(function)  # pyright: ignore[reportCallIssue]
    return cast(Function, compiled)


def inner_kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that only kernels call."""
    bare: dict[str, Any] = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    compiled: Any = njit(cache=True, nogil=True, **bare)(function)
    return cast(Function, compiled)
