"""Whether arrays make a network: each of them looked at before any of them is used."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .network import STRIDE

Arrays = Mapping[str, NDArray[Any]]
Shape = tuple[int, ...]

MOST_BYTES = 64 << 20
"""Of all arrays together: those of the widest preset take one MiB."""
LARGEST = 1e4
"""Of a number in them: those that were trained stay below 30, and with numbers up to this no sum overflows."""


def check_arrays(arrays: Arrays, inputs: Mapping[str, Shape]) -> None:
    """Refuse what is no network: arrays that are missing, too many, of a wrong shape, or not of finite numbers.

    Args:
        arrays: As `learned.network` names them.
        inputs: Name -> shape of what the network is told.

    Raises:
        ValueError: Naming the array.
    """
    left = dict(arrays)
    width = _convolutions(left, "scan", inputs["scan"])
    _take(left, "scan.mean", inputs["scan"])
    _take(left, "scan.deviation", inputs["scan"], positive=True)
    if "map" in inputs:
        width += _convolutions(left, "map", inputs["map"])
    _take(left, "vector.mean", inputs["vector"])
    _take(left, "vector.deviation", inputs["vector"], positive=True)
    width = _dense(left, "dense", width + inputs["vector"][0])
    width = _dense(left, "head", _lstm(left, width))
    _take(left, "output.weight", (2, width))
    _take(left, "output.bias", (2,))
    _take(left, "squash", ())
    if left:
        raise ValueError(f"array {min(left)[:40]} has no place in the network")
    total = sum(array.nbytes for array in arrays.values())
    if total > MOST_BYTES:
        raise ValueError(f"its arrays may take {MOST_BYTES} bytes, got {total}")


def _take(left: dict[str, NDArray[Any]], name: str, shape: Shape | None, *, positive: bool = False) -> Shape:
    """Take an array out of those that are left; return its shape, which must be `shape` unless that is None."""
    if name not in left:
        raise ValueError(f"array {name} is missing")
    array = left.pop(name)
    if shape is not None and array.shape != shape:
        raise ValueError(f"array {name} must have the shape {shape}, got {array.shape}")
    if array.dtype.kind not in "fiu" or not np.isfinite(array).all():
        raise ValueError(f"array {name} has values that are not finite numbers")
    if array.size and (array.max() > LARGEST or array.min() < -LARGEST or (positive and array.min() <= 0.0)):
        raise ValueError(f"array {name} must lie within {'0 and' if positive else '+-'} {LARGEST:g}")
    return array.shape


def _layer(left: dict[str, NDArray[Any]], name: str, dimensions: int, channels: int) -> Shape:
    """Take weight and bias of a layer; return the weight's shape."""
    shape = _take(left, f"{name}.weight", None)
    if len(shape) != dimensions or shape[1] != channels or min(shape) < 1:
        kind = f"{dimensions} dimensions, the second of {channels}"
        raise ValueError(f"array {name}.weight must have {kind}, got {shape}")
    _take(left, f"{name}.bias", shape[:1])
    return shape


def _convolutions(left: dict[str, NDArray[Any]], part: str, shape: Shape) -> int:
    """Take the convolutions over an input; return how many numbers come out of them."""
    i = 0
    while f"{part}.{i}.weight" in left:
        weight = _layer(left, f"{part}.{i}", len(shape) + 1, shape[0])
        over = tuple((size - width) // STRIDE + 1 for size, width in zip(shape[1:], weight[2:], strict=True))
        if min(over) < 1:
            raise ValueError(f"array {part}.{i}.weight is wider than its input, {weight} over {shape}")
        shape, i = (weight[0], *over), i + 1
    return int(np.prod(shape))


def _dense(left: dict[str, NDArray[Any]], part: str, width: int) -> int:
    """Take dense layers over `width` numbers; return how many come out of them."""
    i = 0
    while f"{part}.{i}.weight" in left:
        width, i = _layer(left, f"{part}.{i}", 2, width)[0], i + 1
    return width


def _lstm(left: dict[str, NDArray[Any]], width: int) -> int:
    """Take the LSTM over `width` numbers, if there is one; return how many come out of it."""
    if not any(name.startswith("lstm.") for name in left):
        return width
    gates = _take(left, "lstm.hidden.bias", None)
    if len(gates) != 1 or gates[0] < 4 or gates[0] % 4:
        raise ValueError(f"array lstm.hidden.bias must have the shape (4 h,), got {gates}")
    _take(left, "lstm.hidden.weight", (gates[0], gates[0] // 4))
    _take(left, "lstm.input.weight", (gates[0], width))
    _take(left, "lstm.input.bias", gates)
    return gates[0] // 4
