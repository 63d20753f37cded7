"""How well people are found in RGB-D frames: clothing, poses of the arms, things and a scene not trained on.

Kinds of work, all in the scene "lab":

    drive     frames 2 s apart of the operator's drive of five minutes, four scripted people
    shaken    the same with 1.5 degrees of pitch and roll
    crowd     single frames from anywhere along the route, up to five people in all poses of a step, often behind and
              beside each other and close to the camera, among things of a person's height not trained on
    downN     the same by cameras 0.3 to 1.8 m high whose nose points N degrees down

A person counts within 6 m if at least half of what the picture would show of it is in sight. The likelihood's expected
calibration error is over all candidates within 6 m, in ten bins.

examples:
  tagalong bench rgbd-people --seeds 8 --first-seed 201 --work crowd
  tagalong bench rgbd-people --seeds 4 --first-seed 201 --work drive shaken

Legs alone count from 0.5 on, too, which `PeopleFinder` tells from 0.9 on: what it tells stands in a table of its own.
By cameras of other mounts, three seeds (241 to 243, looked at once) gave:

    frames of  people  recall  precision  at 0.95  calibration
    crowd      308     0.942   0.969      0.955    0.030
    down0      281     0.943   0.961      0.947    0.023
    down15     283     0.912   0.947      0.912    0.019
    down30     281     0.879   0.964      0.890    0.019
    down45     220     0.864   0.954      0.864    0.024

With a linear classifier of bodies and one of legs, trained on half as many buildings, they gave 0.938, 0.932, 0.898,
0.819 and 0.832 at that precision, calibration errors 0.020, 0.016, 0.021, 0.010 and 0.018. A likelihood that is right
has one of 0.013 to 0.018 in so few frames.

Before any mount was trained on, the classifier for level cameras gave, at a likelihood of 0.5 (in brackets 95 %
intervals; then the recall where the precision is 0.95, and the expected calibration error of the likelihood):

    frames of  frames  people  recall              precision           at 0.95  calibration  position, median error
    drive      568     335     0.997 [0.98, 1.00]  0.995 [0.98, 1.00]  0.997    0.006        0.03 m
    shaken     568     335     1.000 [0.99, 1.00]  0.986 [0.97, 0.99]  1.000    0.006        0.03 m
    crowd      768     818     0.961 [0.95, 0.97]  0.947 [0.93, 0.96]  0.960    0.020        0.06 m

Of the crowd, by how much of somebody is visible, at that precision: 0.34 of 65 people below 0.3, 0.67 of 73 below 0.5,
0.77 of 64 below 0.7, 0.98 of the 754 others. Before candidates were measured (`perception.rgbd.measures`) it was 0.90
of the same 818 people: pieces of wall between people and things on stands were taken for somebody. Nearly all that is
missed now are people half hidden, and people closer than 0.8 m (recall 0.72 of 43), most of whom is nearer than the
camera can measure.
"""

import argparse
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...envs.recording.operator import Operator
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.config import WorldConfig
from ...envs.world.world import World
from ...perception.rgbd.people_finder import PeopleFinder, PeopleFinderConfig
from ...perception.rgbd.person_classifier import MODEL, PersonClassifier
from ...perception.rgbd.planes import PlaneFinder
from ...slam.geometry import inverse, transform_points
from ..console.arguments import at_least, random_seed
from ..console.tables import format_table
from ..figures.detections import save_detections
from ..training.evaluate_people import THRESHOLD, PeopleScores, score_people
from ..training.rgbd_cameras import tilted_camera
from ..training.rgbd_frames import LabelledFrame, draw_frames
from ..training.rgbd_truth import WholeBodies
from .results import write_results

Array = NDArray[np.float64]

DISTANCES = (0.0, 0.8, 1.3, 2.0, 3.0, 4.0, 5.0, 6.0)
"""Borders of the distances that are counted apart [m]; of people nearer than 0.8 m much is too near to be measured."""
VISIBLE = (0.0, 0.3, 0.5, 0.7, 0.9, np.inf)
"""Borders of the visible shares that are counted apart."""
PRECISION = 0.95
EVERY_S = 2.0
SHAKEN = float(np.radians(1.5))
CROWD = (8, 12)
"""Buildings a seed, and frames of each."""
FIGURE_FRAMES = 12
WORK = ("drive", "shaken", "crowd", "down0", "down15", "down30", "down45")


def drive_frames(seed: int, vibration: float, every_s: float = EVERY_S) -> Iterator[LabelledFrame]:
    """Yield frames of the operator's drive through a lab."""
    camera = RgbdConfig(rate_hz=1.0, vibration=vibration)
    config = WorldConfig(
        scene="lab", route="operator", people=0, leader=False, lidar=LidarConfig(beams=31), camera=camera
    )
    world = World(config, np.random.default_rng(seed))
    operator, whole = Operator(world.scene), WholeBodies(camera, world.model, len(world.truth.people))
    while not world.truth.tour_done and world.time_s < 330.0:
        for _ in range(round(every_s * config.control_hz)):
            world.step(operator.command(world.truth))
        truth = world.truth
        person, places = world.people_of(world.frame_geoms()), inverse(truth.robot_pose)
        places = transform_points(places, truth.people.positions)
        counts = whole.count(world.data, truth.robot_pose)
        yield LabelledFrame(world.frames[-1], person, places, counts, np.zeros(len(places), dtype=bool))


