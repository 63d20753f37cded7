"""`tagalong evaluate`: drives a follower through many episodes and prints figures with intervals."""

import argparse
import math
from pathlib import Path
from typing import Any

import gymnasium as gym
from tqdm import tqdm

from ...agents import EXPLORERS, FOLLOWERS, make_follower
from ...envs.metrics.follow_bench import follow_bench_metrics
from ...envs.recording.rollout import Episode, rollout
from ...envs.registration import IDS
from ...envs.suites import FIRST_SEED, SUITES, Scenario, suite
from ...slam.errors import InputError
from ...slam.files.output import write_json
from ..console.arguments import MOST_EPISODES, at_least, random_seed
from ..console.record_option import add_record, check_record
from ..console.setting_words import add_settings, read_settings
from ..console.tables import format_table
from ..lab.episode_recordings import Recording, recorded_episodes
from ..lab.hardware import describe_machine
from ..lab.statistics import Estimate, metric_mean, share

EPILOG = """\
Every episode has its own seed: --seed, --seed + 1, ... Intervals are 95 % each: Wilson's for shares,
Student's for means.
A tour counts as done when its leader was followed to the end without touching anybody or anything.

Besides the shipped followers ({followers}), give your own: module:class, e.g. my_module:Bold for class Bold
with reset() and act(observation) in my_module.py of the current folder or anywhere that Python finds it.
A folder that `tagalong train follower` wrote is one, too. Behind a name, "+guard" puts the safety filter, which stops
before a certain contact: pid+guard; "-alone" takes it from a policy that was trained with it: reinforced-alone.
"mapper" looks for what its map lacks, and needs one: --set slam=cartographer.
Explorers ({explorers}) drive without a leader, among the same bystanders, until 99 % of the floor was seen.

A suite is a fixed set of unseen episodes (offices of the test half; seeds from 1000000 on, its scenarios in turn):
corridor, meeting_room, office, floor_plan, hurried (offices, hurried leaders), crowd (8 to 12 bystanders), follow-bench
(its four situations with 8 bystanders, and its own figures beside ours), hard-v1 (12 cells: doors of 0.9 m, short
lasers, slipping wheels, crowds), hard-v2 (the same, and no bystander sees the robot), follow-bench-printed (the two
crowds of which Follow-Bench prints how its planners do).

examples:
  tagalong evaluate pid --env tagalong/Corridor-v0 --episodes 30 --people 2
  tagalong evaluate pid --env tagalong/MeetingRoom-v0 --perception truth --out out/pid-truth
  tagalong evaluate pid --suite office --episodes 100
  tagalong evaluate pid --set robot=pioneer --set lidar.rate_hz=20 --set perception.removal.zeta=0.5
  tagalong evaluate my_module:Bold --episodes 10
""".format(followers=", ".join(FOLLOWERS), explorers=", ".join(EXPLORERS))

