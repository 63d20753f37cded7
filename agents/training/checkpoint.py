"""Checkpoints of a training run: what SIGKILL leaves behind is always whole, and nothing that is read can run code.

A checkpoint is two files in the run's folder: `model_N.safetensors` (arrays) and `checkpoint.json`, the index, which
says N. The arrays are written first, under a number that was not used yet, then the index, then the arrays before are
dropped: at every moment the index points to the arrays that it was written with.
"""

import math
import struct
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, deserialize
from safetensors.numpy import save

from ...slam.errors import InputError, one_line, shown
from ...slam.files.input import read_bytes
from ...slam.files.output import read_json, replacing, write_json
from .model_state import Arrays, Shapes

INDEX = "checkpoint.json"
_MOST_HEADER = 1 << 20
"""Bytes of a header: it names each array in about 120, and the largest model has some 200 of them."""
_MOST = 1 << 53
"""Of a count: beyond it, a number of JSON need not be whole."""


@dataclass
class Progress:
    """How far a run is.

    Attributes:
        rounds: Rounds of imitation that are done.
        passes: Passes of the fit of the round that has begun.
        error: Mean squared error of the last of them.
        steps: Steps of reinforcement that are done.
        rollouts: Rollouts of reinforcement that are done.
        minutes: Time spent, over all starts of the run.
        best: The best mean return of an evaluation so far.
        due: What has been done since the last evaluation, if another one is to follow now; "" if not.
        evaluations: All evaluations so far.
        curriculum: State of the curriculum.
    """

    rounds: int = 0
    passes: int = 0
    error: float = 0.0
    steps: int = 0
    rollouts: int = 0
    minutes: float = 0.0
    best: float = float("-inf")
    due: str = ""
    evaluations: list[dict[str, Any]] = field(default_factory=list)
    curriculum: dict[str, Any] = field(default_factory=dict)


def save_checkpoint(folder: Path, arrays: Arrays, progress: Progress) -> None:
    """Write the arrays, then the index that points to them, then drop the arrays before."""
    there = (_number(file) for file in folder.glob("model_*.safetensors") if file.is_file())
    numbers = [number for number in there if number is not None]
    file = _file(folder, max(numbers, default=0) + 1)
    with replacing(file) as temporary:
        temporary.write_bytes(save(arrays))  # a full disk is an OSError then, which `replacing` tells
    best = None if progress.best == float("-inf") else progress.best
    write_json(folder / INDEX, {**asdict(progress), "best": best, "model": _number(file)})
    for number in numbers:
        _file(folder, number).unlink(missing_ok=True)


def load_progress(folder: Path) -> tuple[Progress, Path] | None:
    """Return how far the run in `folder` is, and the file of its arrays; None if it has no checkpoint.

    Raises:
        InputError: If the index is none.
    """
    index = folder / INDEX
    if not index.is_file():
        return None
    content = read_json(index)
    try:
        number = _checked(content, "model", int)
        fields = {name: _checked(content, name, kind) for name, kind in _KINDS.items()}
        best = -math.inf if content.get("best") is None else _checked(content, "best", float)
        for k, evaluation in enumerate(fields["evaluations"]):
            _check_evaluation(evaluation, f"evaluations[{k}]")
    except ValueError as error:
        raise InputError(f"{index}: no checkpoint of this program: {error}") from error
    return Progress(best=best, **fields), _file(folder, number)


def load_arrays(file: Path, shapes: Shapes) -> Arrays:
    """Return the arrays of a safetensors file.

    Args:
        file: As `load_progress` names it.
        shapes: Name -> shape of those that may be in it; together they bound the size of the file.

    Raises:
        InputError: If there is no such file, it is damaged, or holds anything else.
    """
    most = 4 * sum(math.prod(shape) for shape in shapes.values()) + _MOST_HEADER
    content = read_bytes(file, most, f"the arrays of this run take {most} bytes at most")
    try:
        (header,) = struct.unpack("<Q", content[:8].ljust(8, b"\0"))
        if header > _MOST_HEADER:
            raise ValueError(f"its header may have {_MOST_HEADER} bytes, got {header}")
        return {name: _array(name, part, shapes) for name, part in deserialize(content)}
    except (ValueError, SafetensorError) as error:
        raise InputError(f"{file}: no checkpoint of this run: {one_line(str(error), 300)}") from error


def _array(name: str, part: Mapping[str, Any], shapes: Shapes) -> NDArray[np.float32]:
    kind, shape = part["dtype"], tuple(part["shape"])
    if name not in shapes or (kind, shape) != ("F32", shapes[name]):
        wanted = f"F32 {shapes[name]}" if name in shapes else "no such array"
        raise ValueError(f"array {shown(name)} must be {wanted}, got {kind} {shown(shape)}")
    array = np.frombuffer(part["data"], dtype="<f4").astype(np.float32).reshape(shape)
    if not np.isfinite(array).all():
        raise ValueError(f"array {name} has values that are not finite numbers")
    return array


def _number(file: Path) -> int | None:
    digits = file.stem.removeprefix("model_")
    return int(digits) if digits.isascii() and digits.isdigit() and len(digits) < 16 else None


def _file(folder: Path, number: int) -> Path:
    return folder / f"model_{number}.safetensors"


_KINDS: dict[str, type] = {
    "rounds": int, "passes": int, "error": float, "steps": int, "rollouts": int, "minutes": float, "due": str,
    "evaluations": list, "curriculum": dict,
}  # fmt: skip
_WORDS = {int: "a whole number of 0 or more", float: "a finite number", str: "a short text", list: "a list", dict: "{}"}


def _checked(content: Any, name: str, kind: type) -> Any:
    """Return entry `name` of `content`, or raise ValueError if it is not of that kind."""
    value: Any = content.get(name) if isinstance(content, Mapping) else None
    good = isinstance(value, (int, float) if kind is float else kind) and not isinstance(value, bool)
    if kind in (int, float):
        good = good and abs(value) <= _MOST and (kind is float or value >= 0)
    if kind is str:
        good = good and len(str(value)) <= 80
    if not good:
        raise ValueError(f"`{name}` must be {_WORDS[kind]}, got {shown(value)}")
    return value


def _check_evaluation(row: Any, where: str) -> None:
    try:
        _checked(row, "after", str)
        for name in ("mean_return", "success"):
            _checked(row, name, float)
        for k, value in enumerate(_checked(row, "returns", list)):
            _checked({f"returns[{k}]": value}, f"returns[{k}]", float)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error
