"""Weights of particles: normalisation, effective number, resampling."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def normalised(log_weights: Array) -> Array:
    """Return the weights (P,) that sum to one of log weights (P,)."""
    weights = np.exp(log_weights - log_weights.max())
    return weights / weights.sum()


def effective_number(weights: Array) -> float:
    """Return the effective number of particles, 1 / sum w^2, of normalised weights (Grisetti 2007, eq. 20)."""
    return float(1.0 / np.sum(weights**2))


def systematic(weights: Array, offset: float) -> NDArray[np.intp]:
    """Return (P,) indices drawn by systematic resampling: index i is expected P w_i times, and never off by one.

    Args:
        weights: (P,) normalised weights.
        offset: Uniform draw in [0, 1).
    """
    marks = (np.arange(len(weights)) + offset) / len(weights)
    return np.minimum(np.searchsorted(np.cumsum(weights), marks, side="right"), len(weights) - 1)