MEANS = {
    "distance_error_rms_m": "distance error RMS [m]",
    "bearing_error_rms_rad": "bearing error RMS [rad]",
    "leader_visible_share": "leader seen",
    "leader_right_share": "leader right while seen",
    "losses": "losses > 1 s",
    "min_distance_bystander_m": "nearest bystander [m]",
    "min_distance_static_m": "nearest thing [m]",
    "personal_space_compliance": "personal space kept",
    "jerk_rms_mps3": "jerk RMS [m/s3]",
    "sparc": "SPARC",
    "ldlj": "LDLJ",
    "duration_s": "duration [s]",
}
"""Metric -> its name in the table."""
EXPLORATION_MEANS = {
    "coverage": "floor seen",
    "time_to_90_s": "time to 90 % of it [s]",
    **{
        name: title
        for name, title in MEANS.items()
        if "leader" not in name and "error" not in name and name != "losses"
    },
}
"""The same without a leader."""
_ASKED = ("follower", "env", "suite", "episodes", "people", "seed", "perception", "beams", "settings")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    names = ", ".join((*FOLLOWERS, "mapper", *EXPLORERS))
    parser.add_argument(
        "follower", metavar="WHO", help=f"who drives: {names}, module:class, or a trained policy's folder"
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--env", choices=sorted(IDS), default="tagalong/Corridor-v0", help="where (%(default)s)")
    where.add_argument("--suite", choices=sorted(SUITES), help="a set of unseen episodes, instead of --env")
    parser.add_argument(
        "--episodes", type=at_least(1, MOST_EPISODES), default=30, metavar="N", help="how many (%(default)s)"
    )
    parser.add_argument(
        "--people", type=at_least(1), metavar="N", help="people, leader included (2; a suite has its own numbers)"
    )
    parser.add_argument(
        "--seed", type=random_seed, metavar="N", help="seed of the first episode (0; with --suite 1000000)"
    )
    parser.add_argument(
        "--perception",
        choices=("tracker", "truth", "modelled"),
        default="tracker",
        help="how people are perceived (%(default)s)",
    )
    parser.add_argument("--beams", type=at_least(1), default=1081, metavar="N", help="beams of the laser (%(default)s)")
    add_settings(parser, "an argument of the environment, e.g. robot=pioneer, lidar.height=0.3 or slam=gmapping")
    add_record(parser)
    parser.add_argument("--out", type=Path, metavar="DIR", help="write evaluation.json there")


def run(options: argparse.Namespace) -> int:
    """Drive, print the table, write what was asked for."""
    check_record(options.record)
    with recorded_episodes(options.record) as recording:
        rows = _drive(options, recording)
    estimates = summary(rows)
    print(format_table(("figure", "mean", "95 % interval"), _lines(estimates)))
    if options.suite is not None and len(suite(options.suite)) > 1:
        print("\n" + _by_scenario(rows))
    for row in rows:
        if not row["is_success"]:
            print(f"seed {row['seed']}: {row['ending'] or 'out of time'} after {row['duration_s']:.1f} s")
    if options.out is not None:
        asked = {name: getattr(options, name) for name in _ASKED}
        figures = {name: estimate.to_dict() for name, estimate in estimates.items()}
        content = {"options": asked, "figures": figures, "episodes": rows, "machine": describe_machine()}
        write_json(options.out / "evaluation.json", content)
    return 0


def _drive(options: argparse.Namespace, recording: Recording) -> list[dict[str, Any]]:
    """Return one row of figures for each episode."""
    if options.suite is None:
        options.people = 2 if options.people is None else options.people
        walking = options.people - (options.follower in EXPLORERS)
        if options.people < 1:
            raise InputError(f"--people counts the leader, whom explorers do without: at least 1, got {options.people}")
        scenarios = (Scenario(name=options.env, env=options.env, arguments={"people_count": walking}),)
    elif options.people is not None:
        raise InputError(f"the suite {options.suite} has its own numbers of people: leave out --people")
    else:
        scenarios = suite(options.suite)
    first = options.seed if options.seed is not None else 0 if options.suite is None else FIRST_SEED
    common: dict[str, Any] = {"people": options.perception, "slam": None, "beams": options.beams}
    if options.follower in EXPLORERS:
        common |= _alone(options)
    own = read_settings(options.settings)
    envs = [gym.make(scenario.env, **{**common, **scenario.arguments, **own}) for scenario in scenarios]
    make_follower(options.follower, envs[0].get_wrapper_attr("interface"))  # who is unknown is told before any drive
    rows = []
    for k in tqdm(range(options.episodes), unit="episode", leave=False):
        scenario, env = scenarios[k % len(scenarios)], envs[k % len(scenarios)]
        follower = make_follower(options.follower, env.get_wrapper_attr("interface"))
        episode = rollout(env, follower, seed=first + k, options=scenario.options, after_step=recording.take)
        recording.finish(episode)
        more = follow_bench_metrics(episode.history) if options.suite == "follow-bench" else {}
        rows.append({**_row(episode), **more, "scenario": scenario.name})
    for env in envs:
        env.close()
    return rows


def _alone(options: argparse.Namespace) -> dict[str, Any]:
    """Return what an environment without a leader is asked for."""
    if options.suite is not None:
        raise InputError(f"suites have leaders; {options.follower} explores without one: give --env")
    return {"leader": False, "slam": "cartographer" if options.follower == "frontier" else None}


def _by_scenario(rows: list[dict[str, Any]]) -> str:
    """Return a table of success, contacts and Follow-Bench's figures for each scenario."""
    names = sorted({row["scenario"] for row in rows})
    extra = [name for name in rows[0] if name.startswith("fb_")]
    lines = []
    for name in names:
        part = [row for row in rows if row["scenario"] == name]
        done = sum(row["is_success"] for row in part) / len(part)
        free = sum(row["collision_free"] for row in part) / len(part)
        means = [sum(row[key] for row in part) / len(part) for key in extra]
        lines.append((name, str(len(part)), f"{done:.2f}", f"{free:.2f}", *(f"{mean:.2f}" for mean in means)))
    return format_table(("scenario", "n", "tours done", "free of contact", *extra), lines)


def summary(rows: list[dict[str, Any]]) -> dict[str, Estimate]:
    """Return the figures over all episodes by name."""
    if "leader_choices" not in rows[0]:
        means = {title: metric_mean(name, [row[name] for row in rows]) for name, title in EXPLORATION_MEANS.items()}
        return {"floor seen to 99 %": share([row["is_success"] for row in rows]), **means}
    choices = int(sum(row["leader_choices"] for row in rows))
    right = int(sum(row["leader_choices_right"] for row in rows))
    return {
        "tours done": share([row["is_success"] for row in rows]),
        "free of contact": share([row["collision_free"] == 1.0 for row in rows]),
        "leader chosen right": share([True] * right + [False] * (choices - right)),
        **{title: metric_mean(name, [row[name] for row in rows]) for name, title in MEANS.items()},
    }


def _row(episode: Episode) -> dict[str, Any]:
    done = episode.ending in ("tour_done", "covered")
    return {"seed": episode.seed, "ending": episode.ending, "is_success": done, **episode.metrics}


def _lines(estimates: dict[str, Estimate]) -> list[tuple[str, str, str]]:
    return [
        (title, f"{estimate.mean:.3f}", f"{_interval(estimate)}(n = {estimate.n})")
        for title, estimate in estimates.items()
    ]


def _interval(estimate: Estimate) -> str:
    return "" if math.isnan(estimate.low) else f"{estimate.low:.3f} .. {estimate.high:.3f} "
