"""The random forest that says how much a cluster looks like a leg."""

import os
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.files.input import checked_name, named
from ...slam.files.output import read_arrays, read_json, replacing, write_json
from ...slam.scan import LaserScan
from .clusters import Clusters
from .detection_kernel import leg_confidence
from .features import FEATURE_NAMES, described_by
from .forest_kernel import PackedForest, is_sound, packed, vote

MODELS = Path(__file__).resolve().parent.parent / "models"
SHIPPED = ("real", "simulation")
_MOST_ODDS = 1e6
_ARRAYS = {"feature": np.int8, "value": np.float32, "right": np.int32, "roots": np.int32, "odds": np.float64}


@dataclass(frozen=True, eq=False)
class LegForest:
    """A trained forest as flat arrays, in depth-first order: a node's left child is the next node.

    Attributes:
        feature: (n,) index into `FEATURE_NAMES` that an inner node asks for; -1 in a leaf.
        value: (n,) threshold of an inner node, share of legs in a leaf.
        right: (n,) right child of an inner node; 0 in a leaf.
        roots: (t,) first node of each tree.
        odds: Prior odds by which the vote is weighed: confidence = odds p / (odds p + 1 - p).
    """

    feature: NDArray[np.int8]
    value: NDArray[np.float32]
    right: NDArray[np.int32]
    roots: NDArray[np.int32]
    odds: float = 1.0

    @classmethod
    def load(cls, name_or_path: str | os.PathLike[str]) -> "LegForest":
        """Load a shipped forest ("real" or "simulation") or one that `tagalong train legs` wrote to a path.

        A shipped one is the same object for all who ask: a megabyte that many environments step through stays in the
        processor's cache.

        Raises:
            InputError: If there is no such forest, or the file is damaged or made for other features.
        """
        return _shipped(str(name_or_path)) if str(name_or_path) in SHIPPED else cls._read(Path(name_or_path))

    @classmethod
    def _read(cls, path: Path) -> "LegForest":
        if not os.path.exists(checked_name(path)):  # which says no, too, to a name that is too long
            raise InputError(f"no leg forest {shown(str(path))}: give {' or '.join(SHIPPED)}, or a file")
        try:
            content = read_arrays(path)
        except InputError as error:
            raise InputError(f"not a leg forest (npz of `tagalong train legs`): {error}") from None
        missing = [name for name in ("feature_names", *_ARRAYS) if name not in content]
        if missing:
            raise InputError(f"{named(path)} is not a leg forest (npz of `tagalong train legs`): no {missing}")
        names = tuple(str(name) for name in content["feature_names"].ravel())
        if names != FEATURE_NAMES:
            raise InputError(f"{path} was trained on other features ({len(names)}) than these ({len(FEATURE_NAMES)})")
        for name, kind in _ARRAYS.items():
            array, dimensions = content[name], 0 if name == "odds" else 1
            if array.dtype != kind or array.ndim != dimensions:
                rule = f"of {np.dtype(kind).name} with {dimensions} dimensions"
                raise InputError(f"{path}: `{name}` must be {rule}, got {array.dtype} with {array.ndim}")
        forest = cls(**{**{name: content[name] for name in _ARRAYS}, "odds": float(content["odds"])})
        if not forest._is_sound():
            raise InputError(f"{path} is damaged: its trees do not end in leaves")
        return forest

    def save(self, path: str | os.PathLike[str], card: dict[str, Any]) -> None:
        """Write the arrays to `path` (.npz) and `card` (what it was trained on, how well it does) beside it (.json)."""
        arrays: dict[str, Any] = {key: np.asarray(getattr(self, key), kind) for key, kind in _ARRAYS.items()}
        with replacing(path) as temporary:
            np.savez_compressed(temporary, feature_names=np.array(FEATURE_NAMES), **arrays)
        write_json(Path(path).with_suffix(".json"), card)

    def vote(self, features: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return (m,) the share of legs in the leaves that `features` (m, F) fall into: sklearn's `predict_proba`."""
        share = np.empty(len(features))
        vote(self.packed, features, share)
        return share

    def confidence(self, scan: LaserScan, clusters: Clusters) -> NDArray[np.float64]:
        """Return (m,) in [0, 1] how much each cluster of `scan` looks like a leg; 0 for clusters too wide for one."""
        return leg_confidence(*described_by(scan, clusters), self.packed)

    @cached_property
    def packed(self) -> PackedForest:
        """The same as kernels take it."""
        return packed(self.feature, self.value, self.right, self.roots, self.odds)

    def _is_sound(self) -> bool:
        shapes = {self.feature.shape, self.value.shape, self.right.shape}
        if len(shapes) != 1 or self.feature.ndim != 1 or self.roots.ndim != 1 or not 0.0 < self.odds <= _MOST_ODDS:
            return False
        leaves = self.value[self.feature < 0]
        in_bounds = np.isfinite(self.value).all() and (leaves >= 0.0).all() and (leaves <= 1.0).all()
        return bool(in_bounds and is_sound(self.feature, self.right, self.roots, len(FEATURE_NAMES)))


@lru_cache(maxsize=len(SHIPPED))
def _shipped(name: str) -> LegForest:
    forest = LegForest._read(MODELS / f"legs_{name}.npz")
    forest.vote(np.zeros((1, len(FEATURE_NAMES)), np.float32))  # packs its nodes, for processes that fork, too
    for array in (forest.feature, forest.value, forest.right):
        array.flags.writeable = False
    return forest


def read_card(name: str) -> dict[str, Any]:
    """Return the card of a shipped forest: data, command, seeds, figures, limits."""
    return read_json(MODELS / f"legs_{name}.json")
