"""Sixteen sums at once, kept in a register: the compiler does not find this by itself, the arrays might overlap."""

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 16  # sums in one addition


@intrinsic
def add_lanes(typingctx, sums, at, values, starts, count, offset):
    """In a kernel: `sums[at : at + 16] += values[s + offset : s + offset + 16]` for s in `starts[:count]`.

    uint16, uint8 and int64 arrays, without bounds checks.
    """

    def codegen(context, builder, signature, arguments):
        """Write the LLVM code of one call: load the sums, add in a loop, store them."""
        into, source, firsts = (
            context.make_array(signature.args[k])(context, builder, arguments[k]).data for k in (0, 2, 3)
        )
        narrow, wide = ir.VectorType(ir.IntType(8), LANES), ir.VectorType(ir.IntType(16), LANES)
        target = builder.bitcast(builder.gep(into, [arguments[1]]), wide.as_pointer())
        total = cgutils.alloca_once_value(builder, builder.load(target, align=2))
        with cgutils.for_range(builder, arguments[4]) as loop:
            start = builder.add(builder.load(builder.gep(firsts, [loop.index])), arguments[5])
            added = builder.load(builder.bitcast(builder.gep(source, [start]), narrow.as_pointer()), align=1)
            builder.store(builder.add(builder.load(total), builder.zext(added, wide)), total)
        builder.store(builder.load(total), target, align=2)
        return context.get_dummy_value()

    return types.void(sums, types.intp, values, starts, types.intp, types.intp), codegen
