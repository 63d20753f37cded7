"""The two shipped leg forests: trained, weighed so that gamma = 0.3 means something, scored, written with a card."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import sklearn

from ...perception.legs.clusters import cluster_scan
from ...perception.legs.features import FEATURE_NAMES
from ...perception.legs.forest import LegForest
from ...slam.scan import LaserScan
from .evaluate_legs import FARTHEST_LEG, GAP, MATCH_DISTANCE, RATES, LegScores, cross_validate, score_legs
from .leg_recordings import SOURCE, LegRecording
from .leg_samples import Samples, simulated_samples
from .leg_scans import draw_scan
from .train_legs import TrainConfig, train_legs

GAMMA = 0.3
SEED_OF_TEST_SCANS = 1_000_003  # added to the seed, for simulated scans that no forest is trained on
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
        scores: On labelled recordings: every recording by a forest that never saw it; None without recordings.
        simulated: On simulated scans of another seed.
        card: Data, seeds, figures, limits.
    """

    forest: LegForest
    scores: LegScores | None
    simulated: LegScores
    card: dict[str, Any]


def train_simulation(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording] = (), people_free: Sequence[LaserScan] = ()
) -> TrainedLegs:
    """Train on simulated scans only; the recordings, if any, only score the result."""
    forest = train_legs(_simulated(config, seed), config, seed)
    test = simulated_test(config.test_scans, seed)
    forest = replace(forest, odds=odds_for(score_legs(forest, *test).threshold(config.false_legs_simulated)))
    scores = score_legs(forest, positive, people_free) if positive else None
    return _described("simulation", forest, scores, score_legs(forest, *test), config, seed)


def train_real(
    config: TrainConfig, seed: int, positive: Sequence[LegRecording], people_free: Sequence[LaserScan]
) -> TrainedLegs:
    """Train on simulated scans and all recordings; the scores come from forests that left a recording out."""
    simulated = _simulated(config, seed)

    def fold(legs: list[LegRecording], others: list[LaserScan]) -> LegForest:
        return train_legs(simulated, config, seed, legs, others)

    folds = cross_validate(fold, positive, people_free)
    odds = odds_for(LegScores.joined([scores for *_, scores in folds]).threshold(config.false_legs_recorded))
    scores = [score_legs(replace(forest, odds=odds), [legs], block) for forest, legs, block, _ in folds]
    forest = replace(train_legs(simulated, config, seed, positive, people_free), odds=odds)
    test = simulated_test(config.test_scans, seed)
    return _described("real", forest, LegScores.joined(scores), score_legs(forest, *test), config, seed)


def odds_for(threshold: float) -> float:
    """Return the prior odds that turn a vote of `threshold` into a confidence of gamma."""
    vote = float(np.clip(threshold, 0.01, 0.99))
    return GAMMA / (1.0 - GAMMA) * (1.0 - vote) / vote


def simulated_test(scans: int, seed: int) -> tuple[list[LegRecording], list[LaserScan]]:
    """Return simulated scans with people and their legs, and as many without people, of a seed of their own."""
    rng = np.random.default_rng(seed + SEED_OF_TEST_SCANS)
    with_people, legs = [], []
    for _ in range(scans):
        drawn = draw_scan(rng)
        clusters = cluster_scan(drawn.scan)
        hits = np.concatenate(([0], np.cumsum(drawn.is_leg[clusters.beams])))
        with_people.append(drawn.scan)
        legs.append(clusters.centres[(hits[clusters.end] - hits[clusters.start]) > 0.7 * clusters.sizes])
    empty = [draw_scan(rng, people=False).scan for _ in range(scans)]
    return [LegRecording("simulated", with_people, legs)], empty


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
        "people_free_scans": scores.scans,
        "recall_at_false_legs_per_people_free_scan": {str(rate): round(scores.recall(rate), 3) for rate in RATES},
        "at_confidence_0.3": {"recall": round(recall, 3), "false_legs_per_people_free_scan": round(false, 3)},
    }


def _simulated(config: TrainConfig, seed: int) -> Samples:
    return simulated_samples(np.random.default_rng(seed), config.scans)


def _described(
    name: str, forest: LegForest, scores: LegScores | None, simulated: LegScores, config: TrainConfig, seed: int
) -> TrainedLegs:
    real = name == "real"
    card = {
        "forest": name,
        "use": "recorded scans (default)" if real else "the environment",
        "command": f"tagalong train legs --forest {name} --data DIR --seed {seed} --out DIR",
        "seed": seed,
        "config": asdict(config),
        "simulated_data": f"{config.scans} scans of scripts/training/leg_scans.py",
        "recorded_data": f"positive_1 to 3, negative_2 of {SOURCE}" if real else "none",
        "confidence": "odds * vote / (odds * vote + 1 - vote); odds chosen so that 0.3 gives "
        + (
            f"{config.false_legs_recorded} false legs a scan in the left-out people-free recording"
            if real
            else f"{config.false_legs_simulated} false legs a scan in simulated people-free scans of another seed"
        ),
        "odds": forest.odds,
        "protocol": f"labelled legs within {FARTHEST_LEG} m, match {MATCH_DISTANCE} m one to one, all clusters of "
        + "people-free scans; "
        + (
            f"each recording and a third of negative_2 (and {GAP} scans beside it) left out of training"
            if real
            else "no recording was trained on"
        ),
        "recorded": None if scores is None else figures(scores),
        "simulated": figures(simulated),
        "limits": LIMITS,
        "scikit_learn": sklearn.__version__,
        "features": list(FEATURE_NAMES),
    }
    return TrainedLegs(forest, scores, simulated, card)
