"""Reads and writes pose graphs of the plane in the text format of g2o.

Lines: `VERTEX_SE2 id x y theta` and `EDGE_SE2 i j dx dy dtheta I11 I12 I13 I22 I23 I33`, the upper triangle of the
information matrix; `FIX id` is ignored, poses are kept in the order of their lines.
"""

import math
import os
from pathlib import Path

import numpy as np

from ..errors import InputError, one_line, shown
from ..files.input import names_file
from ..files.output import write_text
from ..pose_graph.pose_graph import PoseGraph
from .text import MOST_POSES, numbered_lines

_UPPER = np.triu_indices(3)
_MOST_DIGITS = 20


@names_file
def read_g2o(path: str | os.PathLike[str]) -> PoseGraph:
    """Return the graph in a g2o file, plain or gzipped.

    Raises:
        InputError: If the file cannot be read, or a line is cut, holds no finite number, names an unknown vertex or one
            that was there before.
    """
    path = Path(path)
    names: dict[int, int] = {}
    poses: list[list[float]] = []
    edges: list[tuple[int, int]] = []
    values: list[list[float]] = []
    for number, line in numbered_lines(path, most_lines=2 * MOST_POSES):
        words = line.split()
        try:
            if words[:1] == ["VERTEX_SE2"]:
                if names.setdefault(_name(words[1]), len(poses)) != len(poses):
                    raise ValueError(f"vertex {words[1]} comes twice")
                poses.append(_floats(words[2:], 3))
            elif words[:1] == ["EDGE_SE2"]:
                edges.append((names[_name(words[1])], names[_name(words[2])]))
                values.append(_floats(words[3:], 9))
        except (ValueError, IndexError) as error:
            raise InputError(f"{path}, line {number}: {words[0]}: {one_line(str(error), 100)}") from error
        except KeyError as error:
            raise InputError(f"{path}, line {number}: EDGE_SE2: vertex {error} is not among those above") from error
    if not poses:
        raise InputError(f"{path}: no pose found; expected lines beginning with VERTEX_SE2")
    table = np.array(values, dtype=np.float64).reshape(-1, 9)
    information = np.zeros((len(table), 3, 3))
    information[:, _UPPER[0], _UPPER[1]] = table[:, 3:]
    information[:, _UPPER[1], _UPPER[0]] = table[:, 3:]
    ends = np.array(edges, dtype=np.int64).reshape(-1, 2)
    return PoseGraph.of(np.array(poses), ends, table[:, :3], information)


def write_g2o(path: str | os.PathLike[str], graph: PoseGraph) -> None:
    """Write `graph`, whole or not at all; robust kernels have no place in the format and are left out."""
    lines = [f"VERTEX_SE2 {k} {_text(pose)}" for k, pose in enumerate(graph.poses)]
    rows = zip(graph.edges, graph.measurements, graph.information, strict=True)
    lines += [f"EDGE_SE2 {i} {j} {_text(z)} {_text(omega[_UPPER])}" for (i, j), z, omega in rows]
    write_text(path, "\n".join(lines) + "\n")


def _name(word: str) -> int:
    """Return the number of a vertex, which may have as many digits as a whole number of 64 bits."""
    if len(word) > _MOST_DIGITS:
        raise ValueError(f"expected the number of a vertex, got {shown(word)}")
    return int(word)


def _floats(words: list[str], count: int) -> list[float]:
    if len(words) < count:
        raise ValueError(f"the line is cut: expected {count} numbers, got {len(words)}")
    values = [float(word) for word in words[:count]]
    if not all(map(math.isfinite, values)):
        raise ValueError(f"expected finite numbers, got {shown(' '.join(words[:count]))}")
    return values


def _text(values: np.ndarray) -> str:
    return " ".join(repr(value) for value in values.tolist())
