"""Compares followers on the suites, episode by episode on the same seeds, full perception, with or without SLAM.

Every finished episode is a line of episodes.jsonl; the same command goes on where it was stopped. In the end
results.json holds, for each suite, the figures of each follower with 95 % intervals and, for each figure, the
paired difference between the first follower and the others with Wilcoxon's signed-rank test.

example:
  tagalong bench follower-comparison --followers learned pid --episodes 100
"""

import argparse
import json
import math
from collections.abc import Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from scipy.stats import wilcoxon

from ...agents import make_follower
from ...envs.follow_env import FollowEnv
from ...envs.recording.rollout import rollout
from ...envs.scenes.occupancy import true_map
from ...envs.suites import FIRST_SEED, SUITES, suite
from ...slam.errors import InputError
from ...slam.files.output import made_folder, write_text
from ...slam.quality.score import score_map
from ..console.arguments import at_least
from ..console.tables import format_table
from ..figures.plots import new_figure, save_figure
from ..lab.statistics import Estimate, metric_mean, share
from .results import write_results

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DEFAULT_SUITES = ("office", "corridor", "meeting_room", "floor_plan", "crowd", "hurried")
FIGURES = {
    "jerk_rms_mps3": "jerk RMS [m/s3]",
    "personal_space_compliance": "personal space kept",
    "min_distance_bystander_m": "nearest bystander [m]",
    "adnn_truth_to_map_m": "ADNN truth to map [m]",
    "adnn_map_to_truth_m": "ADNN map to truth [m]",
    "distance_error_rms_m": "distance error RMS [m]",
    "sparc": "SPARC",
    "min_ttc_s": "least time to collision [s]",
    "total_reward": "return",
}
"""What is compared, beside success; those of `tagalong.envs.metrics`, the map's errors and the environment's return."""


def episode_row(follower: str, name: str, k: int, env: gym.Env) -> dict[str, Any]:
    """Drive episode `k` of a suite and return its figures, NaN as None."""
    scenarios = suite(name)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    driver = make_follower(follower, inner.interface)
    episode = rollout(env, driver, seed=FIRST_SEED + k, options=scenarios[k % len(scenarios)].options)
    figures = {**episode.metrics, "total_reward": episode.total_reward, **_map_errors(inner)}
    return {
        "follower": follower,
        "suite": name,
        "episode": k,
        "slam": inner.config.slam is not None,
        "ending": episode.ending,
        **{key: float(figures[key]) if np.isfinite(figures[key]) else None for key in FIGURES},
    }


def _map_errors(env: FollowEnv) -> dict[str, float]:
    """Return both directions of ADNN between the robot's final map and the true one; NaN without one."""
    none = {"adnn_truth_to_map_m": np.nan, "adnn_map_to_truth_m": np.nan}
    if env.config.slam is None:
        return none
    try:
        score = score_map(env.own_map().map, true_map(env.world.scene, T_world_map=env.world.start))
    except InputError:  # too little of it
        return none
    return {"adnn_truth_to_map_m": score.adnn.mean_m, "adnn_map_to_truth_m": score.ghosts.mean_m}


def compare(rows: Sequence[dict[str, Any]], followers: Sequence[str]) -> dict[str, Any]:
    """Return for each suite the figures of each follower, and the paired tests of the first against the others."""
    result: dict[str, Any] = {}
    for name in dict.fromkeys(row["suite"] for row in rows):
        by = {who: {r["episode"]: r for r in rows if r["suite"] == name and r["follower"] == who} for who in followers}
        common = sorted(set.intersection(*(set(part) for part in by.values())))
        table = {who: [part[k] for k in common] for who, part in by.items()}
        result[name] = {
            "episodes": len(common),
            "figures": {who: _figures(part) for who, part in table.items()},
            "paired": {who: _paired(table[followers[0]], table[who]) for who in followers[1:]},
        }
    return result


TRADE_OFFS = (("jerk_rms_mps3", "success"), ("distance_error_rms_m", "personal_space_compliance"))
"""What costs what, x and y of the plots: calm driving tours, and staying close the bystanders their room."""


