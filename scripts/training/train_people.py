"""Train the classifier of people in RGB-D frames on simulated frames."""

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression
from sklearn.svm import LinearSVC

from ...perception.rgbd.heads import find_candidates
from ...perception.rgbd.person_svm import LENGTH, PersonSvm, candidate_features
from ...perception.rgbd.planes import PlaneFinder
from .evaluate_people import PeopleScores, score_people
from .rgbd_frames import LabelledFrame, draw_frames

Array = NDArray[np.float64]

TRAIN_SCENES = ("corridor", "meeting_room", "office", "plain_corridor", "clutter", "doorway", "intersection")
TEST_SCENES = ("lab",)
MINE, OTHERS, FOUND = 0.5, 0.1, 0.3
"""A candidate shows somebody if this share of its pixels is that person's, and this share of the person's pixels is in
it; nobody if no more than the second share is anybody's. The rest is neither."""
LIMITS = (
    "simulated people only, upright, with the head or its place below the upper edge in sight; real recordings may "
    "differ; sitting people are not in the training"
)


@dataclass(frozen=True, kw_only=True)
class PeopleTrainConfig:
    """How the classifier is trained.

    Attributes:
        buildings: Buildings to train on.
        frames: Frames of each.
        test_buildings: Buildings to score on.
        penalty: Of errors against the margin's width (C of the support vector machine).
        folds: Parts of the buildings that are left out in turn, for the calibration.
    """

    buildings: int = 240
    frames: int = 12
    test_buildings: int = 40
    penalty: float = 0.005
    folds: int = 5


@dataclass(frozen=True, eq=False)
class PeopleSamples:
    """Candidates with what they really are.

    Attributes:
        features: (n, LENGTH) float32.
        is_person: (n,) bool.
        building: (n,) number of the building.
    """

    features: NDArray[np.float32]
    is_person: NDArray[np.bool_]
    building: NDArray[np.int64]


def training_frames(rng: np.random.Generator, config: PeopleTrainConfig) -> Iterator[list[LabelledFrame]]:
    """Yield the frames of one building after the other."""
    for _ in range(config.buildings):
        yield draw_frames(rng, TRAIN_SCENES, "training", "training", config.frames)


def collect(buildings: Iterable[list[LabelledFrame]]) -> PeopleSamples:
    """Return the candidates in all frames that are somebody, or nobody."""
    finder = PlaneFinder()
    features, persons, numbers = [np.empty((0, LENGTH), np.float32)], [np.empty(0, bool)], [np.empty(0, np.int64)]
    for number, frames in enumerate(buildings):
        for drawn in frames:
            planes = finder.find(drawn.frame)
            candidates = find_candidates(planes)
            person, sure = _truth(drawn.person, candidates.label, len(candidates))
            features.append(candidate_features(drawn.frame, planes, candidates)[sure])
            persons.append(person[sure])
            numbers.append(np.full(np.count_nonzero(sure), number))
    return PeopleSamples(np.concatenate(features), np.concatenate(persons), np.concatenate(numbers))


def _truth(
    person: NDArray[np.int32], label: NDArray[np.int32], count: int
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (n,) whether each candidate is somebody, and whether it is sure."""
    most, total = np.zeros(count), np.maximum(np.bincount(label[label >= 0], minlength=count), 1)
    anybody, share = np.zeros(count), np.zeros(count)
    for who in np.unique(person[person >= 0]):
        mine = np.bincount(label[(person == who) & (label >= 0)], minlength=count)
        anybody += mine
        best = mine > most
        share[best] = mine[best] / np.count_nonzero(person == who)
        most = np.maximum(most, mine)
    is_person = (most / total >= MINE) & (share >= FOUND)
    return is_person, is_person | (anybody / total <= OTHERS)


def fit_people(samples: PeopleSamples, config: PeopleTrainConfig) -> PersonSvm:
    """Fit scikit-learn's linear support vector machine; calibrate it on buildings left out in turn."""
    scores = np.empty(len(samples.is_person))
    fold = samples.building % config.folds
    for left_out in range(config.folds):
        machine = _machine(config).fit(samples.features[fold != left_out], samples.is_person[fold != left_out])
        scores[fold == left_out] = machine.decision_function(samples.features[fold == left_out])
    platt = LogisticRegression(C=1e3).fit(scores[:, None], samples.is_person)
    calibration = float(np.ravel(platt.coef_)[0]), float(np.ravel(platt.intercept_)[0])
    machine = _machine(config).fit(samples.features, samples.is_person)
    weights = machine.coef_[0].astype(np.float32)
    return PersonSvm(weights, float(np.ravel(machine.intercept_)[0]), *calibration)


def _machine(config: PeopleTrainConfig) -> LinearSVC:
    return LinearSVC(C=config.penalty, dual="auto", tol=1e-3, random_state=0)


def train_people(config: PeopleTrainConfig, seed: int) -> tuple[PersonSvm, dict[str, Any], PeopleScores]:
    """Return the classifier, its card, and how it does on clothing, poses, things and a scene not trained on."""
    samples = collect(training_frames(np.random.default_rng([seed, 0]), config))
    svm = fit_people(samples, config)
    rng = np.random.default_rng([seed, 1])
    tested = (draw_frames(rng, TEST_SCENES, "everyday", "unseen", config.frames) for _ in range(config.test_buildings))
    scores = score_people(svm, (frame for frames in tested for frame in frames))
    return svm, _card(svm, samples, scores, config, seed), scores


def _card(
    svm: PersonSvm, samples: PeopleSamples, scores: PeopleScores, config: PeopleTrainConfig, seed: int
) -> dict[str, Any]:
    return {
        "model": "people in RGB-D frames: HOG of brightness and depth, measures, linear SVM, Platt's calibration",
        "command": f"tagalong train people --seed {seed} --out DIR",
        "seed": seed,
        "config": asdict(config),
        "training": {
            "scenes": TRAIN_SCENES,
            "wardrobe": "training",
            "props": "training",
            "candidates": len(samples.is_person),
            "people": int(samples.is_person.sum()),
        },
        "test": {"scenes": TEST_SCENES, "wardrobe": "everyday", "props": "unseen", **scores.figures()},
        "calibration": {"slope": svm.slope, "offset": svm.offset, "fitted_on": "buildings left out in turn"},
        "limits": LIMITS,
        "scikit_learn": sklearn.__version__,
    }
