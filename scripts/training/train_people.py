"""Train the classifier of people in RGB-D frames: on simulated frames under any mount, and on recorded ones."""

import os
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import chain
from typing import Any

import numpy as np
import sklearn
from numpy.typing import NDArray
from sklearn.linear_model import LogisticRegression
from sklearn.svm import LinearSVC

from ...perception.rgbd.frame import RgbdFrame, grey
from ...perception.rgbd.heads import find_candidates
from ...perception.rgbd.person_svm import LENGTH, LUMA_LENGTH, PersonSvm, candidate_features
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
        penalty: Of errors against the margin's width (C of the support vector machine).
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
    penalty: float = 0.005
    folds: int = 5
    any_mount: float = 0.5
    level_buildings: int = 200
    stereo: float = 0.4
    seated: float = 0.3
    recorded: float = 3.0


@dataclass(frozen=True, eq=False)
class PeopleSamples:
    """Candidates with what they really are.

    Attributes:
        features: (n, LENGTH) float32.
        is_person: (n,) bool.
        legs: (n,) bool `Candidates.legs`.
        building: (n,) number of the building; of a recording that of its source.
        weight: (n,) how much each counts.
    """

    features: NDArray[np.float32]
    is_person: NDArray[np.bool_]
    legs: NDArray[np.bool_]
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
    legs, numbers = [np.empty(0, bool)], [np.empty(0, np.int64)]
    for number, frames in enumerate(buildings):
        for drawn in frames:
            planes = finder.find(drawn.frame)
            candidates = find_candidates(planes)
            person, sure = _truth(drawn.person, candidates.label, len(candidates))
            features.append(candidate_features(planes, candidates)[sure])
            persons.append(person[sure])
            legs.append(candidates.legs[sure])
            numbers.append(np.full(np.count_nonzero(sure), number))
    weight = np.ones(sum(map(len, persons)))
    all_features, all_persons = np.concatenate(features), np.concatenate(persons)
    return PeopleSamples(all_features, all_persons, np.concatenate(legs), np.concatenate(numbers), weight)


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
    numbers = np.concatenate([np.full(len(person), sources.index(source)) for source, _, person, _ in parts])
    features, persons, legs = (np.concatenate([part[k] for part in parts]) for k in (1, 2, 3))
    return PeopleSamples(features, persons, legs, numbers, np.full(len(persons), weight / len(COLUMNS))), sources


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


def fit_people(samples: PeopleSamples, config: PeopleTrainConfig) -> PersonSvm:
    """Fit scikit-learn's linear support vector machines, of bodies and of legs alone; calibrate each on buildings, with
    the things in them, and sources left out in turn.
    """
    weights, rest = np.empty((2, LENGTH), dtype=np.float32), np.empty((3, 2))
    for row, mine in enumerate((~samples.legs, samples.legs)):
        weights[row], rest[:, row] = _fit(samples, mine, config)
    return PersonSvm(weights, *rest)


def _fit(samples: PeopleSamples, mine: NDArray[np.bool_], config: PeopleTrainConfig) -> tuple[Array, Array]:
    """Return (LENGTH,) the weights and (3,) bias, slope and offset of a machine for those of `mine` (n,)."""
    fold = samples.building % config.folds
    if not all(len(np.unique(samples.is_person[mine & (fold != k)])) == 2 for k in range(config.folds)):
        raise InputError(
            "too few frames to train on: they must show people, nobody, and legs alone of both; draw more buildings "
            "or more frames of each"
        )
    scores = np.empty(len(fold))
    for left_out in range(config.folds):
        theirs = mine & (fold == left_out)
        if theirs.any():
            scores[theirs] = _machine(config, samples, mine & ~theirs).decision_function(samples.features[theirs])
    platt = LogisticRegression(C=1e3).fit(scores[mine, None], samples.is_person[mine], samples.weight[mine])
    machine = _machine(config, samples, mine)
    return machine.coef_[0], np.concatenate((machine.intercept_, platt.coef_[0], platt.intercept_))


def _machine(config: PeopleTrainConfig, samples: PeopleSamples, chosen: NDArray[np.bool_]) -> LinearSVC:
    machine = LinearSVC(C=config.penalty, dual="auto", tol=1e-3, random_state=0)
    return machine.fit(samples.features[chosen], samples.is_person[chosen], samples.weight[chosen])


@dataclass(frozen=True, eq=False)
class TrainedPeople:
    """What a training made.

    Attributes:
        svm: The classifier.
        card: What it was trained on, how well it does.
        scores: On clothing, poses, things and a scene not trained on.
        left_out: Source of recorded frames -> the classifier trained without them.
        depth_svm: The classifier for frames without colour, trained on the same ones.
        depth_left_out: As `left_out`, for frames without colour.
    """

    svm: PersonSvm
    card: dict[str, Any]
    scores: PeopleScores
    left_out: dict[str, PersonSvm]
    depth_svm: PersonSvm
    depth_left_out: dict[str, PersonSvm]


def train_people(config: PeopleTrainConfig, seed: int, recorded: str | os.PathLike[str] | None = None) -> TrainedPeople:
    """Train on simulated frames, and on the folder of `recorded` ones if there is one."""
    usual = replace(config, buildings=config.level_buildings, any_mount=0.0, seated=0.0)
    drawn = training_frames(np.random.default_rng([seed, 0]), config)
    samples = collect(chain(drawn, training_frames(np.random.default_rng([seed, 2]), usual, config.buildings)))
    sources: tuple[str, ...] = ()
    parts = {"": samples}
    if recorded is not None:
        real, sources = collect_recorded(recorded, config.recorded)
        parts = {name: with_recorded(samples, real, k) for k, name in enumerate(sources)}
        parts[""] = samples = with_recorded(samples, real)
    left_out = {name: fit_people(part, config) for name, part in parts.items()}
    depth_left_out = {name: fit_people(without_colour(part), config) for name, part in parts.items()}
    svm, depth_svm = left_out.pop(""), depth_left_out.pop("")
    rng = np.random.default_rng([seed, 1])
    tested = [
        frame
        for _ in range(config.test_buildings)
        for frame in draw_frames(rng, TEST_SCENES, "everyday", "unseen", config.frames)
    ]
    scores = score_people(svm, tested)
    card = _card(svm, samples, scores, config, seed, sources)
    figures = score_people(depth_svm, (replace(f, frame=colourless(f.frame)) for f in tested)).figures()
    card["without_colour"] = {"test": figures, "calibration": _calibration(depth_svm)}
    return TrainedPeople(svm, card, scores, left_out, depth_svm, depth_left_out)


def colourless(frame: RgbdFrame) -> RgbdFrame:
    """Return the frame without its colour."""
    return replace(frame, colour=grey(frame.camera))


def _calibration(svm: PersonSvm) -> dict[str, list[float]]:
    """Return what a card says of it: two numbers each, of bodies and of legs alone."""
    return {"slope": svm.slope.tolist(), "offset": svm.offset.tolist()}


def _card(
    svm: PersonSvm,
    samples: PeopleSamples,
    scores: PeopleScores,
    config: PeopleTrainConfig,
    seed: int,
    sources: tuple[str, ...],
) -> dict[str, Any]:
    return {
        "model": "people in RGB-D frames: HOG of brightness and depth, measures, linear SVM, Platt's calibration",
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
        "calibration": {**_calibration(svm), "fitted_on": "buildings, things and sources left out in turn"},
        "limits": LIMITS,
        "scikit_learn": sklearn.__version__,
    }
