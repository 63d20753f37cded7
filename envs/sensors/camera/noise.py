"""What a real camera of the Kinect V2's kind makes of the exact depth."""

import numpy as np
from numpy.typing import NDArray

from .config import RgbdConfig

Array = NDArray[np.float64]

STEEPEST = float(np.radians(85.0))
"""Surfaces seen at a larger angle from their normal give no return [rad]."""
_EDGE = 0.08
_FLYING = 0.5
_MOST_SIGMA = 0.05


def depth_sigma(depth: Array, incidence: Array) -> Array:
    """Return the standard deviation of measured depths [m].

    Fankhauser et al. 2015, "Kinect v2 for mobile robot navigation: evaluation and modeling", axial noise without
    sunlight: 1.5 - 0.5 z + 0.3 z^2 + 0.1 z^(3/2) theta^2 / (pi / 2 - theta)^2 millimetres. It is cut at 50 mm, since
    the last term has no bound.

    Args:
        depth: (...,) along the camera's axis [m].
        incidence: (...,) angle between the ray and the surface's normal, in [0, pi / 2) [rad].
    """
    theta = np.minimum(incidence, STEEPEST)
    grazing = 0.1 * depth**1.5 * theta**2 / (np.pi / 2.0 - theta) ** 2
    return np.minimum((1.5 - 0.5 * depth + 0.3 * depth**2 + grazing) / 1000.0, _MOST_SIGMA)


def on_edge(depth: Array) -> NDArray[np.bool_]:
    """Return (h, w) the pixels next to which the exact `depth` (h, w) [m] jumps by more than 8 % and 8 cm.

    A time-of-flight pixel there sees two surfaces at once. A surface seen at a grazing angle also runs away quickly;
    it counts when the next pixel is not where the one before it leads.
    """
    finite = np.where(np.isfinite(depth), depth, 1e3)
    return _jumps(finite) | _jumps(finite.T).T


def _jumps(depth: Array) -> NDArray[np.bool_]:
    """Return (h, w) the pixels before and behind a jump of `depth` along its rows."""
    step = np.diff(depth, axis=1)
    bend = np.abs(np.diff(step, axis=1))
    wide = np.full((len(depth), 1), np.inf)
    alone = np.minimum(np.concatenate((wide, bend), axis=1), np.concatenate((bend, wide), axis=1))
    near = np.minimum(depth[:, :-1], depth[:, 1:])
    jump = (np.abs(step) > _EDGE * np.maximum(near, 1.0)) & (alone > _EDGE)
    none = np.zeros((len(depth), 1), dtype=bool)
    return np.concatenate((none, jump), axis=1) | np.concatenate((jump, none), axis=1)


def measure_depth(exact: Array, incidence: Array, config: RgbdConfig, rng: np.random.Generator) -> NDArray[np.float32]:
    """Return (h, w) the measured depth [m], NaN where nothing is measured.

    At the edges of objects most pixels give nothing, since the camera's own software rejects them; of those that it
    keeps, half lie somewhere between both surfaces ("flying pixels"; Lachat et al. 2015 show them).

    Args:
        exact: (h, w) exact depth [m], `inf` where nothing is met.
        incidence: (h, w) angle between ray and normal [rad].
        config: The camera.
        rng: Source of all draws; their number depends on the picture's size alone.
    """
    normal, kept, flies, where, other = (draw(exact.shape) for draw in (rng.standard_normal, *[rng.random] * 4))
    finite = np.where(np.isfinite(exact), exact, 0.0)
    depth = finite + config.noise * depth_sigma(finite, incidence) * normal
    edge = on_edge(exact)
    between = edge & (flies < _FLYING) & (config.noise > 0.0)
    across = np.concatenate((finite[:, :1], finite[:, :-1]), axis=1)
    depth = np.where(between & (across > 0.0), finite + where * (across - finite), depth)
    lost = np.where(edge, kept < config.edge_missing, other < config.missing)
    lost |= ~np.isfinite(exact) | (incidence > STEEPEST)
    lost |= (depth < config.range_min) | (depth > config.range_max)
    return np.where(lost, np.nan, depth).astype(np.float32)
