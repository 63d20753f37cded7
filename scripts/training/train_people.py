"""Train the classifier of people in RGB-D frames: on simulated frames under any mount, and on recorded ones."""

import os
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import chain
from typing import Any

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.exceptions import ConvergenceWarning
from sklearn.linear_model import LogisticRegression
from sklearn.neural_network import MLPClassifier

from ...perception.rgbd.frame import RgbdFrame, grey
from ...perception.rgbd.heads import find_candidates
from ...perception.rgbd.person_classifier import LENGTH, LUMA_LENGTH, PersonClassifier, candidate_features
from ...perception.rgbd.planes import PlaneFinder
from ...slam.errors import InputError
from .evaluate_people import PeopleScores, score_people
from .rgbd_cameras import draw_camera, floor_in_sight, shake_depth
from .rgbd_frames import LabelledFrame, draw_frames
from .rgbd_props import REACH_M
from .rgbd_recordings import COLUMNS, recorded_candidates

Array = NDArray[np.float64]

TRAIN_SCENES = ("corridor", "meeting_room", "office", "plain_corridor", "clutter", "doorway", "intersection")
TRAIN_PROPS = tuple(f"training {fold}" for fold in range(5))
"""Kinds of things, one of them in each building: what leaves out its buildings has not seen these things, either."""
TEST_SCENES = ("lab",)
MINE, OTHERS, FOUND = 0.5, 0.1, 0.3
"""A candidate shows somebody if this share of its pixels is that person's, and this share of the person's pixels is in
it; nobody if no more than the second share is anybody's. The rest is neither."""
LIMITS = (
    "simulated people who stand, walk and sit on chairs; recorded frames of few sources, most of them without anybody; "
    "nobody lies or crouches"
)


@dataclass(frozen=True, kw_only=True)
class PeopleTrainConfig:
    """How the classifier is trained.

    Attributes:
        buildings: Buildings to train on.
        frames: Frames of each.
        test_buildings: Buildings to score on.
        tilted_buildings: Further buildings, all seen by cameras of any mount, which are most of what shows legs alone.
        units: Of the hidden layer.
        decay: Of the weights, as a penalty on their squares.
        rate: Of learning.
        rounds: Passes over the samples.
        folds: Parts of the buildings that are left out in turn, for the calibration.
        any_mount: Share of these that are seen by a camera of any mount (`rgbd_cameras.py`), the others by the usual
            level one.
        level_buildings: Further buildings, all seen by the usual camera.
        stereo: Share of these cameras that measure by stereo.
        seated: Share of the frames with somebody on a chair.
        recorded: How many simulated candidates a recorded one weighs as much as.
    """

    buildings: int = 400
    frames: int = 12
    test_buildings: int = 40
    folds: int = 5
    any_mount: float = 0.5
    level_buildings: int = 200
    tilted_buildings: int = 480
    units: int = 64
    decay: float = 0.3
    rate: float = 5e-4
    rounds: int = 15
    stereo: float = 0.4
    seated: float = 0.3
    recorded: float = 3.0


@dataclass(frozen=True, eq=False)
class PeopleSamples:
    """Candidates with what they really are.

    Attributes:
        features: (n, LENGTH) float32.
        is_person: (n,) bool.
        building: (n,) number of the building; of a recording that of its source.
        weight: (n,) how much each counts.
    """

    features: NDArray[np.float32]
    is_person: NDArray[np.bool_]
    building: NDArray[np.int64]
    weight: Array


def training_frames(
    rng: np.random.Generator, config: PeopleTrainConfig, first: int = 0
) -> Iterator[list[LabelledFrame]]:
    """Yield the frames of one building after the other; their numbers, `first` and on, say what things are in them."""
    for number in range(first, first + config.buildings):
        camera = draw_camera(rng) if rng.random() < config.any_mount else None
        props = TRAIN_PROPS[number % len(TRAIN_PROPS)]
        reach = floor_in_sight(camera) if camera else REACH_M
        frames = draw_frames(rng, TRAIN_SCENES, "training", props, config.frames, camera, config.seated, reach)
        if camera is not None and rng.random() < config.stereo:
            frames = [replace(f, frame=shake_depth(f.frame, rng, rng.uniform(0.002, 0.01))) for f in frames]
        yield frames


