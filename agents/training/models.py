"""The models of stable-baselines3, and their policies as plain arrays."""

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from sb3_contrib import RecurrentPPO
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.vec_env.base_vec_env import VecEnv
from torch import nn

from .extractor import Extractor
from .presets import TrainingPreset

CLASSES: dict[str, type[BaseAlgorithm]] = {"ppo": PPO, "sac": SAC, "recurrent-ppo": RecurrentPPO}


def make_model(preset: TrainingPreset, env: VecEnv, seed: int, log: str | None) -> BaseAlgorithm:
    """Return a new model on one thread; `log` is the folder for TensorBoard."""
    r = preset.reinforcement
    common: dict[str, Any] = {
        "learning_rate": r.learning_rate, "gamma": r.gamma, "seed": seed, "device": "cpu", "tensorboard_log": log,
    }  # fmt: skip
    policy: dict[str, Any] = {
        "features_extractor_class": Extractor,
        "features_extractor_kwargs": {"features_dim": preset.width},
        "activation_fn": nn.Tanh,
        "share_features_extractor": False,
    }
    if preset.algo == "sac":
        policy |= {"net_arch": [preset.width]}
        return SAC(
            "MultiInputPolicy", env, policy_kwargs=policy, buffer_size=100_000, learning_starts=2_000,
            train_freq=8, gradient_steps=8, batch_size=256, **common,
        )  # fmt: skip
    policy |= {"net_arch": {"pi": [preset.width], "vf": [preset.width]}, "log_std_init": r.log_deviation}
    common |= {"n_steps": r.rollout, "batch_size": 512, "n_epochs": 5, "clip_range": 0.15, "target_kl": 0.03}
    if preset.algo == "recurrent-ppo":
        policy |= {"lstm_hidden_size": preset.width}
        return RecurrentPPO("MultiInputLstmPolicy", env, policy_kwargs=policy, **common)
    return PPO("MultiInputPolicy", env, policy_kwargs=policy, **common)


def actor_parts(model: BaseAlgorithm) -> tuple[Extractor, nn.Module, nn.Linear]:
    """Return the policy's extractor, what lies above it, and its output layer."""
    policy: Any = model.policy
    if isinstance(model, SAC):
        return policy.actor.features_extractor, policy.actor.latent_pi, policy.actor.mu
    return policy.pi_features_extractor, policy.mlp_extractor.policy_net, policy.action_net


def mean_output(model: BaseAlgorithm, inputs: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return (n, 2) what the policy would do without exploration, before it is cut; not of recurrent policies."""
    extractor, middle, output = actor_parts(model)
    wished = output(middle(extractor(inputs)))
    return torch.tanh(wished) if isinstance(model, SAC) else wished


def arrays_of(model: BaseAlgorithm) -> dict[str, NDArray[np.float32]]:
    """Return the policy's arrays, named as `learned.network` says."""
    extractor, middle, output = actor_parts(model)
    arrays: dict[str, torch.Tensor] = {}
    for name in ("scan", "vector"):
        for part in ("mean", "deviation"):
            arrays[f"{name}.{part}"] = getattr(extractor, f"{name}_{part}")
    layers = {"scan": extractor.scan, "map": extractor.map, "head": middle}
    for name, module in layers.items():
        for i, layer in enumerate(_weighted(module)):
            arrays |= {f"{name}.{i}.weight": layer.weight, f"{name}.{i}.bias": layer.bias}
    arrays |= {"dense.0.weight": extractor.dense.weight, "dense.0.bias": extractor.dense.bias}
    arrays |= {"output.weight": output.weight, "output.bias": output.bias}
    if isinstance(model, RecurrentPPO):
        lstm: Any = model.policy
        for name, suffix in (("input", "ih"), ("hidden", "hh")):
            for part in ("weight", "bias"):
                arrays[f"lstm.{name}.{part}"] = getattr(lstm.lstm_actor, f"{part}_{suffix}_l0")
    arrays["squash"] = torch.tensor(float(isinstance(model, SAC)))
    return {name: value.detach().numpy().astype(np.float32).copy() for name, value in arrays.items()}


def _weighted(module: nn.Module | None) -> list[Any]:
    if module is None:
        return []
    return [layer for layer in module.children() if isinstance(layer, (nn.Linear, nn.Conv1d, nn.Conv2d))]
