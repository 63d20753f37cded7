"""Episodes of suites as followers drive them: one row of figures each, kept line by line."""

import json
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from ...agents import make_follower
from ...envs.follow_env import FollowEnv
from ...envs.recording.rollout import Episode, rollout
from ...envs.scenes.occupancy import true_map
from ...envs.suites import FIRST_SEED, suite
from ...slam.errors import InputError
from ...slam.files.output import write_text
from ...slam.quality.score import score_map
from ...slam.quality.trajectory import absolute_error

FIGURES = {
    "jerk_rms_mps3": "jerk RMS [m/s3]",
    "distance_error_rms_m": "distance error RMS [m]",
    "personal_space_compliance": "personal space kept",
    "sparc": "SPARC",
    "ldlj": "LDLJ",
    "min_distance_bystander_m": "nearest bystander [m]",
    "near_misses": "near misses",
    "min_ttc_s": "least time to collision [s]",
    "duration_s": "duration [s]",
    "total_reward": "return",
}
"""Figure of an episode -> its name in reports; those of `tagalong.envs.metrics`, and the environment's return."""
MAP_FIGURES = {
    "adnn_truth_to_map_m": "ADNN truth to map [m]",
    "adnn_map_to_truth_m": "ADNN map to truth [m]",
    "ate_m": "pose error (ATE) [m]",
    "coverage": "floor seen",
}
"""The same of what the robot's map is worth, and of how much of the building its laser has seen; with SLAM alone."""


def scenario_environment(name: str, number: int, slam: str | None) -> gym.Env[Any, Any]:
    """Return the environment of a suite's scenario, with this SLAM engine and coverage measured, or without both."""
    one = suite(name)[number]
    return gym.make(one.env, **{**one.arguments, "slam": slam, "coverage": slam is not None})


def episode_row(follower: str, name: str, k: int, slam: str | None) -> dict[str, Any]:
    """Drive episode `k` of a suite in the environment of its scenario; return its figures, NaN as None."""
    scenarios = suite(name)
    env = scenario_environment(name, k % len(scenarios), slam)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    driver = make_follower(follower, inner.interface)
    episode = rollout(env, driver, seed=FIRST_SEED + k, options=scenarios[k % len(scenarios)].options)
    figures = {**episode.metrics, "total_reward": episode.total_reward, **_map_figures(inner, episode)}
    env.close()
    return {
        "follower": follower,
        "suite": name,
        "episode": k,
        "ending": episode.ending,
        **{key: float(figures[key]) if np.isfinite(figures[key]) else None for key in (*FIGURES, *MAP_FIGURES)},
        "slam": slam,
    }


def _map_figures(env: FollowEnv, episode: Episode) -> dict[str, float]:
    """Return ADNN both ways between the robot's final map and the true one, and the error of its poses; else NaN."""
    none: dict[str, float] = dict.fromkeys(("adnn_truth_to_map_m", "adnn_map_to_truth_m", "ate_m"), np.nan)
    if env.config.slam is None:
        return none
    history = episode.history
    error = absolute_error(history.estimated_pose, history.robot_pose).translation.rmse
    try:
        score = score_map(env.own_map().map, true_map(env.world.scene, T_world_map=env.world.start))
    except InputError:  # too little of it
        return {**none, "ate_m": error}
    return {"adnn_truth_to_map_m": score.adnn.mean_m, "adnn_map_to_truth_m": score.ghosts.mean_m, "ate_m": error}


def finished_rows(file: Path, slam: str | None) -> list[dict[str, Any]]:
    """Return the episodes in `file`, none where it is not there yet; a last line cut by a kill is taken off.

    Args:
        file: A line an episode.
        slam: Those alone that were driven with this engine; None: without.

    Raises:
        InputError: If another line is no episode.
    """
    whole = file.read_text(encoding="utf-8").split("\n") if file.is_file() else [""]
    if whole.pop():
        write_text(file, "".join(f"{line}\n" for line in whole))
    try:
        rows = [json.loads(line) for line in whole]
        return [row for row in rows if (row["slam"] or None) == slam]
    except (json.JSONDecodeError, TypeError, KeyError) as error:
        raise InputError(f"{file}: a line is no finished episode ({error})") from error
