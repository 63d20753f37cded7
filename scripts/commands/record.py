"""`tagalong record`: followers' episodes as datasets to learn from, in the formats of Minari and LeRobot."""

import argparse
from pathlib import Path

from ...agents import EXPLORERS, FOLLOWERS
from ...envs.registration import IDS
from ...envs.suites import SUITES, Scenario, suite
from ...slam.errors import InputError
from ...slam.files.output import write_json
from ...slam.processes.crew import require_workers
from ..console.arguments import MOST_EPISODES, at_least, random_seed
from ..console.setting_words import add_settings, read_settings
from ..console.tables import format_table
from ..lab.hardware import describe_machine
from ..runs.demonstrations import CHECKS, Asked, Dataset, datasets_asked, record

EPILOG = """\
Needs the extra `datasets`. Each follower drives the same episodes, seeds --seed, --seed + 1, ...; nothing maps unless
--set slam=... asks for it. Suites judge by seeds from 1000000 on; below that, their episodes are to learn from.
An episode that was driven is not driven again: the same command goes on where it was stopped, one with more --episodes
adds to it.

writes into DIR:
  minari/tagalong/PLACE/FOLLOWER-v0   a dataset for each follower and environment; MINARI_DATASETS_PATH=DIR/minari
  lerobot/PLACE/FOLLOWER              the same for LeRobot v3, LeRobotDataset(..., root=...)
  episodes/                           what was driven, as npz; only needed to go on
  record.json                         seeds, endings, rewards

examples:
  tagalong record --followers pid learned --scene office --episodes 50 --out out/demonstrations
  tagalong record --followers pid --suite crowd --episodes 20 --formats minari --out out/crowd
"""
SCENES = {str(arguments["scene"]): name for name, arguments in IDS.items()}
"""Scene -> id of the environment."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument(
        "--followers", nargs="+", default=["pid"], metavar="WHO", help="as for `tagalong evaluate` (default: pid)"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--scene", choices=sorted(SCENES), default="corridor", help="where (default: %(default)s)")
    where.add_argument("--suite", choices=sorted(SUITES), help="the episodes of a suite in turn, instead of --scene")
    parser.add_argument(
        "--episodes", type=at_least(1, MOST_EPISODES), default=10, metavar="N", help="of each follower (%(default)s)"
    )
    parser.add_argument(
        "--people", type=at_least(1), metavar="N", help="people, leader included (2; a suite has its own numbers)"
    )
    parser.add_argument(
        "--seed", type=random_seed, default=0, metavar="N", help="seed of the first episode (%(default)s)"
    )
    parser.add_argument(
        "--beams", type=at_least(1), metavar="N", help="beams of the laser (as many as the environment has)"
    )
    parser.add_argument("--formats", nargs="+", choices=tuple(CHECKS), default=list(CHECKS), help="default: all")
    add_settings(parser, "an argument of the environment, e.g. robot=pioneer or slam=cartographer")
    parser.add_argument("--jobs", type=at_least(1), default=1, metavar="N", help="processes (default: %(default)s)")
    parser.add_argument(
        "--out", type=Path, default=Path("out/demonstrations"), metavar="DIR", help="default: %(default)s"
    )


def run(options: argparse.Namespace) -> int:
    """Drive, write the datasets, print what is in them."""
    require_workers(options.jobs, "--jobs")
    for name in options.formats:
        CHECKS[name]()
    asked = _asked(options)
    datasets = datasets_asked(asked)
    rows = record(asked, datasets, options.out, options.jobs)
    told = {name: getattr(options, name) for name in ("followers", "scene", "suite", "episodes", "seed", "settings")}
    content = {"options": told, "formats": asked.formats, "episodes": rows, "machine": describe_machine()}
    write_json(options.out / "record.json", content)
    lines = [_line(dataset, [row for row in rows if row["dataset"] == dataset.name]) for dataset in datasets]
    print(format_table(("dataset", "episodes", "steps", "tours done", "mean return"), lines))
    print(f"wrote {', '.join(str(options.out / name) for name in asked.formats)}")
    return 0


def _asked(options: argparse.Namespace) -> Asked:
    """Return what is asked for, as `Asked` has it."""
    followers = list(dict.fromkeys(who for word in options.followers for who in word.split(",") if who))
    if not followers:
        raise InputError("--followers names nobody")
    exploring = [who for who in followers if who in EXPLORERS]
    if exploring:
        known = ", ".join(FOLLOWERS)
        raise InputError(f"--followers: {exploring[0]} explores without a leader; who follows: {known}")
    common = {"slam": None} if options.beams is None else {"slam": None, "beams": options.beams}
    if options.suite is None:
        people = 2 if options.people is None else options.people
        if people < 1:
            raise InputError(f"--people counts the leader: at least 1, got {people}")
        scenarios = (Scenario(name=options.scene, env=SCENES[options.scene], arguments={"people_count": people}),)
    elif options.people is not None:
        raise InputError(f"the suite {options.suite} has its own numbers of people: leave out --people")
    else:
        scenarios = suite(options.suite)
    return Asked(
        followers=followers,
        place=options.suite or options.scene,
        scenarios=scenarios,
        episodes=options.episodes,
        seed=options.seed,
        arguments={**common, **read_settings(options.settings)},
        formats=list(dict.fromkeys(options.formats)),
    )


def _line(dataset: Dataset, rows: list[dict[str, object]]) -> tuple[str, ...]:
    done = sum(row["ending"] == "tour_done" for row in rows)
    steps = sum(int(str(row["steps"])) for row in rows)
    reward = sum(float(str(row["total_reward"])) for row in rows) / len(rows)
    return dataset.name, str(len(rows)), str(steps), f"{done} of {len(rows)}", f"{reward:.1f}"
