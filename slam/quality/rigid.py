"""The rigid motion of the plane that best carries one set of points onto another, pair by pair."""

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError

Array = NDArray[np.float64]


def fit_rigid(source: Array, target: Array, weights: Array | None = None) -> Array:
    """Return T_target_source (3,), which minimises the sum of w |T p - q|^2; a proper rotation, no scale, no mirroring.

    The plane's closed form of Arun, Huang, Blostein 1987.

    Args:
        source: (n, 2) points p.
        target: (n, 2) points q; q[i] belongs to p[i].
        weights: (n,) weights w >= 0, one each if omitted.

    Raises:
        InputError: If the shapes differ or there are no pairs.
    """
    if source.shape != target.shape or source.ndim != 2 or len(source) == 0:
        raise InputError(f"a rigid fit needs pairs (n, 2) and (n, 2), n > 0, got {source.shape} and {target.shape}")
    w = np.ones(len(source)) if weights is None else weights
    centre_p, centre_q = w @ source / w.sum(), w @ target / w.sum()
    p, q = source - centre_p, target - centre_q
    sine = w @ (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    cosine = w @ (p[:, 0] * q[:, 0] + p[:, 1] * q[:, 1])
    theta = np.arctan2(sine, cosine)
    cos, sin = np.cos(theta), np.sin(theta)
    x, y = centre_q - np.array((cos * centre_p[0] - sin * centre_p[1], sin * centre_p[0] + cos * centre_p[1]))
    return np.array((x, y, theta if theta < np.pi else -np.pi))
