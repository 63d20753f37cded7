"""Sixteen sums at once: the compiler does not find this addition by itself, since the arrays might overlap."""

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

LANES = 16  # sums in one addition


@intrinsic
def add_lanes(typingctx, sums, at, values, start):
    """In a kernel: `sums[at : at + 16] += values[start : start + 16]`, uint16 and uint8, without bounds checks.

    `add_lanes_reference` is the same in numpy.
    """

    def codegen(context, builder, signature, arguments):
        into = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        source = context.make_array(signature.args[2])(context, builder, arguments[2]).data
        narrow, wide = ir.VectorType(ir.IntType(8), LANES), ir.VectorType(ir.IntType(16), LANES)
        target = builder.bitcast(builder.gep(into, [arguments[1]]), wide.as_pointer())
        added = builder.load(builder.bitcast(builder.gep(source, [arguments[3]]), narrow.as_pointer()), align=1)
        total = builder.add(builder.load(target, align=2), builder.zext(added, wide))
        builder.store(total, target, align=2)
        return context.get_dummy_value()

    return types.void(sums, types.intp, values, types.intp), codegen


def add_lanes_reference(sums: NDArray[np.uint16], at: int, values: NDArray[np.uint8], start: int) -> None:
    """Do what `add_lanes` does."""
    sums[at : at + LANES] += values[start : start + LANES]
