"""`tagalong evaluate`: drives a follower through many episodes and prints figures with intervals."""

import argparse
from pathlib import Path
from typing import Any

import gymnasium as gym
from tqdm import tqdm

from ...agents import FOLLOWERS, make_follower
from ...envs.registration import IDS
from ...envs.rollout import Episode, rollout
from ...slam.errors import InputError
from ...slam.files import write_json
from ..experiments.hardware import describe_machine
from ..experiments.statistics import Estimate, bootstrap_mean, share
from ..tables import format_table

EPILOG = """\
Every episode has its own seed: --seed, --seed + 1, ... Intervals are 95 %: Wilson for shares, bootstrap for means.
A tour counts as done when its leader was followed to the end without touching anybody or anything.

examples:
  tagalong evaluate pid --env tagalong/Corridor-v0 --episodes 30 --people 2
  tagalong evaluate pid --env tagalong/MeetingRoom-v0 --perception truth --out out/pid-truth
"""

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


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("follower", choices=sorted(FOLLOWERS), help="who drives")
    parser.add_argument("--env", choices=sorted(IDS), default="tagalong/Corridor-v0", help="where (%(default)s)")
    parser.add_argument("--episodes", type=int, default=30, metavar="N", help="how many (%(default)s)")
    parser.add_argument("--people", type=int, default=2, metavar="N", help="people, leader included (%(default)s)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the first episode (%(default)s)")
    parser.add_argument(
        "--perception", choices=("tracker", "truth"), default="tracker", help="how people are perceived (%(default)s)"
    )
    parser.add_argument("--beams", type=int, default=1081, metavar="N", help="beams of the laser (%(default)s)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write evaluation.json there")


def run(options: argparse.Namespace) -> int:
    """Drive, print the table, write what was asked for."""
    if options.episodes < 1:
        raise InputError(f"--episodes must be at least 1, got {options.episodes}")
    env = gym.make(options.env, people=options.perception, slam=None, people_count=options.people, beams=options.beams)
    follower = make_follower(options.follower, env.get_wrapper_attr("interface"))
    seeds = range(options.seed, options.seed + options.episodes)
    rows = [_row(rollout(env, follower, seed=seed)) for seed in tqdm(seeds, unit="episode", leave=False)]
    env.close()
    estimates = summary(rows)
    print(format_table(("figure", "mean", "95 % interval"), _lines(estimates)))
    for row in rows:
        if not row["is_success"]:
            print(f"seed {row['seed']}: {row['ending'] or 'out of time'} after {row['duration_s']:.1f} s")
    if options.out is not None:
        asked = {name: getattr(options, name) for name in ("follower", "env", "episodes", "people", "perception")}
        figures = {name: estimate.to_dict() for name, estimate in estimates.items()}
        content = {"options": asked, "figures": figures, "episodes": rows, "machine": describe_machine()}
        write_json(options.out / "evaluation.json", content)
    return 0


def summary(rows: list[dict[str, Any]]) -> dict[str, Estimate]:
    """Return the figures over all episodes by name."""
    choices = int(sum(row["leader_choices"] for row in rows))
    right = int(sum(row["leader_choices_right"] for row in rows))
    return {
        "tours done": share([row["is_success"] for row in rows]),
        "free of contact": share([row["collision_free"] == 1.0 for row in rows]),
        "leader chosen right": share([True] * right + [False] * (choices - right)),
        **{title: bootstrap_mean([row[name] for row in rows]) for name, title in MEANS.items()},
    }


def _row(episode: Episode) -> dict[str, Any]:
    done = episode.ending == "tour_done"
    return {"seed": episode.seed, "ending": episode.ending, "is_success": done, **episode.metrics}


def _lines(estimates: dict[str, Estimate]) -> list[tuple[str, str, str]]:
    return [
        (title, f"{estimate.mean:.3f}", f"{estimate.low:.3f} .. {estimate.high:.3f} (n = {estimate.n})")
        for title, estimate in estimates.items()
    ]