def collect(buildings: Iterable[list[LabelledFrame]]) -> PeopleSamples:
    """Return the candidates in all frames that are somebody, or nobody."""
    finder = PlaneFinder()
    features, persons = [np.empty((0, LENGTH), np.float32)], [np.empty(0, bool)]
    numbers = [np.empty(0, np.int64)]
    for number, frames in enumerate(buildings):
        for drawn in frames:
            planes = finder.find(drawn.frame)
            candidates = find_candidates(planes)
            person, sure = _truth(drawn.person, candidates.label, len(candidates))
            features.append(candidate_features(planes, candidates)[sure])
            persons.append(person[sure])
            numbers.append(np.full(np.count_nonzero(sure), number))
    weight = np.ones(sum(map(len, persons)))
    return PeopleSamples(np.concatenate(features), np.concatenate(persons), np.concatenate(numbers), weight)


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


def collect_recorded(folder: str | os.PathLike[str], weight: float) -> tuple[PeopleSamples, tuple[str, ...]]:
    """Return the candidates in the recorded frames of `folder`, each with the number of its source, and the sources."""
    parts = list(recorded_candidates(folder))
    sources = tuple(sorted({source for source, *_ in parts}))
    numbers = np.concatenate([np.full(len(person), sources.index(source)) for source, _, person in parts])
    features, persons = (np.concatenate([part[k] for part in parts]) for k in (1, 2))
    return PeopleSamples(features, persons, numbers, np.full(len(persons), weight / len(COLUMNS))), sources


def with_recorded(simulated: PeopleSamples, recorded: PeopleSamples, without: int | None = None) -> PeopleSamples:
    """Return all of them together, but for those `recorded` at one source."""
    kept = recorded.building != without
    after = recorded.building + (simulated.building.max(initial=-1) + 1)
    recorded = replace(recorded, building=after)
    names = PeopleSamples.__dataclass_fields__
    return PeopleSamples(*(np.concatenate((getattr(simulated, n), getattr(recorded, n)[kept])) for n in names))


def without_colour(samples: PeopleSamples) -> PeopleSamples:
    """Return the samples as they would be of frames of depth alone: no gradient of brightness."""
    features = samples.features.copy()
    features[:, :LUMA_LENGTH] = 0.0
    return replace(samples, features=features)


def fit_people(samples: PeopleSamples, config: PeopleTrainConfig) -> PersonClassifier:
    """Fit scikit-learn's network; calibrate it on buildings, with the things in them, and sources left out in turn."""
    fold = samples.building % config.folds
    if not all(len(np.unique(samples.is_person[fold != k])) == 2 for k in range(config.folds)):
        raise InputError("too few frames to train on: they must show people and nobody; draw more buildings or frames")
    scores = np.empty(len(fold))
    for left_out in range(config.folds):
        theirs = fold == left_out
        if theirs.any():
            scores[theirs] = _network(samples, ~theirs, config).score(samples.features[theirs])
    platt = LogisticRegression(C=1e3).fit(scores[:, None], samples.is_person, samples.weight)
    network = _network(samples, np.ones(len(fold), dtype=bool), config)
    output = network.output * np.float32(platt.coef_[0, 0])
    output[-1] += np.float32(platt.intercept_[0])
    return replace(network, output=output)


