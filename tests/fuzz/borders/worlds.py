"""Compiled worlds: keyword arguments of `make_vec`, calls of `reset` and `step`, and their benchmark's options."""

import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from borders.environment import arguments, hostile_action, reset_options
from borders.options import run_words, sane_end
from fuzzer.border import Area, Border, Input, require
from fuzzer.sanity import finite
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.slam import InputError

_CHEAP: dict[str, Any] = {"beams": 16, "people_count": 1, "episodes_ahead": 2, "workers": 1}
_OWN = {
    "workers": 1, "max_episode_steps": 20, "autoreset_mode": "SameStep", "episodes_ahead": 2, "episodes_seed": 0,
    "own_start": False,
}  # fmt: skip
_MODES = ("NextStep", "SameStep", "Disabled")
_WORLDS = 3
MOST_NUMBERS = 5e7


def _made_with(rng: Generator) -> Input:
    """Return arguments of `make_vec`: the environment's, and those of compiled worlds."""
    fields = arguments(rng) if rng.random() < 0.7 else []
    for _ in range(int(rng.integers(0 if fields else 1, 3))):
        name = list(_OWN)[int(rng.integers(len(_OWN)))]
        sound = name == "autoreset_mode" and rng.random() < 0.5
        value = _MODES[int(rng.integers(3))] if sound else hostile_value(rng, _OWN[name])
        fields.append([name, value])
    worlds = _WORLDS if rng.random() < 0.8 else hostile_value(rng, _WORLDS)
    return {"worlds": worlds, "fields": fields}


def _made(value: Input, folder: Path) -> Any:
    fields = {**_CHEAP, **dict(value["fields"])}
    env = gymnasium.make_vec(
        "tagalong/PlainCorridor-v0", value["worlds"], "vector_entry_point", simulator="compiled", **fields
    )
    total = sum(int(np.prod(space.shape, dtype=np.float64)) for space in env.observation_space.values())
    require(total <= MOST_NUMBERS, f"an observation of {total:.3g} numbers")
    few = env.num_envs <= 8 and fields["episodes_ahead"] <= 8  # others are drawn for minutes, as was asked
    try:
        return _some_steps(env, [env.reset(seed=1)]) if few else []
    finally:
        env.close()


def _some_steps(env: Any, seen: list[Any]) -> Any:
    for _ in range(2):
        observation, rewards, _, _, info = env.step(np.full(env.action_space.shape, 0.5))
        finite(rewards, "rewards")
        seen.append((observation, info))
    for observation, _ in seen:
        require(env.observation_space.contains(observation), "an observation leaves its space")
    return seen


@cache
def _env() -> Any:
    return gymnasium.make_vec(
        "tagalong/PlainCorridor-v0", _WORLDS, "vector_entry_point", simulator="compiled", **_CHEAP
    )


def _calls(rng: Generator) -> Input:
    """Return a seed, options and a mask for `reset`, and actions for all worlds."""
    seed = [3, [1, 2, None], hostile_value(rng)][int(rng.integers(3))]
    mask = [[True] * _WORLDS, [True, False, False], [0.5], hostile_value(rng)][int(rng.integers(4))]
    options = reset_options(rng) if rng.random() < 0.5 else []
    options += [["reset_mask", mask]] if rng.random() < 0.3 else []
    calls: list[Any] = [rng.uniform(-2.0, 2.0, (_WORLDS, 2)).tolist()]
    if rng.random() < 0.6:
        calls.append([hostile_action(rng) for _ in range(_WORLDS)] if rng.random() < 0.7 else hostile_value(rng))
    return {"seed": 3 if rng.random() < 0.5 else seed, "options": options, "calls": calls}


def _called(value: Input, folder: Path) -> Any:
    env = _env()
    env.reset(seed=0)
    seen = [env.reset(seed=value["seed"], options=dict(value["options"]))]
    for actions in value["calls"]:
        before = _poses(env)
        try:
            observation, rewards, _, _, info = env.step(actions)
        except InputError:
            require(np.array_equal(before, _poses(env)), "somebody moved though the action was refused")
            raise
        finite(rewards, "rewards")
        seen.append((observation, info))
    for observation, _ in seen:
        require(env.observation_space.contains(observation), "an observation leaves its space")
    return seen


def _poses(env: Any) -> np.ndarray:
    return np.array(env.unwrapped._state.bodies.position)


def _bench(rng: Generator) -> Input:
    """Return a command line that the benchmark has to refuse at once."""
    words = ["bench", "worlds", "--out", "OUT"]
    never = ("0", "-1", "nan", "1.5", "", "x", "9" * 5000, "99999999", "\x00", "½")
    option = ("--seconds", "--worlds")[int(rng.integers(2))]
    return [*words, option, never[int(rng.integers(len(never)))]]


def _refused(value: Input, folder: Path) -> Any:
    run_words(value, folder)
    require(False, f"taken: {value}"[:500])


def _warm() -> None:
    with tempfile.TemporaryDirectory() as folder:
        _called({"seed": 1, "options": [["people", 2]], "calls": [np.zeros((_WORLDS, 2)).tolist()]}, Path(folder))
        for fields in ([["drive", "differential"]], [["people_count", 3]]):
            _made({"worlds": 2, "fields": fields}, Path(folder))


_GYMNASIUM = (gymnasium.error.Error,)

AREA = Area(
    (
        Border(name="worlds.arguments", make=_made_with, call=_made, ms=20.0, refusals=_GYMNASIUM),
        Border(name="worlds.calls", make=_calls, call=_called, ms=10.0, refusals=_GYMNASIUM),
        Border(name="worlds.bench", make=_bench, call=_refused, sane=sane_end, ms=3.0),
    ),
    _warm,
)
