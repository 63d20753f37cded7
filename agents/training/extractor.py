"""The network's lower part in torch: the same arithmetic as `learned.network`, as stable-baselines3 wants it."""

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from torch import nn

from ..learned.network import CLIP, STRIDE

SCAN_LAYERS = ((16, 5), (24, 5), (24, 3))
"""Channels and width of each convolution over the scan."""
MAP_LAYERS = ((8, 5), (16, 5), (16, 3))
"""The same over the map patch."""


class Extractor(BaseFeaturesExtractor):
    """Convolutions over scan (1-D) and map patch (2-D, if there is one), and the vector, joined by a dense layer.

    The statistics that normalise scan and vector are buffers, so they are saved with the weights; `set_statistics`
    sets them once, from demonstrations or first random drives.

    Args:
        observation_space: Of the inputs: `scan`, `vector` and perhaps `map`.
        features_dim: Width of the dense layer.
    """

    def __init__(self, observation_space: spaces.Dict, features_dim: int = 128) -> None:
        super().__init__(observation_space, features_dim)
        for name in ("scan", "vector"):
            shape = _shape(observation_space, name)
            self.register_buffer(f"{name}_mean", torch.zeros(shape))
            self.register_buffer(f"{name}_deviation", torch.ones(shape))
        scan_shape, vector_shape = _shape(observation_space, "scan"), _shape(observation_space, "vector")
        self.scan = _convolutions(nn.Conv1d, scan_shape[0], SCAN_LAYERS)
        width = _flat(self.scan, scan_shape) + vector_shape[0]
        self.map: nn.Sequential | None = None
        if "map" in observation_space.spaces:
            map_shape = _shape(observation_space, "map")
            self.map = _convolutions(nn.Conv2d, map_shape[0], MAP_LAYERS)
            width += _flat(self.map, map_shape)
        self.dense = nn.Linear(width, features_dim)

    def set_statistics(self, statistics: dict[str, np.ndarray]) -> None:
        """Set `scan.mean`, `scan.deviation`, `vector.mean`, `vector.deviation`."""
        for name, array in statistics.items():
            getattr(self, name.replace(".", "_")).copy_(torch.as_tensor(array, dtype=torch.float32))

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        """Return (batch, features_dim)."""
        parts = [self.scan(self._normal("scan", observations["scan"])).flatten(1)]
        if self.map is not None:
            parts.append(self.map(observations["map"]).flatten(1))
        parts.append(self._normal("vector", observations["vector"]))
        return torch.tanh(self.dense(torch.cat(parts, dim=1)))

    def _normal(self, name: str, values: torch.Tensor) -> torch.Tensor:
        mean, deviation = getattr(self, f"{name}_mean"), getattr(self, f"{name}_deviation")
        return torch.clamp((values - mean) / deviation, -CLIP, CLIP)


def statistics_of(inputs: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return mean and deviation of `scan` (n, ...) and `vector` (n, ...); constant entries get the deviation 1."""
    found = {}
    for name in ("scan", "vector"):
        values = inputs[name].astype(np.float64)
        deviation = values.std(axis=0)
        found[f"{name}.mean"] = values.mean(axis=0)
        found[f"{name}.deviation"] = np.where(deviation > 1e-3, deviation, 1.0)
    return found


def _shape(space: spaces.Dict, name: str) -> tuple[int, ...]:
    return tuple(space[name].shape or ())


def _convolutions(kind: type[nn.Module], channels: int, layers: tuple[tuple[int, int], ...]) -> nn.Sequential:
    parts: list[nn.Module] = []
    for out, width in layers:
        parts += [kind(channels, out, width, stride=STRIDE), nn.ReLU()]
        channels = out
    return nn.Sequential(*parts)


def _flat(layers: nn.Sequential, shape: tuple[int, ...]) -> int:
    with torch.no_grad():
        return int(layers(torch.zeros(1, *shape)).numel())
