"""Train the leg forests: simulated scans alone, or with recorded ones."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import RandomForestClassifier

from ...perception.legs.forest import LegForest
from ...slam.scan import LaserScan
from .leg_recordings import LegRecording
from .leg_samples import Samples, labelled_samples, people_free_samples, simulated_samples


@dataclass(frozen=True, kw_only=True)
class TrainConfig:
    """How the forests are trained."""

    scans: int = 10000
    """Simulated scans."""
    trees: int = 48
    """Trees of a forest."""
    depth: int = 14
    """Deepest leaf."""
    leaf: int = 5
    """Fewest samples in a leaf."""
    tried: int = 10
    """Features tried at each split."""
    leg_weight: float = 10.0
    """Weight of a recorded leg against a simulated cluster."""
    people_free_weight: float = 3.0
    """Weight of a recorded people-free cluster against a simulated one."""


def train_forest(samples: Samples, weights: NDArray[np.float64], config: TrainConfig, seed: int) -> LegForest:
    """Fit a random forest and return it as flat arrays."""
    return flatten_forest(fit(samples, weights, config, seed))


def fit(samples: Samples, weights: NDArray[np.float64], config: TrainConfig, seed: int) -> RandomForestClassifier:
    """Fit scikit-learn's random forest to weighted samples."""
    forest = RandomForestClassifier(
        n_estimators=config.trees,
        max_depth=config.depth,
        min_samples_leaf=config.leaf,
        max_features=config.tried,  # pyright: ignore[reportArgumentType]  (its stub forgets int)
        random_state=seed,
        n_jobs=1,
    )
    return forest.fit(samples.features, samples.is_leg, sample_weight=weights)


def recorded_samples(
    positive: Sequence[LegRecording], people_free: Sequence[LaserScan], config: TrainConfig
) -> tuple[Samples, NDArray[np.float64]]:
    """Return samples and weights of recordings: labelled legs, and everything in people-free scans."""
    legs = Samples.joined([Samples.none(), *(labelled_samples(r.scans, r.legs) for r in positive)])
    others = people_free_samples(people_free)
    weights = np.repeat([config.leg_weight, config.people_free_weight], [len(legs.is_leg), len(others.is_leg)])
    return Samples.joined([legs, others]), weights


def train_legs(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording] = (), people_free: Sequence[LaserScan] = ()
) -> LegForest:
    """Train on simulated scans and the recordings given; the same seed gives the same forest."""
    simulated = simulated_samples(np.random.default_rng(seed), config.scans)
    recorded, weights = recorded_samples(positive, people_free, config)
    samples = Samples.joined([simulated, recorded])
    return train_forest(samples, np.concatenate((np.ones(len(simulated.is_leg)), weights)), config, seed)


def flatten_forest(forest: RandomForestClassifier, odds: float = 1.0) -> LegForest:
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
