"""Whether a follower drives the same in compiled worlds as in MuJoCo's: the same episodes of the suites in both.

Building, people and start are those of the same seed; noise of laser and wheels is drawn anew. Figures with 95 %
intervals, and Student's interval of the difference, compiled less MuJoCo, episode by episode; of the shares, too.

example:
  tagalong bench simulators --followers pid pure_pursuit --suites corridor office --episodes 20
"""

import argparse
from collections.abc import Iterable
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ...agents import make_follower
from ...envs import CompiledVectorEnv, FollowEnv
from ...envs.metrics.following import FOLLOWING_DISTANCE
from ...envs.metrics.smoothness import low_pass
from ...envs.suites import FIRST_SEED, SUITES, Scenario, suite
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.statistics import Estimate, share, t_mean
from .results import write_results

Array = NDArray[np.float64]

SHARES = ("tour done", "touched somebody", "touched something", "leader lost")
FIGURES = (*SHARES, "jerk RMS [m/s3]", "distance error RMS [m]", "steps in somebody's personal space", "length [s]")
"""What is compared."""
STEPS = 1500
"""Most control periods of an episode: longer than any tour."""
_UNDER_WAY_S = 5.0


class Trace:
    """What an episode told, step by step.

    Args:
        step_s: Length of a control period [s].
    """

    def __init__(self, step_s: float) -> None:
        self._step_s = step_s
        self._rows: list[tuple[float, float, float, float, float]] = []
        self.ending = ""

    def add(self, pose: Array, distance: float, personal_space: float, ending: str) -> None:
        """Take a step: the robot's pose (3,), its distance from the leader [m], a term of the reward, the ending."""
        self._rows.append((*pose.tolist(), float(distance), float(personal_space)))
        self.ending = ending

    def figures(self) -> dict[str, float]:
        """Return `FIGURES` by name; NaN where an episode was too short."""
        rows = np.array(self._rows)
        moved, theta = np.diff(rows[:, :2], axis=0), rows[:-1, 2]
        speed = (moved[:, 0] * np.cos(theta) + moved[:, 1] * np.sin(theta)) / self._step_s
        jerk = np.diff(low_pass(speed, 1.0 / self._step_s), 2) / self._step_s**2
        error = rows[round(_UNDER_WAY_S / self._step_s) :, 3] - FOLLOWING_DISTANCE
        endings = ("tour_done", "collision_person", "collision_static", "leader_lost")
        values = (
            *(float(self.ending == ending) for ending in endings),
            _rms(jerk),
            _rms(error),
            float((rows[:, 4] < 0.0).mean()),
            len(rows) * self._step_s,
        )
        return dict(zip(FIGURES, values, strict=True))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


def mujoco_traces(scenario: Scenario, follower: str, seeds: list[int], **fields: Any) -> list[Trace]:
    """Drive an episode for each seed, one after the other."""
    env = gym.make(scenario.env, disable_env_checker=True, **{**scenario.arguments, **fields})
    inner, traces = env.unwrapped, []
    assert isinstance(inner, FollowEnv)
    driver = make_follower(follower, inner.interface)
    for seed in seeds:
        observation, _ = env.reset(seed=seed, options=scenario.options)
        driver.reset()
        trace = Trace(1.0 / inner.interface.control_hz)
        for _ in range(STEPS):
            observation, _, terminated, truncated, info = env.step(driver.act(observation))
            space = info["reward_terms"]["personal_space"]
            trace.add(info["robot_pose"], info["leader_distance"], space, info["ending"])
            if terminated or truncated:
                break
        traces.append(trace)
    env.close()
    return traces


