"""A reinforced policy as files: arrays for this package, safetensors for others, and a card. No pickle anywhere."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import save

from ....slam.files.output import replacing, write_json
from ...reinforced.policy import ReinforcedConfig
from ..model_state import Arrays
from .mirrored import MirroredNetwork


def policy_arrays(actor: MirroredNetwork) -> Arrays:
    """Return the layers of an actor as `agents.reinforced.policy` names its arrays."""
    arrays: Arrays = {}
    for i, layer in enumerate(actor.layers()):
        for name, tensor in layer._asdict().items():
            arrays[f"layer.{i}.{name}"] = np.array(tensor.detach().cpu().numpy(), dtype=np.float32, order="C")
    return arrays


def write_policy(
    stem: Path, arrays: Mapping[str, NDArray[np.float32]], config: ReinforcedConfig, card: Mapping[str, Any]
) -> None:
    """Write `stem`.npz, .safetensors and .json; the same arrays make the same bytes."""
    with replacing(stem.with_suffix(".npz")) as temporary:
        np.savez_compressed(temporary, allow_pickle=False, **arrays)
    with replacing(stem.with_suffix(".safetensors")) as temporary:
        temporary.write_bytes(save(dict(arrays)))
    write_json(stem.with_suffix(".json"), {**card, **asdict(config)})
