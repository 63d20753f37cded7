"""`tagalong train`: trains the models that the package ships."""

import argparse
from pathlib import Path
from typing import Any

from ...perception.rgbd.person_classifier import DEPTH_MODEL, MODEL
from ...slam.errors import InputError
from ...slam.files.output import write_json
from ..console.arguments import at_least, random_seed
from ..console.subcommands import add_described
from ..console.tables import format_table
from ..training.evaluate_legs import RATES
from ..training.follower import add_follower_arguments, train_follower
from ..training.leg_curve import save_leg_curve
from ..training.leg_forests import GAMMA, TrainedLegs, figures, train_real, train_simulation, write
from ..training.leg_recordings import read_leg_recordings
from ..training.tracker_errors import add_tracker_arguments, train_tracker_errors
from ..training.train_legs import TrainConfig
from ..training.train_people import PeopleTrainConfig, train_people

PEOPLE_COUNTS = ("buildings", "level_buildings", "tilted_buildings", "frames", "test_buildings")
COUNTS = ("scans", "drives", "test_scans", "test_drives", "trees")
MOST = 100_000
"""Of each of them: many times what the shipped models were trained with, and days of work."""
EPILOG = """\
writes into DIR: legs_FOREST.npz (the forest), legs_FOREST.json (its card: data, seeds, figures, limits),
curve.json and curve.png (share of legs found against false legs a scan)

examples:
  tagalong train legs --forest simulation --out out/legs
  tagalong train legs --forest real --data recordings --out out/legs
"""
PEOPLE_EPILOG = """\
writes into DIR: people_rgbd.npz (the classifier), people_rgbd.json (its card: data, seeds, figures, limits),
people_rgbd_depth.npz (the classifier of frames without colour), and with --recorded without_SOURCE.npz and
without_SOURCE_depth.npz for each source of recorded frames (the same trained without them)

example: tagalong train people --out out/people
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the models that can be trained, and their options."""
    parser.epilog = (
        "examples:\n  tagalong train legs --forest simulation --out out/legs\n  tagalong train people\n"
        "  tagalong train follower --max-minutes 90\n  tagalong train tracker-errors"
    )
    models = parser.add_subparsers(dest="model", metavar="MODEL", required=True)
    add_follower_arguments(models)
    add_tracker_arguments(models)
    summary = "the random forest that tells legs in laser scans"
    legs = add_described(models, "legs", summary, EPILOG)
    legs.add_argument(
        "--forest",
        choices=("simulation", "real"),
        required=True,
        help="simulation: simulated scans only; real: the recordings of --data too",
    )
    legs.add_argument(
        "--data",
        type=Path,
        metavar="DIR",
        help="folder of positive_{1,2,3}_labelled.npz and negative_2_left_scans.npz (simulation: only to score it)",
    )
    legs.add_argument("--out", type=Path, default=Path("out/legs"), metavar="DIR", help="default: %(default)s")
    legs.add_argument("--seed", type=random_seed, default=0, help="of all random draws (default: %(default)s)")
    for name in COUNTS:
        default = getattr(TrainConfig(), name)
        flag = f"--{name.replace('_', '-')}"
        legs.add_argument(flag, type=at_least(1), default=default, metavar="N", help="default: %(default)s")
    _add_people(models)


def _add_people(models: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    summary = "the classifier that tells people in RGB-D frames"
    people = add_described(models, "people", summary, PEOPLE_EPILOG)
    people.add_argument("--out", type=Path, default=Path("out/people"), metavar="DIR", help="default: %(default)s")
    people.add_argument("--seed", type=random_seed, default=0, help="of all random draws (default: %(default)s)")
    people.add_argument(
        "--recorded", type=Path, metavar="FOLDER", help="labelled frames to train on, too, as of `bench rgbd-recorded`"
    )
    for name in PEOPLE_COUNTS:
        default = getattr(PeopleTrainConfig(), name)
        flag = f"--{name.replace('_', '-')}"
        people.add_argument(flag, type=at_least(1), default=default, metavar="N", help="default: %(default)s")


def run(options: argparse.Namespace) -> int:
    """Train what was asked for."""
    return {
        "follower": train_follower,
        "people": _train_people,
        "legs": _train_legs,
        "tracker-errors": train_tracker_errors,
    }[options.model](options)


def _counts(options: argparse.Namespace, names: tuple[str, ...]) -> dict[str, Any]:
    """Return the options that count things, and look at the seed, before hours of work are spent."""
    counts = {name: getattr(options, name) for name in names}
    return counts


def _train_people(options: argparse.Namespace) -> int:
    """Train, write the classifier with its card, print how it scores."""
    counts = _counts(options, PEOPLE_COUNTS)
    if options.buildings < PeopleTrainConfig().folds:
        raise InputError(f"--buildings must be at least {PeopleTrainConfig().folds}, got {options.buildings}")
    trained = train_people(PeopleTrainConfig(**counts), options.seed, options.recorded)
    path = options.out / MODEL.name
    trained.classifier.save(path, trained.card)
    for source, classifier in trained.left_out.items():
        classifier.save(options.out / f"without_{source}.npz", {"trained": f"as {MODEL.name}, without {source}"})
    trained.depth_classifier.save(options.out / DEPTH_MODEL.name, {"trained": f"with {MODEL.name}, without colour"})
    for source, classifier in trained.depth_left_out.items():
        told = {"trained": f"as {DEPTH_MODEL.name}, without {source}"}
        classifier.save(options.out / f"without_{source}_depth.npz", told)
    print(f"wrote {path}")
    print(format_table(["figure", "value"], [[name, str(value)] for name, value in trained.scores.figures().items()]))
    return 0


def _train_legs(options: argparse.Namespace) -> int:
    """Train, write the forest with its card, print how it scores."""
    if options.forest == "real" and options.data is None:
        raise InputError("--forest real needs --data DIR with the labelled recordings")
    config = TrainConfig(**_counts(options, COUNTS))
    train = train_real if options.forest == "real" else train_simulation
    if options.data is None:
        trained = train_simulation(config, options.seed)
    else:
        positive, people_free = read_leg_recordings(options.data)
        trained = train(config, options.seed, positive, people_free.scans)
    print(f"wrote {write(trained, options.out)}")
    _report(trained, options.out)
    return 0


def _report(trained: TrainedLegs, folder: Path) -> None:
    write_json(folder / "curve.json", {name: figures(scores) for name, scores in trained.scores.items()})
    save_leg_curve(folder / "curve.png", trained.scores)
    rows = [[str(rate), *(f"{scores.recall(rate):.3f}" for scores in trained.scores.values())] for rate in RATES]
    print(format_table(["false legs a scan", *(f"recall, {name}" for name in trained.scores)], rows))
    for name, scores in trained.scores.items():
        recall, false = scores.at(GAMMA)
        print(f"confidence {GAMMA}, {name}: recall {recall:.3f}, {false:.2f} false legs a scan")
