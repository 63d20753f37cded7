"""Sparse normal equations of a pose graph: their pattern is found once, numba fills in the numbers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ..view_kernel import kernel, spliced_kernel

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SparsityPattern:
    """Where the 3 x 3 blocks of the symmetric matrix H lie in compressed columns.

    Attributes:
        place: (n,) the block row of each pose, in an order that keeps the factors sparse.
        indptr: (3n + 1,) of the scalar matrix.
        indices: (nnz,) of the scalar matrix.
        base: (b,) position in the data of the first entry of each block.
        stride: (b,) from one column of a block to the next.
        edge_blocks: (m, 4) the blocks (i, i), (j, j), (i, j), (j, i) of each edge.
        diagonal: (3n,) positions of the scalar diagonal, by block row.
    """

    place: Indices
    indptr: NDArray[np.int32]
    indices: NDArray[np.int32]
    base: Indices
    stride: Indices
    edge_blocks: Indices
    diagonal: Indices


def fill_reducing_order(n: int, edges: Indices) -> Indices:
    """Return (n,) the place of each pose in an order of minimum degree on A + A^T."""
    i, j = edges.T
    ones = np.ones(len(edges))
    links = sparse.coo_matrix((ones, (i, j)), shape=(n, n))
    links = (links + links.T + sparse.identity(n) * (2.0 * len(edges) + 1.0)).tocsc()
    options = {"SymmetricMode": True}
    return np.asarray(splu(links, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).perm_c, np.int64)


def block_pattern(n: int, edges: Indices) -> SparsityPattern:
    """Return the pattern of H for `n` poses and `edges` (m, 2)."""
    place = fill_reducing_order(n, edges)
    i, j = place[edges].T
    every = np.arange(n)
    rows, cols = np.concatenate((every, i, j)), np.concatenate((every, j, i))
    keys, inverse = np.unique(cols * n + rows, return_inverse=True)
    block_cols, block_rows = keys // n, keys % n
    counts = np.bincount(block_cols, minlength=n)
    starts = np.concatenate(([0], np.cumsum(counts)))
    rank = np.arange(len(keys)) - starts[block_cols]
    stride = 3 * counts[block_cols]
    base = 9 * starts[block_cols] + 3 * rank
    indices = np.empty(9 * len(keys), np.int32)
    for p in range(3):
        for q in range(3):
            indices[base + q * stride + p] = 3 * block_rows + p
    indptr = np.concatenate(([0], np.cumsum(np.repeat(3 * counts, 3)))).astype(np.int32)
    m = len(edges)
    upper, lower = inverse[n : n + m], inverse[n + m :]
    diagonal_block = inverse[:n]
    edge_blocks = np.stack((diagonal_block[i], diagonal_block[j], upper, lower), axis=-1).astype(np.int64)
    steps = np.arange(3)
    diagonal = (base[diagonal_block][:, None] + steps * (stride[diagonal_block][:, None] + 1)).ravel()
    return SparsityPattern(place, indptr, indices, base, stride, edge_blocks, diagonal)


@kernel
def fill(
    poses: Array,
    edges: Indices,
    measurements: Array,
    information: Array,
    kernel_width: Array,
    fixed: int,
    place: Indices,
    base: Indices,
    stride: Indices,
    edge_blocks: Indices,
    data: Array,
    gradient: Array,
) -> float:
    """Write H into `data` and the gradient into `gradient` (3n,), by block row; return the robust cost.

    The cost of an edge with squared Mahalanobis distance s is c^2 log(1 + s / c^2), c its kernel width (s for
    infinite c), half of which is summed up. Steps are
    taken in the frame of each pose, which keeps stiff edges stiff when they turn. The `fixed` pose moves nothing.
    """
    data[:] = 0.0
    gradient[:] = 0.0
    total = 0.0
    A, B = np.empty((3, 3)), np.empty((3, 3))
    OA, OB = np.empty((3, 3)), np.empty((3, 3))
    e, Oe = np.empty(3), np.empty(3)
    for k in range(len(edges)):
        i, j = edges[k, 0], edges[k, 1]
        _edge(poses[i], poses[j], measurements[k], e, A, B)
        s = 0.0
        for p in range(3):
            Oe[p] = information[k, p, 0] * e[0] + information[k, p, 1] * e[1] + information[k, p, 2] * e[2]
            s += e[p] * Oe[p]
        c2 = kernel_width[k] * kernel_width[k]
        weight = 1.0 / (1.0 + s / c2)
        total += 0.5 * (s if np.isinf(c2) else c2 * np.log1p(s / c2))
        if i == fixed:
            A[:] = 0.0
        if j == fixed:
            B[:] = 0.0
        _times(information[k], A, weight, OA)
        _times(information[k], B, weight, OB)
        for q in range(3):
            gradient[3 * place[i] + q] += weight * (A[0, q] * Oe[0] + A[1, q] * Oe[1] + A[2, q] * Oe[2])
            gradient[3 * place[j] + q] += weight * (B[0, q] * Oe[0] + B[1, q] * Oe[1] + B[2, q] * Oe[2])
        _add(data, base, stride, edge_blocks[k, 0], A, OA)
        _add(data, base, stride, edge_blocks[k, 1], B, OB)
        _add(data, base, stride, edge_blocks[k, 2], A, OB)
        _add(data, base, stride, edge_blocks[k, 3], B, OA)
    return total


@spliced_kernel
def _edge(a: Array, b: Array, z: Array, e: Array, A: Array, B: Array) -> None:
    """Write the error z^-1 a^-1 b of an edge and its derivatives by steps in the frames of the poses a and b."""
    c, s = np.cos(a[2] + z[2]), np.sin(a[2] + z[2])
    cz, sz = np.cos(z[2]), np.sin(z[2])
    dx, dy = b[0] - a[0], b[1] - a[1]
    x, y = c * dx + s * dy, -s * dx + c * dy
    e[0] = x - cz * z[0] - sz * z[1]
    e[1] = y + sz * z[0] - cz * z[1]
    turn = b[2] - a[2] - z[2]
    e[2] = turn - 2.0 * np.pi * np.floor((turn + np.pi) / (2.0 * np.pi))
    A[0, 0], A[0, 1], A[0, 2] = -cz, -sz, y
    A[1, 0], A[1, 1], A[1, 2] = sz, -cz, -x
    A[2, 0], A[2, 1], A[2, 2] = 0.0, 0.0, -1.0
    cb, sb = np.cos(turn), np.sin(turn)
    B[0, 0], B[0, 1], B[0, 2] = cb, -sb, 0.0
    B[1, 0], B[1, 1], B[1, 2] = sb, cb, 0.0
    B[2, 0], B[2, 1], B[2, 2] = 0.0, 0.0, 1.0


@spliced_kernel
def _times(left: Array, right: Array, weight: float, product: Array) -> None:
    """Write weight * left right into `product` (3, 3)."""
    for p in range(3):
        for q in range(3):
            product[p, q] = weight * (left[p, 0] * right[0, q] + left[p, 1] * right[1, q] + left[p, 2] * right[2, q])


@spliced_kernel
def _add(data: Array, base: Indices, stride: Indices, block: int, left: Array, right: Array) -> None:
    """Add left^T right to a block."""
    for q in range(3):
        at = base[block] + q * stride[block]
        for p in range(3):
            data[at + p] += left[0, p] * right[0, q] + left[1, p] * right[1, q] + left[2, p] * right[2, q]
