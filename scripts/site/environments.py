"""A page for each registered environment, made of its docstrings, its spaces and an episode's start."""

import inspect
import re
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces

from ...envs.follow_env import FollowEnv
from ...envs.registration import IDS, MAX_EPISODE_STEPS
from .docstrings import from_text, markdown
from .named import module_named
from .parameters import cell

MEANINGS = {
    "scan": "range over `range_max`, right to left; 1: no return or no measurement",
    "leader": "x, y, vx, vy of the leader, confidence, visible",
    "people": "the nearest other people: x, y, vx, vy, confidence, present",
    "velocity": "own speed and turn rate by odometry",
    "map": "cells around the robot: 0 free, 0.5 unknown, 1 occupied",
}
"""Entry of the observation -> what it holds, in a few words; the page of all environments says it in full."""
PROGRAM = """\
import gymnasium as gym
import tagalong

env = gym.make("{name}")
observation, info = env.reset(seed=0)
for _ in range(5):
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
print(info["time_s"], info["reward_terms"])
"""


def environment_pages() -> Iterator[tuple[str, str]]:
    """Yield (path, Markdown) of the page of all environments and of each one's own."""
    rows = ["| id | building |", "|---|---|"]
    for name, arguments in sorted(IDS.items()):
        page = page_name(name)
        rows.append(f"| [`{name}`]({page}) | {cell(_building(str(arguments['scene']))[0])} |")
        yield f"environments/{page}", environment_page(name)
    manual = re.sub(r"\A.*?\n\n", "", markdown(FollowEnv), flags=re.S)
    head = "# Environments\n\nAll of them are one class, `tagalong.envs.FollowEnv`, in another building each:\n\n"
    yield "environments/index.md", head + "\n".join(rows) + "\n\n" + manual + "\n"


def page_name(name: str) -> str:
    """Return the file of an environment's page."""
    return name.partition("/")[2].lower() + ".md"


def environment_page(name: str) -> str:
    """Return the page of one environment."""
    arguments = IDS[name]
    scene = str(arguments["scene"])
    env = gym.make(name)
    env.reset(seed=0)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    summary, details = _building(scene)
    parts = [
        f"# {name}",
        summary,
        f"![PID behind its leader, 3.2 times as fast, and the map that it makes](../images/environments/{scene}.webp)",
        details,
        "## Use",
        f"```python\n{PROGRAM.format(name=name)}```",
        f"```console\n$ tagalong evaluate pid --env {name} --episodes 1\n```",
        "## What is set here",
        _settings(arguments),
        "## Observation",
        _observation(inner.observation_space),
        "## Action",
        _action(inner),
        "## Episode",
        _episode(inner),
        "Rewards, options of `reset`, `info` and all arguments are the same in every environment: "
        "[Environments](index.md).",
    ]
    env.close()
    return "\n\n".join(part for part in parts if part) + "\n"


def _building(scene: str) -> tuple[str, str]:
    """Return a scene's summary in a paragraph, and what else its docstrings say."""
    module = module_named(f"envs.scenes.{scene}")
    whole = inspect.cleandoc(module.__doc__ or "").partition("\n\n")
    function = inspect.cleandoc(getattr(module, scene).__doc__ or "").removeprefix("Return ")
    function = re.sub(r"\n\nRaises:\n.*", "", function, flags=re.S)
    first, _, more = function.partition("\n\n")
    details = "\n\n".join(part for part in (whole[2], first[:1].upper() + first[1:], more) if part)
    return " ".join(whole[0].split()), from_text(details)


def _settings(arguments: dict[str, Any]) -> str:
    rows = ["| argument | value |", "|---|---|"]
    return "\n".join([*rows, *(f"| `{key}` | `{value!r}` |" for key, value in arguments.items())])


def _observation(space: spaces.Space[Any]) -> str:
    assert isinstance(space, spaces.Dict)
    rows = ["| entry | shape | type | range | what it holds |", "|---|---|---|---|---|"]
    for name, box in space.items():
        assert isinstance(box, spaces.Box)
        low, high = float(np.min(box.low)), float(np.max(box.high))
        rows.append(f"| `{name}` | {box.shape} | {box.dtype} | {low:g} .. {high:g} | {cell(MEANINGS.get(name, ''))} |")
    return "\n".join(rows)


def _action(env: FollowEnv) -> str:
    top, turn = env.interface.max_speed, env.interface.max_turn_rate
    rows = [f"`{env.action_space}`, with the robot `dingo-d`:", "", "| num | meaning | at -1 | at +1 |"]
    rows += ["|---|---|---|---|", f"| 0 | forward speed | -{top:g} m/s | {top:g} m/s |"]
    return "\n".join([*rows, f"| 1 | turn rate, counter-clockwise | -{turn:g} rad/s | {turn:g} rad/s |"])


def _episode(env: FollowEnv) -> str:
    scene, people = env.world.scene, len(env.truth.people.positions)
    return (
        f"Of seed 0: a tour of {scene.tour_length:.1f} m, one of {', '.join(f'`{name}`' for name in scene.routes)} "
        f"(`reset(options={{'route': ...}})`); {people} people, the leader among them. A step is "
        f"{1.0 / env.config.task.control_hz:g} s, and an episode is cut after {MAX_EPISODE_STEPS} of them."
    )
