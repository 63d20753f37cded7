"""Models of perception that are loaded: leg forests, the classifier of people."""

from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.arrays import edits, packed
from fuzzer.border import Border, Input, require
from fuzzer.files import put
from fuzzer.sanity import finite
from tagalong.perception import LegForest
from tagalong.perception.legs.features import FEATURE_NAMES
from tagalong.perception.rgbd.person_classifier import LENGTH, PersonClassifier

FILE = "model.npz"


def _small_forest() -> dict[str, np.ndarray]:
    """Return two trees of a question and two leaves each."""
    return {
        "feature": np.array([0, -1, -1] * 2, np.int8), "value": np.array([0.5, 0.2, 0.8] * 2, np.float32),
        "right": np.array([2, 0, 0, 5, 0, 0], np.int32), "roots": np.array([0, 3], np.int32),
        "odds": np.array(1.5), "feature_names": np.array(FEATURE_NAMES),
    }  # fmt: skip


def _forest(value: Input, folder: Path) -> Any:
    forest = LegForest.load(put(folder, FILE, packed(_small_forest(), value)))
    votes = forest.vote(np.random.default_rng(0).normal(size=(50, len(FEATURE_NAMES))).astype(np.float32))
    return forest.odds, votes


def _sane_forest(result: Any) -> None:
    odds, votes = result
    require(0.0 < odds <= 1e9, f"odds {odds}")
    finite(votes, "votes", 1.0)


def _small_classifier() -> dict[str, np.ndarray]:
    """Return a network of two units."""
    return {"hidden": np.full((LENGTH + 1, 2), 0.01, np.float32), "output": np.array([1.0, -2.0, 0.5], np.float32)}


def _classifier(value: Input, folder: Path) -> Any:
    classifier = PersonClassifier.load(put(folder, FILE, packed(_small_classifier(), value)))
    return classifier.likelihood(np.ones((3, LENGTH), np.float32))


BORDERS = (
    Border(
        name="models.forest", make=lambda rng: edits(rng, list(_small_forest())), call=_forest, sane=_sane_forest,
        file=FILE, ms=1.7,
    ),
    Border(
        name="models.person_classifier", make=lambda rng: edits(rng, list(_small_classifier())), call=_classifier,
        file=FILE, sane=lambda likelihood: finite(likelihood, "likelihood", 1.0), ms=1.2,
    ),
)  # fmt: skip
