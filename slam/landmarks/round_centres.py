"""Where the centre of a round object is whose front a laser has met.

The mean of the visible points is not the centre, nor a fixed distance before it: which chords the beams cut depends on
the distance, and with beams a degree apart a post 6 m away is met by two of them, anywhere on it. What the sweep says
is more than a mean. Beams that hit bound the centre's bearing, so do the ones beside them that missed, and the arc of
the ranges tells where between the bounds it is. The posterior of that is integrated by Gauss-Legendre quadrature:
unbiased, with the covariance that errors really have (tests compare); from sweep to sweep they are independent.

Legend: D, beta distance and bearing of the centre from the laser; d the bearing of a beam against beta.
"""

import numpy as np
from numpy.typing import NDArray

from .centres_kernel import posterior_of_centres

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(9)
_LEAST = 0.05
"""Least half width of what the bearing may be, in spacings of the beams: the radius and the ranges are not exact."""


def round_centres(
    ranges: Array, bearings: Array, label: NDArray[np.int64], spacing: float, radius: float, sigma: float
) -> tuple[Array, Array]:
    """Return distance and bearing (m, 2) of the centres of m round objects and their covariances (m, 2, 2).

    Args:
        ranges: (k,) of the returns [m].
        bearings: (k,) of the same [rad].
        label: (k,) the object of each, 0 to m - 1, every one with a return at least. Beams beside an object missed it.
        spacing: Angle between neighbouring beams [rad].
        radius: Of the objects [m].
        sigma: Standard deviation of a range [m].
    """
    count = int(label.max()) + 1
    polar, covariance = np.empty((count, 2)), np.empty((count, 2, 2))
    posterior_of_centres(
        ranges, bearings, label, count, spacing, radius, sigma, _LEAST, _NODES, _WEIGHTS, polar, covariance
    )
    return polar, covariance
