"""A reinforced policy: dense layers in plain numpy, and the card that says how it is driven.

Arrays `layer.N.weight` (out, in) and `layer.N.bias` (out,), N from 0; tanh after each but the last, whose two outputs
are cut to [-1, 1]: the wish that `SteeringConfig` describes.
"""

import os
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.wrappers.pooled_config import PooledConfig
from ...slam.errors import InputError, shown
from ...slam.files.input import named
from ...slam.files.output import read_arrays, read_json
from ..learned.guard import GuardConfig
from ..learned.steering import SteeringConfig

Floats = NDArray[np.float32]
SHIPPED = Path(__file__).parents[1] / "models"
"""Where the shipped policies are."""
LARGEST = 1e4
"""Of a number in the arrays or the card: those that were trained stay below 30."""
MOST_NUMBERS = 1 << 22
"""In all arrays together: those of the preset are 33,000."""
_SCALES = ("max_speed", "max_turn_rate", "field_of_view")


@dataclass(frozen=True, kw_only=True)
class ReinforcedConfig:
    """What a policy is told, and how its wishes are driven.

    Attributes:
        pooled: What it is told.
        steering: How its wishes are driven.
        guard: The safety filter that it was trained with; None: it was trained without.
        max_speed: Speed that it was told as action 1 [m/s].
        max_turn_rate: Turn rate that it was told so [rad/s].
        field_of_view: Of the laser, half of it to either side of straight ahead [rad]; another laser is told as
            `KnownBeams` says.
    """

    pooled: PooledConfig = field(default_factory=PooledConfig)
    steering: SteeringConfig = field(default_factory=SteeringConfig)
    guard: GuardConfig | None = None
    max_speed: float = 1.3
    max_turn_rate: float = 2.0
    field_of_view: float = float(np.radians(270.0))


class DenseNetwork:
    """Inputs to outputs.

    Args:
        arrays: As the table above names them.
    """

    def __init__(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        count = len(arrays) // 2
        self._layers = [(arrays[f"layer.{i}.weight"], arrays[f"layer.{i}.bias"]) for i in range(count)]

    def __call__(self, inputs: Floats) -> Floats:
        """Return the output (2,) in [-1, 1] for inputs (k,)."""
        x = inputs
        for weight, bias in self._layers[:-1]:
            x = np.tanh(weight @ x + bias)
        weight, bias = self._layers[-1]
        return np.clip(weight @ x + bias, -1.0, 1.0)


def is_reinforced(policy: str | os.PathLike[str]) -> bool:
    """Return whether a folder, or a shipped name, holds a reinforced policy, not one of `agents.learned`."""
    card = _stem(policy).with_suffix(".json")
    if not card.is_file():
        return False
    content = read_json(card)
    return isinstance(content, dict) and "pooled" in content


def load_reinforced(policy: str | os.PathLike[str]) -> tuple[dict[str, Floats], ReinforcedConfig]:
    """Return the arrays of a policy and what surrounds it.

    Args:
        policy: Name of a shipped one, or a folder with policy.npz and policy.json.

    Raises:
        InputError: If a file is missing or does not fit.
    """
    stem = _stem(policy)
    weights, card = stem.with_suffix(".npz"), stem.with_suffix(".json")
    if not (weights.is_file() and card.is_file()):
        raise InputError(f"a reinforced policy needs {stem.name}.npz and {stem.name}.json, got {named(policy)}")
    content, arrays = read_json(card), read_arrays(weights)
    try:
        config = reinforced_config(content)
        _check(arrays, config.pooled.size())
    except ValueError as error:
        raise InputError(f"the policy {named(weights)} does not fit this program: {error}") from error
    return {name: array.astype(np.float32) for name, array in arrays.items()}, config


def reinforced_config(card: Any) -> ReinforcedConfig:
    """Return the configuration that a card holds.

    Raises:
        ValueError: Naming the field that is missing or wrong.
    """
    if not isinstance(card, dict) or not {"pooled", "steering"} <= set(card):
        raise ValueError("`pooled` and `steering` must be in its card")
    speeds = {name: _number(name, card.get(name), whole=False) for name in _SCALES}
    if min(speeds.values()) <= 0.0:
        raise ValueError(f"{', '.join(_SCALES)} must be positive, got {shown(speeds)}")
    return ReinforcedConfig(
        pooled=_made(PooledConfig, "pooled", card["pooled"]),
        steering=_made(SteeringConfig, "steering", card["steering"]),
        guard=None if card.get("guard") is None else _made(GuardConfig, "guard", card["guard"]),
        **speeds,
    )


def _stem(policy: str | os.PathLike[str]) -> Path:
    return Path(policy) / "policy" if os.path.isdir(policy) else SHIPPED / Path(policy).name


def _made(kind: Any, where: str, value: Any) -> Any:
    """Return a configuration of plain numbers, each of the kind of its default."""
    if not isinstance(value, dict):
        raise ValueError(f"`{where}` must hold fields with values, got {shown(value)}")
    known = {one.name: one.default for one in fields(kind)}
    for name, number in value.items():
        if name not in known:
            raise ValueError(f"`{where}` has no field {shown(name)}")
        assert known[name] is not MISSING
        _number(f"{where}.{name}", number, whole=isinstance(known[name], int))
    try:
        return kind(**value)
    except InputError as error:
        raise ValueError(str(error)) from error


def _number(where: str, number: Any, *, whole: bool) -> Any:
    good = isinstance(number, int if whole else (int, float)) and not isinstance(number, bool)
    if not good or not -LARGEST <= number <= LARGEST:
        raise ValueError(f"`{where}` must be a {'whole ' if whole else ''}number, got {shown(number)}")
    return number


def _check(arrays: Mapping[str, NDArray[Any]], width: int) -> None:
    """Refuse what is no network from `width` numbers to two."""
    names = {f"layer.{i}.{part}" for i in range(len(arrays) // 2) for part in ("weight", "bias")}
    if not arrays or set(arrays) != names:
        raise ValueError(f"its arrays must be layer.N.weight and layer.N.bias, got {', '.join(sorted(arrays))[:200]}")
    if sum(array.size for array in arrays.values()) > MOST_NUMBERS:
        raise ValueError(f"its arrays may hold {MOST_NUMBERS} numbers")
    for i in range(len(arrays) // 2):
        weight, bias = arrays[f"layer.{i}.weight"], arrays[f"layer.{i}.bias"]
        if weight.ndim != 2 or weight.shape[1] != width or bias.shape != weight.shape[:1]:
            raise ValueError(f"layer {i} must take {width} numbers, got {weight.shape} and {bias.shape}")
        if not (_is_bounded(weight) and _is_bounded(bias)):
            raise ValueError(f"layer {i} must hold finite numbers within +-{LARGEST:g}")
        width = weight.shape[0]
    if width != 2:
        raise ValueError(f"its last layer must have 2 outputs, got {width}")


def _is_bounded(array: NDArray[Any]) -> bool:
    return array.dtype.kind == "f" and bool(np.isfinite(array).all()) and np.abs(array).max(initial=0.0) <= LARGEST
