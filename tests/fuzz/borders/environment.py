"""The environment: its arguments, the options of `reset`, actions, files that a scene is made of, followers."""

from functools import cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from borders.logs import hostile
from fuzzer import grammars
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put, put_all
from fuzzer.mutations import extreme_float, mutated_bytes, mutated_text
from fuzzer.sanity import finite
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.agents import EXPLORERS, FOLLOWERS, make_follower
from tagalong.envs import FollowConfig, FollowEnv, FollowVectorEnv
from tagalong.envs.episode_setup import OPTIONS
from tagalong.envs.follow_config import ARGUMENTS
from tagalong.envs.task import FollowInterface

CHEAP: dict[str, Any] = {"scene": "plain_corridor", "slam": None, "people": "truth", "beams": 16, "people_count": 1}
_WORDS = {
    "scene": ["corridor", "meeting_room", "landmarks", "doorway", "clutter", "nowhere"], "split": ["train", "test"],
    "slam": ["ekf", "truth", None], "people": ["truth", "tracker", "camera"], "drive": ["holonomic", "differential"],
    "odometry": ["perfect", "slipping"], "leader_style": ["steady", "hurried", "waits"], "mapping": ["immobile"],
    "camera": ["kinect-v2", None], "robot": ["dingo-o", "pioneer"], "route": ["there", "0"], "leader": [False, True],
}  # fmt: skip
MOST_NUMBERS = 5e7
"""Of an observation: two hundred megabytes a step are none."""


def _field(rng: Generator, name: str, usual: Any) -> list[Any]:
    """Return a name and a value: one of those that make sense in a third of all cases."""
    known = _WORDS.get(name)
    if known and rng.random() < 0.5:
        return [name, known[int(rng.integers(len(known)))]]
    return [name, hostile_value(rng, usual)]


def _usual(name: str) -> Any:
    """Return the default of an argument; None where it belongs to a branch that is off."""
    value: Any = FollowConfig()
    for part in name.split("."):
        value = getattr(value, part, None)
    return value


def arguments(rng: Generator) -> Input:
    """Return one to three arguments as pairs of name and value."""
    every = [*((name, _usual(name)) for name in ARGUMENTS), *((name, None) for name in _WORDS if name != "route")]
    chosen = [every[int(k)] for k in rng.integers(0, len(every), int(rng.integers(1, 4)))]
    extra = (
        [[["unheard_of", "render_mode", "render_backend"][int(rng.integers(3))], "x"]] if rng.random() < 0.05 else []
    )
    return [_field(rng, name, usual) for name, usual in chosen] + extra


def _made(value: Input, folder: Path) -> Any:
    env = FollowEnv(**{**CHEAP, **dict(value)})
    env.close()
    return env


def _sane_spaces(env: Any) -> None:
    total = sum(int(np.prod(space.shape, dtype=np.float64)) for space in env.observation_space.values())
    require(total <= MOST_NUMBERS, f"an observation of {total:.3g} numbers")
    for space in env.observation_space.values():
        require(np.isfinite(space.low).all() and np.isfinite(space.high).all(), "bounds that are not finite")


def _lived(value: Input, folder: Path) -> Any:
    env = FollowEnv(**{**CHEAP, **dict(value)})
    return _some_steps(env, env.reset(seed=1))


def _some_steps(env: Any, first: Any) -> Any:
    seen = [first]
    for _ in range(2):
        observation, reward, _, _, info = env.step(np.full(env.action_space.shape, 0.5))
        seen.append((observation, {**info, "reward": reward}))
    return env, seen


def sane_episode(result: Any) -> None:
    """Require observations within their space and finite rewards."""
    env, seen = result
    for observation, info in seen:
        for name, values in observation.items():
            require(env.observation_space[name].contains(values), f"observation {name} leaves its space")
        finite(info.get("reward", 0.0), "reward")
        finite(info["robot_pose"], "the robot's pose", 1e4)


def reset_options(rng: Generator) -> Input:
    """Return one to three options of `reset` as pairs of name and value."""
    usual = {"people": 2, "standing": 0, "scene": "corridor", "route": None}
    names = [*OPTIONS, *OPTIONS, "unheard_of"]
    chosen = [names[int(k)] for k in rng.integers(0, len(names), int(rng.integers(1, 4)))]
    return [_field(rng, name, usual.get(name)) for name in chosen]


def _options(rng: Generator) -> Input:
    options = reset_options(rng)
    if rng.random() < 0.03:
        options = hostile_value(rng)
    return {"options": options, "seed": hostile_value(rng, 3) if rng.random() < 0.2 else int(rng.integers(100))}


@cache
def _env() -> FollowEnv:
    return FollowEnv(**CHEAP)


def _reset(value: Input, folder: Path) -> Any:
    options = value["options"]
    if isinstance(options, list) and all(isinstance(pair, list) and len(pair) == 2 for pair in options):
        options = dict(options)
    env = _env()
    return _some_steps(env, env.reset(seed=value["seed"], options=options))


def _actions(rng: Generator) -> Input:
    """Return up to six calls: actions of extreme numbers, other shapes and kinds, and renderings."""
    return [hostile_action(rng) for _ in range(int(rng.integers(1, 7)))]


def hostile_action(rng: Generator) -> Input:
    """Return an action of one environment: numbers, of any shape or kind, or another call."""
    draw = rng.random()
    if draw < 0.5:
        return [extreme_float(rng), extreme_float(rng)]
    if draw < 0.7:
        return rng.uniform(-1, 1, int(rng.integers(0, 5))).tolist()
    return hostile_value(rng) if draw < 0.9 else ("render", "save", "close")[int(rng.integers(3))]


