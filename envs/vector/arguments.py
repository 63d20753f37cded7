"""What is asked of a vector environment, checked."""

from collections.abc import Sequence
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown


def each_seed(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return the seed of each of `count` environments: one for each, or those from one on.

    Raises:
        InputError: If it is neither.
    """
    if seed is None:
        return [None] * count
    if isinstance(seed, Integral):
        return [int(seed) + i for i in range(count)]
    if not isinstance(seed, Sequence | np.ndarray) or not all(one is None or _is_whole(one) for one in seed):
        raise InputError(f"`seed` must be None, a whole number, or one of these for each, got {shown(seed)}")
    seeds = [None if one is None else int(one) for one in seed]
    if len(seeds) != count:
        raise InputError(f"needs a seed for each of the {count} environments, got {len(seeds)}")
    return seeds


def chosen_by(reset_mask: Any, count: int, *, begun: bool) -> NDArray[np.bool_]:
    """Return (count,) which environments begin anew; None chooses all.

    Raises:
        InputError: If it is no such mask, chooses nobody, or leaves one out that has not `begun` yet.
    """
    mask = np.ones(count, dtype=bool) if reset_mask is None else np.asarray(reset_mask)
    if mask.shape != (count,) or mask.dtype != bool:
        raise InputError(f"`reset_mask` must be boolean of shape ({count},), got {mask.dtype} {mask.shape}")
    if not mask.any():
        raise InputError("`reset_mask` chooses nobody: at least one must be true")
    if not begun and not mask.all():
        raise InputError("`reset_mask` is for later: reset the environments as a whole at first")
    return mask


def _is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)
