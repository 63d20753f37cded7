"""Whether poses are as far off as their covariances say (Bailey, Nieto, Guivant, Stevens, Nebot 2006)."""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from ..geometry import compose, inverse, wrap_angle

Array = NDArray[np.float64]

_FINEST = 1e-5  # [m, rad] nothing is known better than this

RARELY = 0.01
"""Share of the poses that lie beyond where their covariances are right."""


def squared_distances(poses: Array, covariances: Array, truth: Array) -> Array:
    """Return (n,) the squared error of each pose by its covariance (NEES), seen from where the first pose was.

    Args:
        poses: (n, 3) as they were believed when they were new [m, m, rad].
        covariances: (n, 3, 3) of them, in the frame of `poses`.
        truth: (n, 3) in a frame of its own.
    """
    if not len(poses):
        return np.zeros(0)
    error = poses - compose(compose(poses[0], inverse(truth[0])), truth)
    error[:, 2] = wrap_angle(error[:, 2])
    known = covariances + _FINEST**2 * np.eye(3)
    return np.einsum("na,na->n", error, np.linalg.solve(known, error[..., None])[..., 0])


def beyond(distances: Array) -> float:
    """Return the share of squared distances (n,) that one in a hundred exceeds where covariances are right."""
    return float(np.mean(distances > chi2.isf(RARELY, df=3))) if len(distances) else 0.0
