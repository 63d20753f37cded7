"""Random numbers inside compiled calls: one 64-bit state a world, so that a world draws the same beside any others.

SplitMix64 (Steele, Lea, Flood 2014) and the ziggurat of Marsaglia and Tsang 2000 with 256 layers.
"""

import math

import numpy as np
from numpy.typing import NDArray

from .view_kernel import inner_view_kernel

Array = NDArray[np.float64]
Words = NDArray[np.uint64]

_STEP, _MIX1, _MIX2 = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11, _S8 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11), np.uint64(8)
_LAYERS = 256
_LAYER_MASK = np.uint64(_LAYERS - 1)
_TAIL = 3.6541528853610088  # where the lowest layer ends, for 256 layers


def _ziggurat() -> tuple[Array, Array]:
    """Return (257,) widths of the layers and (257,) heights of the density at them."""
    area = _TAIL * np.exp(-0.5 * _TAIL**2) + float(np.sqrt(np.pi / 2.0)) * _upper_tail(_TAIL)
    x = np.zeros(_LAYERS + 1)
    x[0], x[1] = area / np.exp(-0.5 * _TAIL**2), _TAIL
    for k in range(2, _LAYERS):
        x[k] = np.sqrt(-2.0 * np.log(area / x[k - 1] + np.exp(-0.5 * x[k - 1] ** 2)))
    return x, np.exp(-0.5 * x**2)


def _upper_tail(x: float) -> float:
    """Return the share of a normal distribution that is farther from 0 than `x`."""
    return math.erfc(x / math.sqrt(2.0))


_WIDTH, _HEIGHT = _ziggurat()


@inner_view_kernel
def mixed(word: np.uint64) -> np.uint64:
    """Return a word in which each bit of `word` counts everywhere."""
    z = np.uint64(word)
    z = (z ^ (z >> _S30)) * _MIX1
    z = (z ^ (z >> _S27)) * _MIX2
    return z ^ (z >> _S31)


@inner_view_kernel
def word(state: Words) -> np.uint64:
    """Return 64 random bits and advance `state` (1,)."""
    state[0] += _STEP
    return mixed(state[0])


@inner_view_kernel
def uniform(state: Words) -> float:
    """Return a number in (0, 1]."""
    return ((word(state) >> _S11) + np.float64(1.0)) * (1.0 / 9007199254740992.0)


@inner_view_kernel
def normal(state: Words) -> float:
    """Return a standard normal number."""
    while True:
        bits = word(state)
        layer = int(bits & _LAYER_MASK)
        share = np.float64(np.int64(bits) >> np.int64(11)) * (1.0 / 4503599627370496.0)  # in [-1, 1)
        x = share * _WIDTH[layer]
        if abs(x) < _WIDTH[layer + 1]:
            return x
        if layer == 0:
            while True:
                beyond = -math.log(uniform(state)) / _TAIL
                if -2.0 * math.log(uniform(state)) > beyond * beyond:
                    return _TAIL + beyond if share > 0.0 else -_TAIL - beyond
        low, high = _HEIGHT[layer], _HEIGHT[layer + 1]
        if low + uniform(state) * (high - low) < math.exp(-0.5 * x * x):
            return x


@inner_view_kernel
def until_failure(state: Words, share: float) -> int:
    """Return how many trials go well until one fails, of which a `share` does; a large number if none does."""
    if share <= 0.0:
        return 1 << 40
    return int(min(math.log(uniform(state)) / math.log(1.0 - share), 1e12))
