"""The linear support vector machines that tell people from other things of their height."""

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
LENGTH = _OF_WINDOW + MEASURES_LENGTH
"""How many features there are."""


@dataclass(frozen=True, eq=False)
class PersonSvm:
    """Two linear classifiers with Platt's calibration: likelihood = 1 / (1 + exp(-(slope score + offset))).

    The first judges bodies, the second legs alone (`Candidates.legs`), whose windows are of another size.

    Attributes:
        weights: (2, LENGTH) float32.
        bias: (2,) of the score, weights features + bias.
        slope: (2,) of the calibration, positive.
        offset: (2,) of the calibration.
    """

    weights: NDArray[np.float32]
    bias: Array
    slope: Array
    offset: Array

    def __post_init__(self) -> None:
        if self.weights.shape != (2, LENGTH) or not (self.slope > 0.0).all():
            raise InputError(
                f"a classifier of people has 2 x {LENGTH} weights and positive slopes, got {self.weights.shape} and "
                f"{self.slope.tolist()}"
            )
        if not all(np.isfinite(each).all() for each in (self.weights, self.bias, self.slope, self.offset)):
            raise InputError("a classifier of people has finite weights only")

    @classmethod
    def load(cls, path: str | os.PathLike[str] = MODEL) -> "PersonSvm":
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
        for name, shape in (("weights", (2, LENGTH)), ("calibration", (3, 2))):
            if name not in content or content[name].shape != shape or content[name].dtype.kind != "f":
                got = f"{content[name].dtype} {shown(content[name].shape)}" if name in content else "none"
                raise InputError(
                    f"{named(path)} is no classifier of people (npz of `tagalong train people`): `{name}` must be "
                    f"floats of shape {shape}, got {got}"
                )
        try:
            return cls(content["weights"].astype(np.float32), *content["calibration"].astype(np.float64))
        except InputError as error:
            raise InputError(f"{named(path)}: {error}") from error

    def save(self, path: str | os.PathLike[str], card: dict[str, Any]) -> None:
        """Write the arrays to `path` (.npz) and `card` (what it was trained on, how well it does) beside it (.json)."""
        calibration = np.array([self.bias, self.slope, self.offset])
        with replacing(path) as temporary:
            np.savez_compressed(temporary, weights=self.weights, calibration=calibration)
        write_json(Path(path).with_suffix(".json"), card)

    def score(self, features: NDArray[np.float32], legs: NDArray[np.bool_]) -> Array:
        """Return (n,) how far each row of `features` (n, LENGTH) is on the side of people, as `legs` (n,) or bodies."""
        both = features.astype(np.float64) @ self.weights.astype(np.float64).T + self.bias
        return np.where(legs, both[:, 1], both[:, 0])

    def likelihood(self, features: NDArray[np.float32], legs: NDArray[np.bool_]) -> Array:
        """Return (n,) how likely each candidate with `features` (n, LENGTH) is somebody, in [0, 1]."""
        row = legs.astype(np.intp)
        return 1.0 / (1.0 + np.exp(-(self.slope[row] * self.score(features, legs) + self.offset[row])))


def candidate_features(planes: Planes, candidates: Candidates) -> NDArray[np.float32]:
    """Return (n, LENGTH): gradients' histograms of the candidates' windows, then the soft bins of their measures."""
    features = np.empty((len(candidates), LENGTH), dtype=np.float32)
    histograms = np.empty((len(candidates), _OF_WINDOW), dtype=np.float32)
    hog(candidate_windows(planes, candidates), SOFTNESS, histograms)
    features[:, :_OF_WINDOW] = histograms
    features[:, _OF_WINDOW:] = soft_bins(candidate_measures(planes, candidates))
    return features


def read_card() -> dict[str, Any]:
    """Return the card of the shipped classifier: data, command, seeds, figures, limits."""
    return read_json(MODEL.with_suffix(".json"))
