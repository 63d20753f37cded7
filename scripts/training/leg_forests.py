"""The two shipped leg forests: trained, weighed so that gamma = 0.3 means something, scored, written with a card."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import sklearn

from ...perception.legs.features import FEATURE_NAMES
from ...perception.legs.forest import LegForest
from ...slam.scan import LaserScan
from .evaluate_legs import (
    FARTHEST_LEG,
    FARTHEST_SIMULATED_LEG,
    GAP,
    MATCH_DISTANCE,
    RATES,
    LegScores,
    cross_validate,
    score_labelled,
    score_legs,
)
from .leg_recordings import SOURCE, LegRecording
from .leg_samples import Samples, driven_samples, simulated_samples
from .leg_scans import LabelledScan, draw_scan
from .train_legs import TrainConfig, train_legs
from .world_scans import draw_drive

GAMMA = 0.3
Fold = tuple[LegForest, LegRecording, list[LaserScan]]
"""A forest, and the recording and the people-free scans that it was not trained on."""
RECORDED = "recordings not trained on"
LIMITS = (
    "Ankle to shin height, 0.25 to 1 degree between beams, legs within 6 m, one scan at a time. Seats and tables with "
    "leg-like feet give false legs; a tracker has to tell them by their standing still. Trained with clusters of "
    "alpha 0.13 m and beta 3."
)


@dataclass(frozen=True, eq=False)
class TrainedLegs:
    """A forest, how it scores on scans that it was not trained on, and its card.

    Attributes:
        forest: Trained on everything.
        scores: By name of the data: simulated scans of another seed, other drives, recordings left out.
        card: Data, seeds, figures, limits.
    """

    forest: LegForest
    scores: dict[str, LegScores]
    card: dict[str, Any]


def train_simulation(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording] = (), people_free: Sequence[LaserScan] = ()
) -> TrainedLegs:
    """Train on simulated scans and drives only; the recordings, if any, only score the result."""
    driven = driven_samples(np.random.default_rng([seed, 1]), config.drives)
    forest = train_legs(Samples.joined([_simulated(config, seed), driven]), config, seed)
    test = held_out_drives(config.test_drives, seed)
    odds = odds_for(score_labelled(forest, test).threshold(config.false_legs_driven))
    forest = replace(forest, odds=odds)
    scores = {"drives": score_labelled(forest, test), "simulated scans": _simulated_scores(forest, config, seed)}
    if positive:
        scores[RECORDED] = score_legs(forest, positive, people_free)
    return TrainedLegs(forest, scores, _card("simulation", forest, scores, config, seed))


def train_real(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording], people_free: Sequence[LaserScan]
) -> TrainedLegs:
    """Train on simulated scans and all recordings; the scores come from forests that left a recording out."""
    simulated = _simulated(config, seed)
    folds = _folds(simulated, config, seed, positive, people_free)
    odds = folds[0][0].odds
    left_out = [score_legs(forest, [legs], block) for forest, legs, block in folds]
    forest = replace(train_legs(simulated, config, seed, positive, people_free), odds=odds)
    scores = {"simulated scans": _simulated_scores(forest, config, seed), RECORDED: LegScores.joined(left_out)}
    return TrainedLegs(forest, scores, _card("real", forest, scores, config, seed))


def left_out_forests(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording], people_free: Sequence[LaserScan]
) -> list[Fold]:
    """Return for each of `positive` a forest trained as the one for real scans, but without it and without a block of
    the people-free scans: (forest, recording, block)."""
    return _folds(_simulated(config, seed), config, seed, positive, people_free)


def _folds(
    simulated: Samples,
    config: TrainConfig,
    seed: int,
    positive: Sequence[LegRecording],
    people_free: Sequence[LaserScan],
) -> list[Fold]:
    def fold(legs: list[LegRecording], others: list[LaserScan]) -> LegForest:
        return train_legs(simulated, config, seed, legs, others)

    folds = cross_validate(fold, positive, people_free)
    odds = odds_for(LegScores.joined([scores for *_, scores in folds]).threshold(config.false_legs_recorded))
    return [(replace(forest, odds=odds), legs, block) for forest, legs, block, _ in folds]


def odds_for(threshold: float) -> float:
    """Return the prior odds that turn a vote of `threshold` into a confidence of gamma."""
    vote = float(np.clip(threshold, 0.01, 0.99))
    return GAMMA / (1.0 - GAMMA) * (1.0 - vote) / vote


def held_out_drives(drives: int, seed: int) -> list[LabelledScan]:
    """Return the scans of drives that no forest of this seed is trained on."""
    rng = np.random.default_rng([seed, 2])
    return [scan for _ in range(drives) for scan in draw_drive(rng)]


def _simulated_scores(forest: LegForest, config: TrainConfig, seed: int) -> LegScores:
    """Score on simulated scans of a seed of their own: legs of those with people, false legs of those without."""
    rng = np.random.default_rng([seed, 3])
    with_people = score_labelled(forest, [draw_scan(rng) for _ in range(config.test_scans)])
    empty = score_labelled(forest, [draw_scan(rng, people=False) for _ in range(config.test_scans)])
    return replace(empty, legs=with_people.legs)


def write(trained: TrainedLegs, folder: Path) -> Path:
    """Write the forest and its card into `folder`; return the path of the forest."""
    path = folder / f"legs_{trained.card['forest']}.npz"
    trained.forest.save(path, trained.card)
    return path


def figures(scores: LegScores) -> dict[str, Any]:
    """Return the curve of `scores`, and what gamma means on it."""
    recall, false = scores.at(GAMMA)
    return {
        "legs": len(scores.legs),
        "scans_of_false_legs": scores.scans,
        "recall_at_false_legs_per_scan": {str(rate): round(scores.recall(rate), 3) for rate in RATES},
        "at_confidence_0.3": {"recall": round(recall, 3), "false_legs_per_scan": round(false, 3)},
    }


def _simulated(config: TrainConfig, seed: int) -> Samples:
    return simulated_samples(np.random.default_rng([seed, 0]), config.scans)


def _card(name: str, forest: LegForest, scores: dict[str, LegScores], config: TrainConfig, seed: int) -> dict[str, Any]:
    real = name == "real"
    gamma = (
        f"{config.false_legs_recorded} false legs a scan of the people-free recording, by forests not trained on it"
        if real
        else f"{config.false_legs_driven} false legs a scan of drives that it was not trained on"
    )
    left_out = f"each recording and a third of negative_2 (with {GAP} scans beside it) left out of training"
    return {
        "forest": name,
        "use": "recorded scans (default)" if real else "the environment",
        "command": f"tagalong train legs --forest {name} --data DIR --seed {seed} --out DIR",
        "seed": seed,
        "config": asdict(config),
        "simulated_data": f"{config.scans} scans of scripts/training/leg_scans.py"
        + ("" if real else f", {config.drives} drives of scripts/training/world_scans.py"),
        "recorded_data": f"positive_1 to 3, negative_2 of {SOURCE}" if real else "none",
        "confidence": f"odds * vote / (odds * vote + 1 - vote); odds such that {GAMMA} gives {gamma}",
        "odds": forest.odds,
        "protocol": f"recordings: labelled legs within {FARTHEST_LEG} m, match {MATCH_DISTANCE} m one to one, against "
        f"all clusters of people-free scans, {left_out if real else 'none of them trained on'}; simulated scans and "
        f"drives: leg clusters within {FARTHEST_SIMULATED_LEG} m, other seeds than in training",
        "scores": {data: figures(score) for data, score in scores.items()},
        "limits": LIMITS,
        "scikit_learn": sklearn.__version__,
        "features": list(FEATURE_NAMES),
    }
