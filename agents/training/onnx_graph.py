"""A policy's arrays as an ONNX graph, which any runtime drives without torch and without this package.

Built node by node from the arrays, so it is the network of `learned.network` and nothing else.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

from ..learned.network import CLIP, STRIDE

OPSET = 17


class _Graph:
    """Nodes and constants, in the order in which they are added."""

    def __init__(self, arrays: Mapping[str, NDArray[np.float32]]) -> None:
        self.arrays, self.nodes, self.constants, self._count = arrays, [], [], 0

    def constant(self, array: NDArray) -> str:
        name = f"constant_{len(self.constants)}"
        self.constants.append(numpy_helper.from_array(array, name))
        return name

    def add(self, kind: str, *inputs: str, output: str | None = None, **attributes: Any) -> str:
        self._count += 1
        name = output or f"value_{self._count}"
        self.nodes.append(helper.make_node(kind, list(inputs), [name], **attributes))
        return name

    def add_many(self, kind: str, count: int, *inputs: str, **attributes: Any) -> list[str]:
        self._count += 1
        names = [f"value_{self._count}_{i}" for i in range(count)]
        self.nodes.append(helper.make_node(kind, list(inputs), names, **attributes))
        return names

    def layers(self, part: str) -> list[tuple[str, str, int]]:
        found = []
        while f"{part}.{len(found)}.weight" in self.arrays:
            weight, bias = (self.arrays[f"{part}.{len(found)}.{name}"] for name in ("weight", "bias"))
            found.append((self.constant(weight), self.constant(bias), weight.ndim))
        return found

    def normal(self, name: str) -> str:
        centred = self.add("Sub", name, self.constant(self.arrays[f"{name}.mean"]))
        scaled = self.add("Div", centred, self.constant(self.arrays[f"{name}.deviation"]))
        return self.cut(scaled, CLIP)

    def cut(self, value: str, bound: float, output: str | None = None) -> str:
        ends = (self.constant(np.array(end, dtype=np.float32)) for end in (-bound, bound))
        return self.add("Clip", value, *ends, output=output)

    def convolved(self, value: str, part: str) -> str:
        for weight, bias, rank in self.layers(part):
            value = self.add("Relu", self.add("Conv", value, weight, bias, strides=[STRIDE] * (rank - 2)))
        return self.add("Flatten", value)

    def dense(self, value: str, part: str) -> str:
        for weight, bias, _ in self.layers(part):
            value = self.add("Tanh", self.add("Gemm", value, weight, bias, transB=1))
        return value

    def remember(self, value: str) -> str:
        """One step of the LSTM; `hidden` and `cell` in, `next_hidden` and `next_cell` out."""
        both = []
        for source, part in ((value, "input"), ("hidden", "hidden")):
            weight, bias = (self.constant(self.arrays[f"lstm.{part}.{name}"]) for name in ("weight", "bias"))
            both.append(self.add("Gemm", source, weight, bias, transB=1))
        take, keep, new, show = self.add_many("Split", 4, self.add("Add", *both), axis=1)
        take, keep, show = (self.add("Sigmoid", gate) for gate in (take, keep, show))
        kept = self.add("Mul", keep, "cell")
        cell = self.add("Add", kept, self.add("Mul", take, self.add("Tanh", new)), output="next_cell")
        return self.add("Mul", show, self.add("Tanh", cell), output="next_hidden")


def to_onnx(arrays: Mapping[str, NDArray[np.float32]], shapes: Mapping[str, tuple[int, ...]]) -> onnx.ModelProto:
    """Return the model: inputs `scan`, `vector` (and `map`) with a first dimension `batch`, output `action` (batch, 2).

    A recurrent one has the inputs `hidden` and `cell` (batch, h) too, zeros at first, and the outputs `next_hidden` and
    `next_cell`.

    Args:
        arrays: As `learned.network` names them.
        shapes: Name -> shape of each input without the batch.
    """
    g = _Graph(arrays)
    parts = [g.convolved(g.normal("scan"), "scan")]
    if "map" in shapes:
        parts.append(g.convolved("map", "map"))
    value = g.dense(g.add("Concat", *parts, g.normal("vector"), axis=1), "dense")
    inputs, outputs = dict(shapes), {"action": (2,)}
    if "lstm.hidden.weight" in arrays:
        width = arrays["lstm.hidden.weight"].shape[1]
        inputs |= {"hidden": (width,), "cell": (width,)}
        outputs |= {"next_hidden": (width,), "next_cell": (width,)}
        value = g.remember(value)
    value = g.dense(value, "head")
    weight, bias = (g.constant(arrays[f"output.{name}"]) for name in ("weight", "bias"))
    value = g.add("Gemm", value, weight, bias, transB=1)
    if arrays["squash"] > 0.5:
        g.add("Tanh", value, output="action")
    else:
        g.cut(value, 1.0, output="action")
    graph = helper.make_graph(g.nodes, "follower", _infos(inputs), _infos(outputs), g.constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=9)
    onnx.checker.check_model(model)
    return model


def _infos(shapes: Mapping[str, tuple[int, ...]]) -> list[onnx.ValueInfoProto]:
    return [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["batch", *shape]) for name, shape in shapes.items()]
