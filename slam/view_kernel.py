"""Decorators of kernels: compiled once on a machine, run without the interpreter's lock.

What numba makes for callers that a kernel does not have takes up to half of the time of compiling it.

Numba keeps a compiled kernel for as long as its own file stays what it was. But a kernel holds what it calls, and the
numbers of other modules, too: where those had changed, by an update, what ran was the old code. So here it is kept for
as long as all of that stays what it was (`_told_by`).
"""

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, TypeVar, cast

import numpy as np
from numba import njit

_FOREIGN = ("numpy", "numba", "math")
"""What numba has code of its own for, and a version number."""
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


def ieee_kernel(function: Function) -> Function:
    """Return a `kernel` in which a division by zero is infinite or NaN, as in numpy, and is not asked for."""
    return _cached(function, no_cfunc_wrapper=True, error_model="numpy")


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
        index._source_stamp = _stamp(function)
        try:
            return load()
        except (AttributeError, ImportError):
            return {}

    index._load_index = load_what_is_known
    return cast(Function, compiled)


@cache
def _stamp(function: Callable[..., Any]) -> str:
    """Return a number for all that a kernel is made of."""
    seen: dict[Any, None] = {}
    told = sorted({_shown(part) for part in _told_by(function, seen)})
    return hashlib.sha256("\n".join(told).encode()).hexdigest()


def _told_by(function: Callable[..., Any], seen: dict[Any, None]) -> Iterator[Any]:
    """Yield the file of a function, what it names in its module and in others, and the same of what it calls."""
    if function in seen:
        return
    seen[function] = None
    yield Path(function.__code__.co_filename)
    for named in _named_by(function.__code__, function.__globals__):
        inner = getattr(named, "py_func", getattr(named, "_defn", named))  # of a kernel; of an intrinsic
        if hasattr(inner, "__code__") and inner.__module__.partition(".")[0] not in _FOREIGN:
            yield from _told_by(inner, seen)
        else:
            yield named


def _named_by(code: CodeType, known: dict[str, Any]) -> Iterator[Any]:
    """Yield what the names of `code`, and of the functions in it, stand for; of modules, what is named of them."""
    for name in code.co_names:
        named = known.get(name)
        if isinstance(named, ModuleType):
            yield from (getattr(named, other, None) for other in code.co_names)
        else:
            yield named
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _named_by(constant, known)


def _shown(part: Any) -> str:
    """Return a file by its content, a number, text, array or table of such by its value, all else by its name."""
    if isinstance(part, Path):
        return hashlib.sha256(_content(part)).hexdigest()
    if isinstance(part, np.ndarray):
        return f"{part.dtype} {part.shape} {hashlib.sha256(part.tobytes()).hexdigest()}"
    if isinstance(part, tuple):
        return f"({', '.join(_shown(one) for one in part)})"
    if isinstance(part, (int, float, str, np.generic, np.dtype)):
        return repr(part)
    return getattr(part, "__qualname__", type(part).__qualname__)


@cache
def _content(file: Path) -> bytes:
    return file.read_bytes() if file.is_file() else b""
