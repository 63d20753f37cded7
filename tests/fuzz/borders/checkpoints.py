"""Folders of a training that goes on: the index, the arrays, the state of a curriculum."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Border, Input, require
from fuzzer.files import put_all
from fuzzer.mutations import mutated_bytes
from fuzzer.sanity import finite
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.agents.training.checkpoint import load_arrays, load_progress
from tagalong.agents.training.curriculum import Curriculum
from tagalong.agents.training.presets import make_preset

_SHAPES = {"policy.weight": (2, 3), "policy.bias": (3,), "steps": ()}
_INDEX: dict[str, Any] = {
    "rounds": 2, "passes": 0, "error": 0.1, "steps": 100, "rollouts": 3, "minutes": 1.5, "due": "",
    "best": 12.5, "model": 1,
    "evaluations": [{"after": "imitation 1", "mean_return": 1.0, "success": 0.5, "returns": [1.0, 2.0]}],
    "curriculum": {"level": 0, "drawn": 7, "recent": [True, False]},
}  # fmt: skip
_KINDS = ("F32", "F64", "I64", "U8", "BOOL", "F16", "Q99", "")


def _header() -> dict[str, Any]:
    """Return the header of sound arrays, which lie one behind the other."""
    header, begin = {}, 0
    for name, shape in _SHAPES.items():
        size = 4 * int(np.prod(shape, dtype=int))
        header[name] = {"dtype": "F32", "shape": list(shape), "data_offsets": [begin, begin + size]}
        begin += size
    return header


def _checkpoint(rng: Generator) -> Input:
    """Return an index with hostile entries, and arrays with a hostile header, flipped bytes, or both sound."""
    index, header = json.loads(json.dumps(_INDEX)), _header()
    evaluation = index["evaluations"][0]
    for _ in range(int(rng.integers(0, 4))):
        target = (index, index, index["curriculum"], evaluation)[int(rng.integers(4))]
        if isinstance(target, dict) and target:
            name = list(target)[int(rng.integers(len(target)))]
            target[name] = ("../model", "/dev/zero", "..")[int(rng.integers(3))] if rng.random() < 0.1 else _plain(rng)
    while rng.random() < 0.5:
        part = header[list(_SHAPES)[int(rng.integers(3))]]
        key = list(part)[int(rng.integers(3))]
        part[key] = (
            _KINDS[int(rng.integers(8))] if key == "dtype" else [int(n) for n in rng.choice([0, 3, 24, 2**40], 2)]
        )
    text = json.dumps(header).encode()
    length = len(text) if rng.random() < 0.9 else int(rng.choice([0, 2**20, 2**40, 2**63 - 1]))
    arrays = struct.pack("<Q", length) + text + bytes(4 * 10)
    files = {"checkpoint.json": json.dumps(index, default=str).encode(), "model_1.safetensors": arrays}
    for name in files:
        if rng.random() < 0.3:
            files[name] = mutated_bytes(rng, files[name])
    return files


def _plain(rng: Generator) -> Any:
    value = hostile_value(rng)
    return value if not (isinstance(value, int) and abs(value) > 10**300) else "1" * 5000


def _gone_on(value: Input, folder: Path) -> Any:
    run = put_all(folder / "run", value)
    saved = load_progress(run)
    if saved is None:
        return None
    progress, file = saved
    require(file.parent == run, f"the arrays are looked for outside of the run: {file}")
    arrays = load_arrays(file, _SHAPES)
    Curriculum(make_preset("corridor", "ppo").curriculum, 0).restore(progress.curriculum)
    return progress, arrays


def _sane_progress(result: Any) -> None:
    if result is None:
        return
    progress, arrays = result
    finite([progress.steps, progress.minutes, progress.error], "progress", 1e16)
    for name, array in arrays.items():
        require(array.shape == _SHAPES[name], f"{name} of shape {array.shape}")
        finite(array, name)


BORDERS = (Border(name="checkpoints.run", make=_checkpoint, call=_gone_on, sane=_sane_progress, ms=0.61),)