def draw_trade_off(result: dict[str, Any], path: Path) -> Path:
    """Draw tours done over jerk, and personal space kept over the error of the distance, each with its 95 % interval.

    Args:
        result: As `compare` returns it: two plots a suite, one above the other, a colour a follower.
        path: PNG file to write.
    """
    columns = min(3, len(result))
    rows = -(-len(result) // columns)
    figure = new_figure(4.2 * columns, 3.2 * rows * len(TRADE_OFFS))
    for (band, pair), (place, (name, part)) in product(enumerate(TRADE_OFFS), enumerate(result.items())):
        axes = figure.add_subplot(len(TRADE_OFFS) * rows, columns, band * rows * columns + place + 1)
        for who, figures in part["figures"].items():
            _point(axes, who, figures[pair[0]], figures[pair[1]])
        axes.set(title=f"{name.replace('_', ' ')}, {part['episodes']} episodes", xlabel=FIGURES[pair[0]])
        least = min(figures[pair[1]]["low"] for figures in part["figures"].values())
        axes.set(ylabel=FIGURES.get(pair[1], "tours done"), ylim=(min(0.8, least - 0.02), 1.01))
        axes.set_xlim(left=0.0)
        axes.grid(alpha=0.3)
        axes.legend(loc="lower left")
    return save_figure(path, figure)


def _point(axes: "Axes", who: str, x: dict[str, Any], y: dict[str, Any]) -> None:
    spans = [[[v["mean"] - v["low"]], [v["high"] - v["mean"]]] for v in (x, y)]
    axes.errorbar(x["mean"], y["mean"], spans[1], spans[0], "o", capsize=3, label=who)


def _figures(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    endings = [row["ending"] for row in rows]
    return {
        "success": share([ending == "tour_done" for ending in endings]).to_dict(),
        "endings": {ending or "out of time": endings.count(ending) for ending in sorted(set(endings))},
        **{key: metric_mean(key, _values(rows, key)).to_dict() for key in FIGURES},
    }


def _paired(ours: Sequence[dict[str, Any]], theirs: Sequence[dict[str, Any]]) -> dict[str, Any]:
    tests: dict[str, Any] = {}
    for key in FIGURES:
        gap = _values(ours, key) - _values(theirs, key)
        gap = gap[np.isfinite(gap)]
        moved = gap[gap != 0.0]
        p = float(tuple(wilcoxon(moved))[1]) if len(moved) else 1.0
        tests[key] = {"median_difference": float(np.median(gap)) if len(gap) else None, "p": p, "n": len(gap)}
    return tests


def _values(rows: Sequence[dict[str, Any]], key: str) -> np.ndarray:
    return np.array([np.nan if row[key] is None else row[key] for row in rows], dtype=np.float64)


def finished_rows(file: Path, maps: float = math.inf) -> list[dict[str, Any]]:
    """Return the episodes in `file`, none where it is not there yet; a last line cut by a kill is taken off.

    Args:
        file: A line an episode.
        maps: Episodes below this number count if they were driven with SLAM, the others if without.

    Raises:
        InputError: If another line is no episode.
    """
    whole = file.read_text(encoding="utf-8").split("\n") if file.is_file() else [""]
    if whole.pop():
        write_text(file, "".join(f"{line}\n" for line in whole))
    try:
        rows = [json.loads(line) for line in whole]
    except json.JSONDecodeError as error:
        raise InputError(f"{file}: a line is no finished episode ({error})") from error
    # older files do not say it: only with SLAM is there a map
    return [row for row in rows if row.get("slam", row["adnn_truth_to_map_m"] is not None) == (row["episode"] < maps)]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--followers", nargs="+", default=["learned", "pid"], metavar="WHO")
    parser.add_argument("--suites", nargs="+", default=list(DEFAULT_SUITES), choices=sorted(SUITES), metavar="SUITE")
    parser.add_argument("--episodes", type=at_least(1), default=100, metavar="N")
    parser.add_argument(
        "--maps",
        type=at_least(0),
        metavar="N",
        help="build maps in the first N episodes only (default: in all): faster",
    )
    parser.add_argument("--plot", action="store_true", help="draw tours done over jerk (extra viz)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    options.followers = list(dict.fromkeys(options.followers))
    file = made_folder(options.out) / "episodes.jsonl"
    maps = math.inf if options.maps is None else options.maps
    rows = finished_rows(file, maps)
    scenario = cache(_scenario)  # an environment serves all episodes of its scenario
    done = {(row["follower"], row["suite"], row["episode"]) for row in rows}
    for k in range(options.episodes):
        for name, who in product(options.suites, options.followers):
            if (who, name, k) not in done:
                rows.append(episode_row(who, name, k, scenario(name, k % len(suite(name)), k < maps)))
                with file.open("a", encoding="utf-8") as lines:
                    lines.write(json.dumps(rows[-1]) + "\n")
    result = compare(rows, options.followers)
    write_results(options, {"suites": result})
    if options.plot:
        print(draw_trade_off(result, options.out / "trade_off.png"))
    for name, part in result.items():
        print(f"\n{name}, {part['episodes']} episodes each")
        print(format_table(("figure", *options.followers), _lines(part["figures"])))
    return 0


def _scenario(name: str, number: int, mapped: bool) -> gym.Env:
    one = suite(name)[number]
    return gym.make(one.env, **{**one.arguments, **({} if mapped else {"slam": None})})


def _lines(figures: dict[str, Any]) -> list[tuple[str, ...]]:
    titles = {"success": "tours done", **FIGURES}
    return [
        (
            title,
            *(Estimate(**part[key]).text(digits=3) for part in figures.values()),
        )
        for key, title in titles.items()
    ]
