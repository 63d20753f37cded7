"""`tagalong train`: trains the models that the package ships."""

import argparse
from pathlib import Path

from ...slam.errors import InputError
from ...slam.files import write_json
from ..figures.leg_curve import save_leg_curve
from ..tables import format_table
from ..training.evaluate_legs import RATES
from ..training.follower import add_follower_arguments, train_follower
from ..training.leg_forests import GAMMA, TrainedLegs, figures, train_real, train_simulation, write
from ..training.leg_recordings import read_leg_recordings
from ..training.train_legs import TrainConfig

COUNTS = ("scans", "drives", "test_scans", "test_drives", "trees")
EPILOG = """\
writes into DIR: legs_FOREST.npz (the forest), legs_FOREST.json (its card: data, seeds, figures, limits),
curve.json and curve.png (share of legs found against false legs a scan)

examples:
  tagalong train legs --forest simulation --out out/legs
  tagalong train legs --forest real --data recordings --out out/legs
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the models that can be trained, and their options."""
    parser.epilog = "examples:\n  tagalong train legs --forest simulation\n  tagalong train follower --max-minutes 90"
    models = parser.add_subparsers(dest="model", metavar="MODEL", required=True)
    add_follower_arguments(models)
    summary = "the random forest that tells legs in laser scans"
    legs = models.add_parser(
        "legs",
        help=summary,
        description=summary,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
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
    legs.add_argument("--seed", type=int, default=0, help="of all random draws (default: %(default)s)")
    for name in COUNTS:
        default = getattr(TrainConfig(), name)
        flag = f"--{name.replace('_', '-')}"
        legs.add_argument(flag, type=int, default=default, metavar="N", help="default: %(default)s")


def run(options: argparse.Namespace) -> int:
    """Train, write the model with its card, print how it scores."""
    if options.model == "follower":
        return train_follower(options)
    if options.forest == "real" and options.data is None:
        raise InputError("--forest real needs --data DIR with the labelled recordings")
    counts = {name: getattr(options, name) for name in COUNTS}
    if options.seed < 0 or min(counts.values()) < 1:
        raise InputError("--seed must not be negative, --scans, --drives, --test-... and --trees must be positive")
    config = TrainConfig(**counts)
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
