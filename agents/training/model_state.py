"""What a model needs to go on learning, as plain arrays: its weights, and what its optimisers remember.

| name | what |
|---|---|
| `policy/NAME` | weights and statistics of the policy (of SAC, critics and their targets, too) |
| `OPTIMISER/I/step`, `/exp_avg`, `/exp_avg_sq` | Adam's count and moments of its parameter I; none of one at rest |
| `log_ent_coef` | logarithm of SAC's weight of the entropy |

All are float32. What is not here is begun anew by who goes on: episodes, rollouts, SAC's replay buffer, and random
draws, which begin with the seed again; learning rates and the like are settings, and stand in the preset.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from stable_baselines3 import SAC
from stable_baselines3.common.base_class import BaseAlgorithm

Arrays = dict[str, NDArray[np.float32]]
Shapes = dict[str, tuple[int, ...]]

_MOMENTS = ("exp_avg", "exp_avg_sq")


def arrays_of_model(model: BaseAlgorithm) -> Arrays:
    """Return everything in the table above."""
    arrays = {name: _copy(tensor) for name, tensor in _tensors(model).items()}
    for name, optimizer in _optimizers(model).items():
        arrays |= arrays_of_adam(name, optimizer)
    return arrays


def restore_model(model: BaseAlgorithm, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Set what `arrays_of_model` returned; their shapes must be those of `shapes_of_model`.

    Raises:
        ValueError: If one of the arrays that every model has is missing.
    """
    for name, tensor in _tensors(model).items():
        if name not in arrays:
            raise ValueError(f"array {name} is missing")
        tensor.copy_(torch.from_numpy(arrays[name]))
    for name, optimizer in _optimizers(model).items():
        restore_adam(name, optimizer, arrays)


def shapes_of_model(model: BaseAlgorithm) -> Shapes:
    """Return the shape of every array that `arrays_of_model` may return for such a model."""
    shapes = {name: tuple(tensor.shape) for name, tensor in _tensors(model).items()}
    for name, optimizer in _optimizers(model).items():
        shapes |= shapes_of_adam(name, optimizer)
    return shapes


def arrays_of_adam(prefix: str, optimizer: torch.optim.Optimizer) -> Arrays:
    """Return what Adam remembers, named `prefix`/I/...; nothing of parameters that it never moved."""
    arrays: Arrays = {}
    for i, parameter in enumerate(_parameters(optimizer)):
        for part, value in optimizer.state.get(parameter, {}).items():
            arrays[f"{prefix}/{i}/{part}"] = _copy(value)
    return arrays


def restore_adam(prefix: str, optimizer: torch.optim.Optimizer, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Set what `arrays_of_adam` returned.

    Raises:
        ValueError: If there is only a part of what is remembered of a parameter, or a count is none.
    """
    for i, parameter in enumerate(_parameters(optimizer)):
        names = {part: f"{prefix}/{i}/{part}" for part in ("step", *_MOMENTS)}
        there = [name for name in names.values() if name in arrays]
        if not there:
            continue
        if len(there) < len(names):
            raise ValueError(f"of {', '.join(names.values())} there must be all or none, got {', '.join(there)}")
        if not arrays[names["step"]] >= 1.0 or arrays[names["exp_avg_sq"]].min(initial=0.0) < 0.0:
            raise ValueError(f"{prefix}/{i} needs a step of at least 1, and squares that are not negative")
        optimizer.state[parameter] = {part: torch.from_numpy(arrays[name].copy()) for part, name in names.items()}


def shapes_of_adam(prefix: str, optimizer: torch.optim.Optimizer) -> Shapes:
    """Return the shapes of all that Adam may remember."""
    shapes: Shapes = {}
    for i, parameter in enumerate(_parameters(optimizer)):
        shapes[f"{prefix}/{i}/step"] = ()
        shapes |= {f"{prefix}/{i}/{part}": tuple(parameter.shape) for part in _MOMENTS}
    return shapes


def _tensors(model: BaseAlgorithm) -> dict[str, torch.Tensor]:
    """Return what is learned, by name; the model's own tensors, to be written to."""
    found = {f"policy/{name}": tensor for name, tensor in model.policy.state_dict().items()}
    if isinstance(model, SAC) and model.log_ent_coef is not None:
        found["log_ent_coef"] = model.log_ent_coef.detach()
    return found


def _optimizers(model: BaseAlgorithm) -> dict[str, torch.optim.Optimizer]:
    policy: Any = model.policy
    if not isinstance(model, SAC):
        return {"optimizer": policy.optimizer}
    found = {"actor": policy.actor.optimizer, "critic": policy.critic.optimizer}
    return found if model.ent_coef_optimizer is None else {**found, "entropy": model.ent_coef_optimizer}


def _parameters(optimizer: torch.optim.Optimizer) -> list[torch.Tensor]:
    return [parameter for group in optimizer.param_groups for parameter in group["params"]]


def _copy(tensor: torch.Tensor) -> NDArray[np.float32]:
    return np.array(tensor.detach().cpu().numpy(), dtype=np.float32, order="C")
