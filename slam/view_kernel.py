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
    return _cached(function, _nrt=False, no_cfunc_wrapper=True)


def inner_view_kernel(function: Function) -> Function:
    """Return a `view_kernel` that only kernels call: what reads Python's objects for it would be half of its code."""
    bare: dict[str, Any] = {"_nrt": False, "no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    return _cached(function, **bare)


def spliced_kernel(function: Function) -> Function:
    """Return a kernel whose lines are put into the kernels that call it, as if they stood there."""
    compiled: Any = njit(inline="always")(function)
    return cast(Function, compiled)


def as_record(numbers: Any) -> Any:
    """Return a NamedTuple of floats as a record, which kernels hand on by its place in memory, not number by number."""
    return np.array([tuple(numbers)], dtype=[(name, np.float64) for name in numbers._fields])[0]


def kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that other code than C calls."""
    return _cached(function, no_cfunc_wrapper=True)


def inner_kernel(function: Function) -> Function:
    """Return a function compiled as by `numba.njit`, for kernels that only kernels call."""
    bare: dict[str, Any] = {"no_cfunc_wrapper": True, "no_cpython_wrapper": True}
    return _cached(function, **bare)


def _cached(function: Function, **options: Any) -> Function:
    """Return a function compiled without the interpreter's lock, kept on the disk for the next time.

    What an older version of this package has left there may name types that are gone, at which numba stops; here it is
    compiled anew.
    """
    compiled: Any = njit(cache=True, nogil=True, **options)(function)
    if not hasattr(compiled, "_cache"):  # numba was told not to compile
        return cast(Function, compiled)
    index: Any = compiled._cache._cache_file
    load = index._load_index

    def load_what_is_known() -> dict[Any, Any]:
        try:
            return load()
        except (AttributeError, ImportError):
            return {}

    index._load_index = load_what_is_known
    return cast(Function, compiled)