def crowd_frames(seed: int) -> Iterator[LabelledFrame]:
    """Yield frames of people placed at random in labs, among things not trained on."""
    rng = np.random.default_rng([seed, 7])
    for _ in range(CROWD[0]):
        yield from draw_frames(rng, ("lab",), "everyday", "unseen", CROWD[1])


def mounted_frames(seed: int, pitch_deg: float) -> Iterator[LabelledFrame]:
    """Yield frames of people placed at random in labs, by cameras 0.3 to 1.8 m high that look down."""
    rng = np.random.default_rng([seed, 8])
    for _ in range(CROWD[0]):
        camera = tilted_camera(pitch_deg, float(rng.uniform(0.3, 1.8)))
        yield from draw_frames(rng, ("lab",), "everyday", "unseen", CROWD[1], camera)


def work(name: str, seed: int) -> Iterator[LabelledFrame]:
    """Return the frames of one seed."""
    if name.startswith("down"):
        return mounted_frames(seed, float(name.removeprefix("down")))
    return crowd_frames(seed) if name == "crowd" else drive_frames(seed, SHAKEN if name == "shaken" else 0.0)


def recall_between(scores: PeopleScores, values: Array, edges: Sequence[float], threshold: float) -> list[str]:
    """Return the recall and the number of people whose value, one of `values` (n,), lies between two `edges`."""
    cells = []
    for low, high in pairwise(edges):
        mine = scores.found[(values >= low) & (values < high)]
        cells.append(f"{(mine >= threshold).mean():.3f} ({len(mine)})" if len(mine) else "-")
    return cells


def by_distance(scores: PeopleScores) -> list[str]:
    """Return recall and number of the people who count between `DISTANCES`."""
    return recall_between(scores, np.where(scores.counted, scores.distance, np.nan), DISTANCES, THRESHOLD)


def by_visible(scores: PeopleScores) -> list[str]:
    """Return recall, where the precision is `PRECISION`, and number of all people between `VISIBLE`."""
    return recall_between(scores, scores.visible, VISIBLE, scores.threshold_at(PRECISION))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--seeds", type=at_least(1), default=5)
    parser.add_argument("--first-seed", type=random_seed, default=0)
    parser.add_argument("--model", type=Path, default=MODEL, help="classifier (the shipped one)")
    parser.add_argument("--work", nargs="+", choices=WORK, default=list(WORK[:3]))


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    classifier = PersonClassifier.load(options.model)
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    scores, told = {}, {}
    for name in options.work:
        frames = [frame for seed in seeds for frame in work(name, seed)]
        scores[name] = score_people(classifier, frames)
        told[name] = score_people(classifier, frames, PeopleFinderConfig())
    _print(scores, told)
    figures = {
        name: {
            **each.figures(),
            "recall_as_told": round(told[name].recall(), 4),
            "precision_as_told": round(told[name].precision(), 4),
            "by_distance": by_distance(each),
            "by_visible": by_visible(each),
        }
        for name, each in scores.items()
    }
    write_results(options, {"figures": figures})
    _draw(options.out / "detections.png", classifier, options.first_seed, options.work)
    return 0


def _print(scores: dict[str, PeopleScores], told: dict[str, PeopleScores]) -> None:
    rows = [[name, *(str(value) for value in each.figures().values())] for name, each in scores.items()]
    print(format_table(["frames of", *next(iter(scores.values())).figures()], rows))
    rows = [[name, f"{each.recall():.3f}", f"{each.precision():.3f}"] for name, each in told.items()]
    print("\nas `PeopleFinder` tells them\n" + format_table(["frames of", "recall", "precision"], rows))
    spans = [f"{low} .. {high} m" for low, high in pairwise(DISTANCES)]
    print("\nrecall (people)\n" + format_table(["", *spans], [[n, *by_distance(s)] for n, s in scores.items()]))
    spans = [f"{low} .. {high}" for low, high in pairwise(VISIBLE)]
    words = f"\nrecall at precision {PRECISION} by how much of somebody is visible (people)\n"
    print(words + format_table(["", *spans], [[n, *by_visible(s)] for n, s in scores.items()]))


def _draw(path: Path, classifier: PersonClassifier, seed: int, names: list[str]) -> None:
    """Draw what is found in a few frames with somebody in them."""
    planes, finder, seen = PlaneFinder(), PeopleFinder(classifier), []
    for name in names:
        frames = [drawn for drawn in work(name, seed) if (drawn.person >= 0).sum() > 60]
        chosen = frames[:: max(1, len(frames) * len(names) // FIGURE_FRAMES)][: FIGURE_FRAMES // len(names)]
        seen += [(drawn.frame, finder.find(drawn.frame, planes.find(drawn.frame))) for drawn in chosen]
    save_detections(path, seen)
