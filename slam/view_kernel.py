"""The decorator of kernels that are handed many arrays and make none."""

from numba import njit

view_kernel = njit(cache=True, nogil=True, _nrt=False)
"""`numba.njit` for kernels that work on views of arrays that others own.

Numba counts the references to each array that a function is handed: for a function of a hundred arrays (a tuple of
them) that takes longer than its work, at every call. Such a kernel counts nothing; so it cannot make arrays, copies of
arrays among them, and the caller keeps alive what it hands over.
"""
