"""What is asked of a vector environment, checked."""

from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from ...slam.errors import InputError, shown

_COUNTS = {"num_envs": False, "workers": True, "max_episode_steps": True, "episodes_ahead": False}
"""Arguments that count something -> whether they may be None."""
_MOST = 2**31 - 1
_SEEDS = ("episodes_seed",)


def checked_arguments(num_envs: Any, arguments: Mapping[str, Any]) -> tuple[int, dict[str, Any]]:
    """Return the arguments of a vector environment, each of the one kind that its code takes.

    A whole number of another library, or a truth, would be another type to a compiled kernel, and compile it anew.

    Args:
        num_envs: How many environments.
        arguments: The others; those of the environments themselves are left as they are.

    Raises:
        InputError: If a count is no whole number of at least 1, a seed none of at least 0, or a mode is unknown.
    """
    checked: dict[str, Any] = {"num_envs": num_envs, **arguments}
    for name in [*_COUNTS, *_SEEDS]:
        if name not in checked:
            continue
        value, least = checked[name], 0 if name in _SEEDS else 1
        if value is None and _COUNTS.get(name, False):
            continue
        if value is None or not _is_whole(value) or not least <= value <= _MOST:
            raise InputError(f"`{name}` must be a whole number within {least} .. {_MOST}, got {shown(value)}")
        checked[name] = int(value)
    modes = [mode.value for mode in AutoresetMode]
    mode = checked.get("autoreset_mode", AutoresetMode.NEXT_STEP)
    if not isinstance(mode, AutoresetMode) and (not isinstance(mode, str) or mode not in modes):
        raise InputError(f"`autoreset_mode` must be one of {', '.join(modes)}, got {shown(mode)}")
    return checked.pop("num_envs"), checked


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
