"""A policy as files: arrays for this package, safetensors and ONNX for others, and a card. No pickle anywhere."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import save

from ...slam.files.output import replacing, write_json
from ..learned.pilot import PilotConfig
from .onnx_graph import to_onnx


def write_policy(
    stem: Path, arrays: Mapping[str, NDArray[np.float32]], pilot: PilotConfig, card: Mapping[str, Any]
) -> None:
    """Write `stem`.npz, .safetensors, .onnx and .json.

    Args:
        stem: Path without suffix.
        arrays: As `learned.network` names them.
        pilot: What surrounds the network; goes into the card, since nothing drives without it.
        card: What is to be told about the policy.
    """
    with replacing(stem.with_suffix(".npz")) as temporary:
        np.savez_compressed(temporary, allow_pickle=False, **arrays)
    with replacing(stem.with_suffix(".safetensors")) as temporary:
        temporary.write_bytes(save({name: np.ascontiguousarray(array) for name, array in arrays.items()}))
    with replacing(stem.with_suffix(".onnx")) as temporary:
        temporary.write_bytes(to_onnx(arrays, pilot.features.shapes).SerializeToString())
    write_json(stem.with_suffix(".json"), {**card, "pilot": asdict(pilot)})