def compiled_traces(scenario: Scenario, follower: str, seeds: list[int], **fields: Any) -> list[Trace]:
    """Drive an episode for each seed, all at once."""
    env = gym.make_vec(
        scenario.env, len(seeds), "vector_entry_point", simulator="compiled", own_start=True, episodes_ahead=1,
        workers=1, autoreset_mode="NextStep", **{**scenario.arguments, **fields},
    )  # fmt: skip
    assert isinstance(env, CompiledVectorEnv)
    drivers = [make_follower(follower, env.interface) for _ in seeds]
    batch, _ = env.reset(seed=seeds, options=dict(scenario.options))
    for driver in drivers:
        driver.reset()
    traces, running = [Trace(1.0 / env.interface.control_hz) for _ in seeds], np.ones(len(seeds), dtype=bool)
    actions = np.zeros(env.action_space.shape or (), dtype=np.float32)
    for _ in range(STEPS):
        for i in np.flatnonzero(running).tolist():
            actions[i] = drivers[i].act({key: value[i] for key, value in batch.items()})
        batch, _, terminated, truncated, told = env.step(actions)
        for i in np.flatnonzero(running).tolist():
            space = told["reward_terms"]["personal_space"][i]
            traces[i].add(told["robot_pose"][i], told["leader_distance"][i], space, str(told["ending"][i]))
        running &= ~(terminated | truncated)
        if not running.any():
            break
    env.close()
    return traces


def compared(name: str, follower: str, episodes: int, **fields: Any) -> dict[str, dict[str, Estimate]]:
    """Return for each figure the estimates of both simulators, and of the difference."""
    scenarios = suite(name)
    pairs: list[tuple[dict[str, float], dict[str, float]]] = []
    for which, scenario in enumerate(scenarios):
        seeds = [FIRST_SEED + k for k in range(which, episodes, len(scenarios))]
        if seeds:
            of_both = (traces(scenario, follower, seeds, **fields) for traces in (mujoco_traces, compiled_traces))
            pairs += zip(*([trace.figures() for trace in traces] for traces in of_both), strict=True)
    return {figure: _estimates(figure, [(a[figure], b[figure]) for a, b in pairs]) for figure in FIGURES}


def _estimates(figure: str, pairs: Iterable[tuple[float, float]]) -> dict[str, Estimate]:
    ours, theirs = (np.array(values) for values in zip(*pairs, strict=True))
    both = {"mujoco": ours, "compiled": theirs}
    told = {who: share((v > 0.0).tolist()) if figure in SHARES else t_mean(v) for who, v in both.items()}
    return {**told, "difference": t_mean(theirs - ours)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--followers", nargs="+", default=["pid"], metavar="WHO")
    parser.add_argument("--suites", nargs="+", default=["corridor", "office"], choices=sorted(SUITES), metavar="SUITE")
    parser.add_argument("--episodes", type=at_least(1), default=20, metavar="N", help="of each (default: %(default)s)")
    parser.add_argument("--people", choices=("truth", "modelled"), default="truth", help="default: %(default)s")
    parser.add_argument("--beams", type=at_least(2), default=360, metavar="N", help="default: %(default)s")


def run(options: argparse.Namespace) -> int:
    """Drive, print, write results.json."""
    result: dict[str, Any] = {}
    for name in options.suites:
        for who in options.followers:
            rows = compared(name, who, options.episodes, people=options.people, slam=None, beams=options.beams)
            result[f"{name}, {who}"] = {
                figure: {part: value.to_dict() for part, value in of.items()} for figure, of in rows.items()
            }
            lines = [
                (figure, *(of[part].text(digits=3) for part in ("mujoco", "compiled", "difference")), _verdict(of))
                for figure, of in rows.items()
            ]
            title = f"{name}, {who}, {options.episodes} episodes"
            print(format_table((title, "MuJoCo", "compiled", "difference", ""), lines), end="\n\n", flush=True)
    write_results(options, {"suites": result})
    return 0


def _verdict(of: dict[str, Estimate]) -> str:
    """Return "apart" where the difference is surely not 0."""
    return "apart" if of["difference"].low > 0.0 or of["difference"].high < 0.0 else ""
