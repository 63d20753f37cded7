"""Arrays of any names in a file of ours, as demonstrations are."""

from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.arrays import edits, packed
from fuzzer.border import Border, Input
from fuzzer.files import put
from tagalong.slam.files.npz import read_arrays


def _read(value: Input, folder: Path) -> Any:
    sound = {"scan": np.zeros((3, 2, 8), np.float16), "labels": np.zeros((3, 2), np.float32)}
    return read_arrays(put(folder, "round_0.npz", packed(sound, value)))


BORDERS = (
    Border(
        name="checkpoints.arrays", make=lambda rng: edits(rng, ["scan", "labels"]), call=_read, file="round_0.npz",
        ms=1.0,
    ),
)  # fmt: skip
