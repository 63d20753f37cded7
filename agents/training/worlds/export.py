"""A reinforced policy as files: arrays for this package, safetensors for others, and a card. No pickle anywhere."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from safetensors.numpy import save
from torch import nn

from ....slam.files.output import replacing, write_json
from ...reinforced.policy import ReinforcedConfig
from ..model_state import Arrays


def policy_arrays(policy: Any) -> Arrays:
    """Return the actor of a policy of stable-baselines3 as `agents.reinforced.policy` names its arrays."""
    layers = [part for part in policy.mlp_extractor.policy_net if isinstance(part, nn.Linear)]
    arrays: Arrays = {}
    for i, layer in enumerate((*layers, policy.action_net)):
        for name in ("weight", "bias"):
            arrays[f"layer.{i}.{name}"] = np.array(getattr(layer, name).detach().numpy(), dtype=np.float32, order="C")
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
