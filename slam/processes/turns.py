"""Work that threads share inside a kernel: each takes slice after slice without going back to the interpreter.

To hand a kernel over takes some ten microseconds, with the interpreter's lock, for it reads all that it is given: too
long for slices as short as even shares need. Here every thread calls the kernel once.
"""

from typing import NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from ..view_kernel import inner_view_kernel
from .threads import slices


class Turns(NamedTuple):
    """Slices of the pieces of some work, each of which one thread takes.

    Attributes:
        taken: (1,) how many are taken.
        bounds: (k + 1,) where each of k slices begins, and the last one ends.
    """

    taken: NDArray[np.int64]
    bounds: NDArray[np.int64]


def turns(count: int, threads: int = 1) -> Turns:
    """Return turns for `threads` at all of `count` pieces of work; see `slices`."""
    parts = slices(count, threads) if threads > 1 else [(0, count)]
    return Turns(np.zeros(1, np.int64), np.array([0, *(stop for _, stop in parts)], np.int64))


@intrinsic
def _added(typingctx, values):
    """In a kernel: add one to `values[0]`; return what it was. No other thread gets the same."""

    def codegen(context, builder, signature, arguments):
        """Write the LLVM code of one call. The order of other reads and writes is nobody's matter: slices are apart."""
        place = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.atomic_rmw("add", place, ir.Constant(ir.IntType(64), 1), "monotonic")

    return types.int64(values), codegen


@inner_view_kernel
def next_slice(turns: Turns) -> tuple[int, int]:
    """Take the next slice (first, end); an empty one if all are taken."""
    turn = _added(turns.taken)  # pyright: ignore[reportCallIssue]
    if turn >= len(turns.bounds) - 1:
        return 0, 0
    return turns.bounds[turn], turns.bounds[turn + 1]
