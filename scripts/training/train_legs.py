"""Train the leg forests: simulated scans alone, or with recorded ones."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesClassifier

from ...perception.legs.features import FEATURE_NAMES
from ...perception.legs.forest import LegForest
from ...slam.scan import LaserScan
from .leg_pasting import pasted_samples
from .leg_recordings import LegRecording
from .leg_samples import Samples, labelled_samples, people_free_samples


@dataclass(frozen=True, kw_only=True)
class TrainConfig:
    """How the forests are trained."""

    scans: int = 6000
    """Simulated scans."""
    drives: int = 120
    """Drives of half a minute in the environment's buildings, for the forest `simulation`."""
    test_drives: int = 16
    """Drives to score that forest on."""
    test_scans: int = 500
    """Simulated scans with, and as many without people, to score a forest on."""
    false_legs_recorded: float = 0.5
    """False legs a recorded people-free scan at gamma, for the forest `real`."""
    false_legs_driven: float = 0.2
    """False legs a scan of a drive in the environment at gamma, for the forest `simulation`."""
    trees: int = 40
    """Trees of a forest."""
    depth: int = 16
    """Deepest leaf."""
    leaf: int = 5
    """Fewest samples in a leaf."""
    tried: int = 16
    """Features tried at each split."""
    unused: tuple[str, ...] = ("far_beside_low", "far_beside_high")
    """Features that the forest `simulation` does without: they differ too much between its rooms and recorded ones."""
    leg_weight: float = 100.0
    """Weight of a recorded leg against a simulated cluster."""
    copies: int = 3
    """How often each labelled scan's legs are put before another background."""
    pasted_weight: float = 0.5
    """Weight of all copies of a leg together against the leg where it stood."""
    people_free_weight: float = 25.0
    """Weight of a recorded people-free cluster against a simulated one."""


def fit(
    samples: Samples, weights: NDArray[np.float64], config: TrainConfig, seed: int, unused: Sequence[str] = ()
) -> ExtraTreesClassifier:
    """Fit a forest of extremely randomized trees to weighted samples; features in `unused` are hidden from it.

    Geurts, Ernst, Wehenkel, "Extremely randomized trees", Machine Learning 63, 2006. Thresholds drawn at random carry
    over better to lasers and buildings that were not trained on than the best ones do: of legs in recordings left out,
    trained on simulated scans alone, 75 % (random forest: 70 %) at 5 % of the other clusters.
    """
    features = samples.features.copy()
    features[:, [FEATURE_NAMES.index(name) for name in unused]] = 0.0
    forest = ExtraTreesClassifier(
        n_estimators=config.trees,
        criterion="entropy",  # found more recorded legs than gini, at every false rate
        max_depth=config.depth,
        min_samples_leaf=config.leaf,
        max_features=config.tried,  # pyright: ignore[reportArgumentType]  (its stub forgets int)
        random_state=seed,
        n_jobs=1,
    )
    return forest.fit(features, samples.is_leg, sample_weight=weights)


def recorded_samples(
    positive: Sequence[LegRecording], people_free: Sequence[LaserScan], config: TrainConfig, seed: int
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples and weights of recordings: labelled legs where they stood and before other backgrounds, and
    everything in people-free scans."""
    legs = Samples.joined([Samples.none(), *(labelled_samples(r.scans, r.legs) for r in positive)])
    pasted = pasted_samples(np.random.default_rng(seed), positive, people_free, config.copies)
    others = people_free_samples(people_free)
    counts = [len(part.is_leg) for part in (legs, pasted, others)]
    pasted_weight = config.pasted_weight * config.leg_weight / max(config.copies, 1)
    weights = np.repeat([config.leg_weight, pasted_weight, config.people_free_weight], counts)
    return Samples.joined([legs, pasted, others]), weights


def train_legs(
    simulated: Samples,
    config: TrainConfig,
    seed: int,
    positive: Sequence[LegRecording] = (),
    people_free: Sequence[LaserScan] = (),
) -> LegForest:
    """Train on simulated clusters and the recordings given; the same seed gives the same forest."""
    recorded, weights = recorded_samples(positive, people_free, config, seed)
    samples = Samples.joined([simulated, recorded])
    weights = np.concatenate((np.ones(len(simulated.is_leg)), weights))
    return flatten_forest(fit(samples, weights, config, seed, () if len(recorded.is_leg) else config.unused))


def flatten_forest(forest: ExtraTreesClassifier, odds: float = 1.0) -> LegForest:
    """Return scikit-learn's forest as flat arrays in depth-first order.

    Features are float32: a threshold rounded down to float32 parts them exactly as the float64 one does.
    """
    feature, value, right, roots = [], [], [], []
    for estimator in forest.estimators_:
        tree = estimator.tree_
        order = np.arange(tree.node_count)  # scikit-learn grows depth-first: the left child is the next node
        inner = tree.children_left >= 0
        if not np.array_equal(tree.children_left[inner], order[inner] + 1):
            raise AssertionError("scikit-learn did not grow the tree depth-first")
        share = tree.value[:, 0, 1] / tree.value[:, 0].sum(axis=1)
        roots.append(sum(len(f) for f in feature))
        feature.append(np.where(inner, tree.feature, -1).astype(np.int8))
        value.append(np.where(inner, _rounded_down(tree.threshold), share).astype(np.float32))
        right.append(np.where(inner, tree.children_right + roots[-1], 0).astype(np.int32))
    nodes = np.concatenate(feature), np.concatenate(value), np.concatenate(right)
    return LegForest(*nodes, np.array(roots, np.int32), odds)


def _rounded_down(values: NDArray[np.float64]) -> NDArray[np.float32]:
    single = values.astype(np.float32)
    return np.where(single > values, np.nextafter(single, np.float32(-np.inf)), single)