def _acted(value: Input, folder: Path) -> Any:
    env = FollowEnv(**CHEAP)  # an input may close it
    seen = [env.reset(seed=0)]
    for action in value:
        if action == "render":
            env.render()
        elif action == "save":
            env.restore_state(env.save_state())
        elif action == "close":
            env.close()
        else:
            observation, reward, _, _, info = env.step(action)
            seen.append((observation, {**info, "reward": reward}))
    return env, seen


@cache
def _vector() -> FollowVectorEnv:
    return FollowVectorEnv(2, workers=1, **CHEAP)


def _vector_calls(rng: Generator) -> Input:
    """Return what is asked of `reset` of two environments at once, and some actions."""
    seed = [3, [1, 2], hostile_value(rng)][int(rng.integers(3))]
    mask = [[True, True], [True, False], [0.5], hostile_value(rng)][int(rng.integers(4))]
    calls: list[Any] = [rng.uniform(-2.0, 2.0, (2, 2)).tolist() for _ in range(2)]
    if rng.random() < 0.6:
        calls[1] = [hostile_action(rng), hostile_action(rng)] if rng.random() < 0.7 else hostile_value(rng)
    seed = 3 if rng.random() < 0.5 else seed
    return {"seed": seed, "options": [["reset_mask", mask]] if rng.random() < 0.3 else [], "calls": calls}


def _vector_called(value: Input, folder: Path) -> Any:
    env = _vector()
    env.reset(seed=0)
    results = [env.reset(seed=value["seed"], options=dict(value["options"]))]
    results += [env.step(actions) for actions in value["calls"]]
    return [np.asarray(result[1]) for result in results[1:]]


def _files(rng: Generator) -> Input:
    """Return a floor plan, or recorded walks, of which something is wrong."""
    if rng.random() < 0.5:
        return {"walks.txt": hostile(grammars.straight_walks)(rng)}
    yaml = grammars.map_yaml(rng).replace(b"resolution: 0.05", b"resolution: 0.1")
    files = {"map.yaml": yaml, "map.pgm": grammars.floor_plan(rng)}
    if rng.random() < 0.5:
        return {**files, "map.yaml": mutated_text(rng, files["map.yaml"])}
    return {**files, "map.pgm": mutated_bytes(rng, files["map.pgm"])}


def _built(value: Input, folder: Path) -> Any:
    if "walks.txt" in value:
        env = FollowEnv(
            **{**CHEAP, "people_count": 3, "walking_paths": str(put(folder, "walks.txt", value["walks.txt"]))}
        )
    else:
        plan = put_all(folder / "plan", value) / "map.yaml"
        env = FollowEnv(**{**CHEAP, "scene": "floor_plan", "floor_plan": str(plan)})
    return _some_steps(env, env.reset(seed=1))


def _observed(rng: Generator) -> Input:
    """Return what a follower may be shown: numbers of beams that it does not expect, leaders far away or lost."""
    beams = int(rng.choice([2, 16, 91, 181, 360, 1081]))
    scan = np.round(np.clip(rng.uniform(-0.1, 1.2, beams), 0.0, 1.0), 3).tolist()
    leader = [
        float(np.clip(extreme_float(rng), -30, 30)) if rng.random() < 0.2 else float(v) for v in rng.uniform(-1, 3, 6)
    ]
    name = [*FOLLOWERS, *EXPLORERS][int(rng.integers(len(FOLLOWERS) + len(EXPLORERS)))]
    return {"who": name, "known": bool(rng.random() < 0.5), "scan": scan, "leader": np.nan_to_num(leader).tolist()}


def _followed(value: Input, folder: Path) -> Any:
    bearings = np.deg2rad(np.linspace(-135.0, 135.0, len(value["scan"])))
    follower = make_follower(value["who"], FollowInterface(bearings=bearings) if value["known"] else None)
    follower.reset()
    observation = {
        "scan": np.array(value["scan"], np.float32), "leader": np.array(value["leader"], np.float32),
        "people": np.zeros((6, 6), np.float32), "velocity": np.zeros(2, np.float32),
    }  # fmt: skip
    return [follower.act(observation) for _ in range(3)]


def _warm() -> None:
    _acted([[0.1, 0.1], "save"], Path())
    for name in ("corridor", "meeting_room", "landmarks", "doorway"):
        _lived([["scene", name], ["people", "tracker"], ["slam", "ekf"], ["people_count", 3]], Path())
    for name in FOLLOWERS:
        _followed({"who": name, "known": True, "scan": [0.5] * 91, "leader": [1, 0, 0, 0, 1, 1]}, Path())


_GYMNASIUM = (gymnasium.error.Error,)  # what `reset` of the library itself says of a seed

AREA = Area(
    (
        Border(name="environment.arguments", make=arguments, call=_made, sane=_sane_spaces, ms=2.4),
        Border(name="environment.episodes", make=arguments, call=_lived, sane=sane_episode, ms=5.5),
        Border(
            name="environment.reset_options", make=_options, call=_reset, sane=sane_episode, ms=3.4,
            refusals=_GYMNASIUM,
        ),
        Border(name="environment.actions", make=_actions, call=_acted, sane=sane_episode, ms=12.0),
        Border(
            name="environment.vector", make=_vector_calls, call=_vector_called, ms=31.0, refusals=_GYMNASIUM,
            sane=lambda rewards: finite(rewards, "rewards"),
        ),
        Border(name="environment.files", make=_files, call=_built, sane=sane_episode, ms=38.0),
        Border(
            name="environment.followers", make=_observed, call=_followed, ms=5.1,
            sane=lambda actions: finite(actions, "actions", 1.0),
        ),
    ),
    _warm,
)  # fmt: skip
