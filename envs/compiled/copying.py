"""Rows of arrays copied number by number: kernels that count no references cannot assign arrays to arrays."""

from ...slam.view_kernel import inner_view_kernel
from .state import Array


@inner_view_kernel
def copy_row(source: Array, target: Array) -> None:
    """Copy `source` (k,) to the beginning of `target`."""
    for i in range(len(source)):
        target[i] = source[i]


@inner_view_kernel
def copy_rows(source: Array, target: Array) -> None:
    """Copy `source` (k, m) to the beginning of `target`."""
    for i in range(len(source)):
        for j in range(source.shape[1]):
            target[i, j] = source[i, j]
