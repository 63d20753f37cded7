"""What points are worth on a grid of occupancies, 64 places at once, summed in registers (see `lanes`)."""

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from ..search.lanes import LANES

SHARP = 1.7
"""Times the occupancy a point is worth, at most 1: a wall that most scans saw in a cell is worth a whole one."""
ROWS = 4  # of `LANES` sums each


@intrinsic
def set_sharp_sums(typingctx, sums, at, width, field, cols, edge, starts, count, offset):
    """In a kernel: write four rows of sixteen sums of windows of a field, each cell worth min(1, 1.7 field).

    `sums[at + r width : at + r width + 16]`, r = 0 .. 3, become the sums over all `starts[:count]` of the sixteen cells
    from field[start + offset + r cols] on; of a negative start, from edge[-1 - start + 16 r] on. float32 and int64
    arrays, without bounds checks.
    """

    def codegen(context, builder, signature, arguments):
        """Write the LLVM code of one call: add in a loop, all four rows of a window at a time, and store."""
        into, source, border, firsts = (
            context.make_array(signature.args[k])(context, builder, arguments[k]).data for k in (0, 3, 5, 6)
        )
        width, cols, offset = (arguments[k] for k in (2, 4, 8))
        vector = ir.VectorType(ir.FloatType(), LANES)
        one, sharp = (ir.Constant(vector, [value] * LANES) for value in (1.0, float(np.float32(SHARP))))
        totals = [cgutils.alloca_once_value(builder, ir.Constant(vector, [0.0] * LANES)) for _ in range(ROWS)]
        with cgutils.for_range(builder, arguments[7]) as loop:
            start = builder.load(builder.gep(firsts, [loop.index]))
            at_edge = builder.icmp_signed("<", start, ir.Constant(start.type, 0))
            base = builder.select(at_edge, border, source)
            stride = builder.select(at_edge, ir.Constant(cols.type, LANES), cols)
            first = builder.select(at_edge, builder.not_(start), builder.add(start, offset))
            for r, total in enumerate(totals):
                line = builder.mul(stride, ir.Constant(stride.type, r))
                place = builder.bitcast(builder.gep(base, [builder.add(first, line)]), vector.as_pointer())
                worth = builder.fmul(sharp, builder.load(place, align=4))
                worth = builder.select(builder.fcmp_ordered("<", worth, one), worth, one)
                builder.store(builder.fadd(builder.load(total), worth), total)
        for r, total in enumerate(totals):
            place = builder.add(arguments[1], builder.mul(width, ir.Constant(width.type, r)))
            target = builder.bitcast(builder.gep(into, [place]), vector.as_pointer())
            builder.store(builder.load(total), target, align=4)
        return context.get_dummy_value()

    arguments = (sums, types.intp, types.intp, field, types.intp, edge, starts, types.intp, types.intp)
    return types.void(*arguments), codegen
