"""The network in plain numpy: nothing but arrays, so neither torch nor a pickle is needed to drive.

Inputs `scan` (c, n) -> normalised -> 1-D convolutions with ReLU; `map` (1, n, n) likewise by 2-D ones, if it is there;
`vector` (k,) -> normalised; all joined -> dense layers with tanh -> (if there is one) an LSTM -> dense layers with
tanh -> the output layer.
Names of the arrays:

| name | shape |
|---|---|
| `scan.mean`, `scan.deviation`, `vector.mean`, `vector.deviation` | as the input |
| `scan.N.weight`, `.bias` | (out, in, width), (out,): stride 2, no padding |
| `map.N.weight`, `.bias` | (out, in, height, width), (out,): stride 2, no padding |
| `dense.N.weight`, `.bias` | (out, in), (out,) |
| `lstm.input.weight`, `lstm.hidden.weight`, `lstm.input.bias`, `lstm.hidden.bias` | (4 h, in), (4 h, h), (4 h,) each |
| `head.N.weight`, `.bias` | (out, in), (out,): the dense layers of the policy |
| `output.weight`, `output.bias` | (2, in), (2,) |
| `squash` | (): 1 if tanh is taken of the output, 0 if it is cut to [-1, 1] |
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

Floats = NDArray[np.float32]

STRIDE = 2
"""Of every convolution."""
CLIP = 6.0
"""Normalised inputs are cut to this many deviations."""


class Network:
    """Inputs to outputs; keeps the state of its LSTM, if it has one.

    Args:
        arrays: As the table above names them, float32.
    """

    def __init__(self, arrays: Mapping[str, NDArray[np.floating]]) -> None:
        self.arrays = {name: np.asarray(array, dtype=np.float32) for name, array in arrays.items()}
        self.reset()

    @property
    def recurrent(self) -> bool:
        """Whether it has a memory of its own."""
        return "lstm.hidden.weight" in self.arrays

    def reset(self) -> None:
        """Forget the last episode."""
        width = self.arrays["lstm.hidden.weight"].shape[1] if self.recurrent else 0
        self.memory = np.zeros((2, width), dtype=np.float32)

    def __call__(self, inputs: Mapping[str, Floats]) -> Floats:
        """Return the output (2,) for one set of inputs."""
        parts = [_convolved(self._normal("scan", inputs["scan"]), self._layers("scan")).ravel()]
        if "map" in inputs:
            parts.append(_convolved(inputs["map"], self._layers("map")).ravel())
        x = np.concatenate((*parts, self._normal("vector", inputs["vector"])))
        x = _dense(x, self._layers("dense"))
        if self.recurrent:
            x = self._remember(x)
        x = _dense(x, self._layers("head"))
        out = self.arrays["output.weight"] @ x + self.arrays["output.bias"]
        return np.tanh(out) if self.arrays["squash"] > 0.5 else np.clip(out, -1.0, 1.0)

    def _normal(self, name: str, values: Floats) -> Floats:
        normal = (values - self.arrays[f"{name}.mean"]) / self.arrays[f"{name}.deviation"]
        return np.clip(normal, -CLIP, CLIP)

    def _layers(self, part: str) -> list[tuple[Floats, Floats]]:
        a, count = self.arrays, 0
        while f"{part}.{count}.weight" in a:
            count += 1
        return [(a[f"{part}.{i}.weight"], a[f"{part}.{i}.bias"]) for i in range(count)]

    def _remember(self, x: Floats) -> Floats:
        """Take one step of the LSTM (gates in torch's order: input, forget, cell, output)."""
        a, (hidden, cell) = self.arrays, self.memory
        gates = a["lstm.input.weight"] @ x + a["lstm.input.bias"] + a["lstm.hidden.weight"] @ hidden
        take, keep, new, show = (gates + a["lstm.hidden.bias"]).reshape(4, -1)
        cell = _sigmoid(keep) * cell + _sigmoid(take) * np.tanh(new)
        hidden = _sigmoid(show) * np.tanh(cell)
        self.memory = np.stack((hidden, cell))
        return hidden


def _convolved(x: Floats, layers: list[tuple[Floats, Floats]]) -> Floats:
    """Convolve x (c, n) or (c, n, m) with every layer, ReLU after each."""
    for weight, bias in layers:
        axes = tuple(range(1, x.ndim))
        windows = sliding_window_view(x, weight.shape[2:], axis=axes)
        windows = windows[(slice(None), *(slice(None, None, STRIDE) for _ in axes))]
        over = [0, *range(x.ndim, x.ndim + len(axes))]
        x = np.tensordot(weight, windows, axes=(list(range(1, weight.ndim)), over))
        x = np.maximum(x + bias.reshape(-1, *(1 for _ in axes)), 0.0)
    return x


def _dense(x: Floats, layers: list[tuple[Floats, Floats]]) -> Floats:
    for weight, bias in layers:
        x = np.tanh(weight @ x + bias)
    return x


def _sigmoid(x: NDArray[Any]) -> Floats:
    return np.asarray(1.0 / (1.0 + np.exp(-x)), dtype=np.float32)
