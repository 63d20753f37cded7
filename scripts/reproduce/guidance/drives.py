"""Cells that map a building under one guide."""

from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import gymnasium as gym
import numpy as np

from ....agents import RandomWalk, RandomWalkConfig, make_follower
from ....agents.teleop.joystick import JoystickReplay, write_joystick_log
from ....agents.teleop.joystick_drive import record_drive
from ....envs.follow_env import FollowEnv
from ....envs.recording.rollout import Episode, rollout
from ....envs.scenes.occupancy import true_map
from ....slam.errors import InputError
from ....slam.geometry import inverse, transform_points
from ....slam.quality.score import score_map
from ....slam.quality.trajectory import absolute_error
from ...figures.video import save_gif
from ...lab.cells import TIMING

GUIDES = ("pid", "pure_pursuit", "dwa", "reinforced", "mapper", "joystick", "random", "frontier")
"""Those of the report; more followers may be added by name (`--also`)."""
UNLED = ("joystick", "random", "frontier")
"""Those who follow nobody."""
SCENES = {"corridor": "tagalong/Corridor-v0", "meeting_room": "tagalong/MeetingRoom-v0", "office": "tagalong/Office-v0"}
BYSTANDERS, STANDING = 2, 1
CURVE_STEP_S = 10.0
"""Time between two values of the kept curve of coverage [s]."""
_METRICS = (
    "duration_s",
    "coverage",
    "time_to_90_s",
    "time_to_95_s",
    "time_to_99_s",
    "jerk_rms_mps3",
    "sparc",
    "ldlj",
    "contacts_people",
    "contacts_static",
    "near_misses",
    "min_distance_bystander_m",
    "personal_space_compliance",
    "min_ttc_s",
    "path_length_m",
    "band_1_2_m_share",
    "losses",
    "reacquired",
)
_FRAME_S, _FRAMES = 1.5, 40


class _Watch:
    """Collects legs of people, and frames where asked."""

    def __init__(self, frames: bool) -> None:
        self.legs: list[np.ndarray] = []
        self.frames: list[np.ndarray] = []
        self._wants = frames
        self._calls = 0

    def __call__(self, env: FollowEnv) -> None:
        if self._calls % 5 == 0:
            self.legs.append(env.truth.people.legs.reshape(-1, 2))
        if (
            self._wants
            and len(self.frames) < _FRAMES
            and self._calls % round(_FRAME_S * env.config.task.control_hz) == 0
        ):
            picture = env.render()
            assert picture is not None
            self.frames.append(picture)
        self._calls += 1


def guide_drive(guide: str, scene: str, seed: int, limit_s: float, files: Path | None = None) -> dict[str, Any]:
    """Map one building under one guide.

    Args:
        guide: One of `GUIDES`, or any other follower that `make_follower` knows.
        scene: One of `SCENES`.
        seed: Of the building, the people, the odometry; the same for all guides.
        limit_s: Most simulated time [s].
        files: Where the joystick's log and a video go; None: nowhere.
    """
    started, cpu = perf_counter(), process_time()
    arguments = _arguments(guide, limit_s)
    env = gym.make(SCENES[scene], render_mode=None if files is None else "rgb_array", **arguments)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    watch = _Watch(files is not None)
    operator = {"commands": 0, "active_s": 0.0, "screen": guide == "joystick"}
    steps = None
    if guide == "joystick":
        log = record_drive(SCENES[scene], arguments, seed)
        operator |= {"commands": len(log.changes), "active_s": log.active_s}
        if files is not None:
            write_joystick_log(files / "joystick.txt", log)
        driver, steps = JoystickReplay(log, SCENES[scene], arguments, seed), len(log.actions)
    elif guide == "random":
        driver = RandomWalk(inner.interface, RandomWalkConfig(seed=seed))
    else:
        driver = make_follower(guide, inner.interface)
    episode = rollout(env, driver, seed=seed, steps=steps, after_step=watch)
    if guide not in UNLED:
        operator["active_s"] = episode.metrics["duration_s"]
    result = {**_figures(episode), "operator": operator, "map": _map_figures(inner, episode, watch.legs)}
    if files is not None:
        save_gif(files / "drive.gif", watch.frames, fps=8.0, width=560)
    env.close()
    return {**result, TIMING: {"wall_s": perf_counter() - started, "cpu_s": process_time() - cpu}}


def _arguments(guide: str, limit_s: float) -> dict[str, Any]:
    """Return the environment's arguments, plain JSON: a leader more for those who follow one."""
    led = guide not in UNLED
    return {
        "leader": led,
        "people_count": BYSTANDERS + led,
        "standing": STANDING,
        "slam": "cartographer",
        "coverage": True,
        "coverage_goal": 1.0 if guide == "joystick" else 0.99,
        "ends_on_contact": False,
        "max_episode_steps": round(limit_s * 10.0),
    }


def _figures(episode: Episode) -> dict[str, Any]:
    """Return plain figures of the episode; None for what it cannot give."""
    metrics, history = episode.metrics, episode.history
    figures = {name: _plain(metrics.get(name, np.nan)) for name in _METRICS}
    every = round(CURVE_STEP_S / history.step_s)
    curve = [round(float(value), 4) for value in history.coverage[::every]]
    return {"ending": episode.ending, **figures, "curve": curve}


def _map_figures(env: FollowEnv, episode: Episode, legs: list[np.ndarray]) -> dict[str, Any] | None:
    """Return what the robot's final map is worth against the true one; None where there is too little map."""
    start = env.world.start
    truth = true_map(env.world.scene, T_world_map=start)
    people = transform_points(inverse(start), np.concatenate([row[np.isfinite(row).all(axis=1)] for row in legs]))
    try:
        score = score_map(env.own_map().map, truth, people)
    except InputError:
        return None
    history = episode.history
    error = absolute_error(history.estimated_pose, history.robot_pose).translation
    residue = score.residue
    return {
        "truth_to_map_m": _plain(score.adnn.mean_m),
        "map_to_truth_m": _plain(score.ghosts.mean_m),
        "coverage": _plain(score.cells.free_coverage),
        "residue": None if residue is None else residue.cells,
        "ate_m": _plain(error.rmse),
    }


def _plain(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
