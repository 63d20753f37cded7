"""The network that tells people from other things of their height."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.files.input import checked_name, named
from ...slam.files.output import read_arrays, read_json, replacing, write_json
from .heads import Candidates
from .hog import hog, hog_length
from .measures import MEASURES_LENGTH, candidate_measures, soft_bins
from .planes import Planes
from .windows import CHANNELS, COLUMNS, ROWS, candidate_windows

Array = NDArray[np.float64]

MODEL = Path(__file__).resolve().parent.parent / "models" / "people_rgbd.npz"
DEPTH_MODEL = MODEL.with_name("people_rgbd_depth.npz")
"""The classifier for frames of depth alone: it was trained without the gradients of brightness."""
SOFTNESS = 0.02
"""Of the blocks' norm: noise on an even surface is no pattern."""
LUMA_LENGTH = hog_length(ROWS, COLUMNS, 1)
"""So many of the features, the first ones, tell of brightness."""
_OF_WINDOW = hog_length(ROWS, COLUMNS, CHANNELS)
LENGTH = _OF_WINDOW + MEASURES_LENGTH + 1
"""How many features there are; the last one is 1 for legs alone, whose windows are of another size, else 0."""


@dataclass(frozen=True, eq=False)
class PersonClassifier:
    """A network of one hidden layer: likelihood = 1 / (1 + exp(-(v max(W x + b, 0) + c))).

    Attributes:
        hidden: (LENGTH + 1, k) float32: W, a column for each of k units, and b in the last row.
        output: (k + 1,) float32: v, and c at the end; Platt's calibration is in both.
    """

    hidden: NDArray[np.float32]
    output: NDArray[np.float32]

    def __post_init__(self) -> None:
        rows, units = self.hidden.shape if self.hidden.ndim == 2 else (0, 0)
        if rows != LENGTH + 1 or not units or self.output.shape != (units + 1,):
            raise InputError(
                f"a classifier of people has a `hidden` layer of {LENGTH + 1} x k and k + 1 numbers of `output`, got "
                f"{shown(self.hidden.shape)} and {shown(self.output.shape)}"
            )
        if not (np.isfinite(self.hidden).all() and np.isfinite(self.output).all()):
            raise InputError("a classifier of people has finite weights only")

    @classmethod
    def load(cls, path: str | os.PathLike[str] = MODEL) -> "PersonClassifier":
        """Load the shipped classifier, or one that `tagalong train people` wrote to `path`.

        Raises:
            InputError: If there is none, or the file is damaged or made for other features.
        """
        if not checked_name(path).exists():
            raise InputError(f"there is no classifier of people at {named(path)}")
        try:
            content = read_arrays(path)
        except InputError as error:
            raise InputError(f"no classifier of people (npz of `tagalong train people`): {error}") from None
        for name in ("hidden", "output"):
            if name not in content or content[name].dtype != np.float32:
                got = str(content[name].dtype) if name in content else "none"
                raise InputError(
                    f"{named(path)} is no classifier of people (npz of `tagalong train people`): `{name}` must be "
                    f"float32, got {got}"
                )
        try:
            return cls(content["hidden"], content["output"])
        except InputError as error:
            raise InputError(f"{named(path)}: {error}") from error

    def save(self, path: str | os.PathLike[str], card: dict[str, Any]) -> None:
        """Write the arrays to `path` (.npz) and `card` (what it was trained on, how well it does) beside it (.json)."""
        with replacing(path) as temporary:
            np.savez_compressed(temporary, hidden=self.hidden, output=self.output)
        write_json(Path(path).with_suffix(".json"), card)

    def score(self, features: NDArray[np.float32]) -> Array:
        """Return (n,) the log odds of each candidate with `features` (n, LENGTH) being somebody."""
        hidden, output = self.hidden.astype(np.float64), self.output.astype(np.float64)
        units = np.maximum(features @ hidden[:-1] + hidden[-1], 0.0)
        return units @ output[:-1] + output[-1]

    def likelihood(self, features: NDArray[np.float32]) -> Array:
        """Return (n,) how likely each candidate with `features` (n, LENGTH) is somebody, in [0, 1]."""
        return 0.5 * (1.0 + np.tanh(0.5 * self.score(features)))


def candidate_features(planes: Planes, candidates: Candidates) -> NDArray[np.float32]:
    """Return (n, LENGTH): gradients' histograms of the candidates' windows, soft bins of their measures, legs alone."""
    features = np.empty((len(candidates), LENGTH), dtype=np.float32)
    histograms = np.empty((len(candidates), _OF_WINDOW), dtype=np.float32)
    hog(candidate_windows(planes, candidates), SOFTNESS, histograms)
    features[:, :_OF_WINDOW] = histograms
    features[:, _OF_WINDOW:-1] = soft_bins(candidate_measures(planes, candidates))
    features[:, -1] = candidates.legs
    return features


def read_card() -> dict[str, Any]:
    """Return the card of the shipped classifier: data, command, seeds, figures, limits."""
    return read_json(MODEL.with_suffix(".json"))