def _network(samples: PeopleSamples, chosen: NDArray[np.bool_], config: PeopleTrainConfig) -> PersonClassifier:
    """Return a network fitted to the `chosen` (n,) samples, without calibration; unused inputs have no weights."""
    features = samples.features[chosen]
    machine = MLPClassifier(
        (config.units,), alpha=config.decay, learning_rate_init=config.rate, max_iter=config.rounds, tol=0.0,
        n_iter_no_change=config.rounds, random_state=0,
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # it ends after its rounds
        machine.fit(features, samples.is_person[chosen], samples.weight[chosen])
    used = np.any(features != 0.0, axis=0).astype(np.float32)
    hidden = np.vstack((machine.coefs_[0] * used[:, None], machine.intercepts_[0]))
    output = np.append(machine.coefs_[1][:, 0], machine.intercepts_[1])
    return PersonClassifier(hidden.astype(np.float32), output.astype(np.float32))


@dataclass(frozen=True, eq=False)
class TrainedPeople:
    """What a training made.

    Attributes:
        classifier: The classifier.
        card: What it was trained on, how well it does.
        scores: On clothing, poses, things and a scene not trained on.
        left_out: Source of recorded frames -> the classifier trained without them.
        depth_classifier: The classifier for frames without colour, trained on the same ones.
        depth_left_out: As `left_out`, for frames without colour.
    """

    classifier: PersonClassifier
    card: dict[str, Any]
    scores: PeopleScores
    left_out: dict[str, PersonClassifier]
    depth_classifier: PersonClassifier
    depth_left_out: dict[str, PersonClassifier]


def train_people(config: PeopleTrainConfig, seed: int, recorded: str | os.PathLike[str] | None = None) -> TrainedPeople:
    """Train on simulated frames, and on the folder of `recorded` ones if there is one."""
    usual = replace(config, buildings=config.level_buildings, any_mount=0.0, seated=0.0)
    tilted = replace(config, buildings=config.tilted_buildings, any_mount=1.0)
    drawn, first = [], 0
    for stream, part in ((0, config), (2, usual), (3, tilted)):
        drawn.append(training_frames(np.random.default_rng([seed, stream]), part, first))
        first += part.buildings
    samples = collect(chain.from_iterable(drawn))
    sources: tuple[str, ...] = ()
    parts = {"": samples}
    if recorded is not None:
        real, sources = collect_recorded(recorded, config.recorded)
        parts = {name: with_recorded(samples, real, k) for k, name in enumerate(sources)}
        parts[""] = samples = with_recorded(samples, real)
    left_out = {name: fit_people(part, config) for name, part in parts.items()}
    depth_left_out = {name: fit_people(without_colour(part), config) for name, part in parts.items()}
    classifier, depth_classifier = left_out.pop(""), depth_left_out.pop("")
    rng = np.random.default_rng([seed, 1])
    tested = [
        frame
        for _ in range(config.test_buildings)
        for frame in draw_frames(rng, TEST_SCENES, "everyday", "unseen", config.frames)
    ]
    scores = score_people(classifier, tested)
    card = _card(samples, scores, config, seed, sources)
    figures = score_people(depth_classifier, (replace(f, frame=colourless(f.frame)) for f in tested)).figures()
    card["without_colour"] = {"test": figures}
    return TrainedPeople(classifier, card, scores, left_out, depth_classifier, depth_left_out)


def colourless(frame: RgbdFrame) -> RgbdFrame:
    """Return the frame without its colour."""
    return replace(frame, colour=grey(frame.camera))


def _card(
    samples: PeopleSamples,
    scores: PeopleScores,
    config: PeopleTrainConfig,
    seed: int,
    sources: tuple[str, ...],
) -> dict[str, Any]:
    return {
        "model": "people in RGB-D frames: HOG of brightness and depth, measures, a small network, Platt's calibration",
        "command": f"tagalong train people --seed {seed}{' --recorded FOLDER' * bool(sources)} --out DIR",
        "seed": seed,
        "config": asdict(config),
        "training": {
            "scenes": TRAIN_SCENES,
            "wardrobe": "training",
            "props": TRAIN_PROPS,
            "recorded": sources,
            "candidates": len(samples.is_person),
            "people": int(samples.is_person.sum()),
        },
        "test": {"scenes": TEST_SCENES, "wardrobe": "everyday", "props": "unseen", **scores.figures()},
        "calibration": {"fitted_on": "buildings, things and sources left out in turn"},
        "limits": LIMITS,
        "scikit_learn": sklearn.__version__,
    }
