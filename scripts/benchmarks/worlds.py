"""How many steps a second compiled worlds make, beside the single environment, with what they take of memory.

Random actions, resets included; contacts end episodes, as they do in training. Times are the processor's of all
threads, and the clock's beside them: on a machine that does other things the first is the one to compare. One thread
and two take turns; what the second brings is in the clock's column, and only where nothing else wants its core.
Everything is compiled and drawn before it is timed.

Where IR-SIM is installed (pip install ir-sim), it is measured beside them.

With --simulator cuda the worlds are a GPU's, and all that is told is fetched to the processor; the clock's time alone
tells there. Take tens of thousands of them.

examples:
  tagalong bench worlds --seconds 5
  tagalong bench worlds --simulator cuda --worlds 65536
"""

import argparse
from time import perf_counter, process_time
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ...envs import CompiledVectorEnv
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.hardware import describe_machine, reference_kernel_s
from .ir_sim import NAME as IR_SIM
from .ir_sim import ir_sim_speed
from .results import write_results

CASES: dict[str, dict[str, Any]] = {
    "office, 5 bystanders, 360 beams": {"id": "Office", "people_count": 6, "beams": 360},
    "office, 5 bystanders, 180 beams": {"id": "Office", "people_count": 6, "beams": 180},
    "office, 5 bystanders, 1081 beams": {"id": "Office", "people_count": 6, "beams": 1081},
    "office, nobody else, 360 beams": {"id": "Office", "people_count": 1, "beams": 360},
    "office, 12 bystanders, 360 beams": {"id": "Office", "people_count": 13, "beams": 360},
    "corridor, 1 bystander, 360 beams": {"id": "Corridor", "people_count": 2, "beams": 360},
}
"""Name -> the environment's id and arguments."""
PEOPLE = "truth", "modelled", "tracker"
"""How the robots know of people."""
THREADS = (1, 2)
ROUNDS = 5
"""How often the numbers of threads take turns, so that all meet the same other work on the machine."""
_LEAST = 20  # steps before and in a measurement


def made_worlds(worlds: int, **fields: Any) -> CompiledVectorEnv:
    """Return compiled worlds that have begun and are warm.

    Args:
        worlds: How many.
        fields: The environment's id and arguments.
    """
    name, given = fields["id"], {"simulator": "compiled", **fields}
    given.pop("id")
    env = gym.make_vec(f"tagalong/{name}-v0", worlds, "vector_entry_point", **given)
    assert isinstance(env, CompiledVectorEnv)
    env.reset(seed=0)
    _step(env, _actions(worlds), 0.0)
    return env


def _actions(worlds: int) -> NDArray[np.float32]:
    return np.random.default_rng(0).uniform(-1.0, 1.0, (16, worlds, 2)).astype(np.float32)


def _step(env: CompiledVectorEnv, actions: NDArray[np.float32], seconds: float) -> tuple[int, float, float]:
    """Step for `seconds` [s]; return steps of all worlds, time of the processor and of the clock [s]."""
    steps, begun, used = 0, perf_counter(), process_time()
    while perf_counter() - begun < seconds or steps < _LEAST:
        env.step(actions[steps % 16])
        steps += 1
    return steps * env.num_envs, process_time() - used, perf_counter() - begun


def world_speeds(worlds: int, seconds: float, **fields: Any) -> list[dict[str, float]]:
    """Return steps a second, by the processor's time and by the clock's, on each number of `THREADS` in turn.

    Args:
        worlds: How many.
        seconds: For how long to measure each [s].
        fields: The environment's id and arguments.
    """
    envs = [made_worlds(worlds, workers=threads, **fields) for threads in THREADS]
    actions = _actions(worlds)
    rounds = [[_step(env, actions, seconds / ROUNDS) for env in envs] for _ in range(ROUNDS)]
    rows = []
    for k, env in enumerate(envs):
        steps, used, clock = (sum(times[k][part] for times in rounds) for part in range(3))
        rows.append({"per_core": steps / used, "per_clock": steps / clock, "memory_mb": env.memory / 1e6})
        env.close()
    return rows


def gpu_speed(worlds: int, seconds: float, **fields: Any) -> dict[str, float]:
    """Return steps a second by the clock's time, and memory, of worlds on a GPU.

    Args:
        worlds: How many.
        seconds: For how long to measure [s].
        fields: The environment's id and arguments.
    """
    env = made_worlds(worlds, simulator="cuda", **fields)
    steps, _, clock = _step(env, _actions(worlds), seconds)
    env.close()
    return {"per_clock": steps / clock, "memory_mb": env.memory / 1e6}


def single_speed(seconds: float, **fields: Any) -> float:
    """Return steps per second of processor time of one `FollowEnv` with the same people and laser, resets included."""
    name, given = fields["id"], {key: value for key, value in fields.items() if key != "id"}
    env = gym.make(f"tagalong/{name}-v0", disable_env_checker=True, people="truth", slam=None, **given)
    env.action_space.seed(0)
    env.reset(seed=0)
    steps, begun, used = 0, perf_counter(), process_time()
    while perf_counter() - begun < seconds or steps < _LEAST:
        _, _, terminated, truncated, _ = env.step(env.action_space.sample())
        if terminated or truncated:
            env.reset()
        steps += 1
    used = process_time() - used
    env.close()
    return steps / used


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--seconds", type=at_least(1, 86_400), default=10, help="duration of each measurement (default: %(default)s)"
    )
    parser.add_argument("--worlds", type=at_least(1, 65_536), default=256, help="worlds of each (default: %(default)s)")
    parser.add_argument("--simulator", choices=("compiled", "cuda"), default="compiled", help="default: %(default)s")


def run(options: argparse.Namespace) -> int:
    """Measure, print tables, write results.json."""
    machine, kernel_ms = describe_machine(), 1e3 * reference_kernel_s()
    print(f"{machine['processor']}, {machine['cores']} cores; reference numpy kernel: {kernel_ms:.1f} ms\n")
    rows = gpu_rows(options) if options.simulator == "cuda" else processor_rows(options)
    table = [
        (name, *(_shown(row, key) for key in ("per_core", "per_clock", "memory_mb"))) for name, row in rows.items()
    ]
    title = f"{options.worlds} compiled worlds"
    print(format_table((title, "steps a second of processor", "of the clock", "MB"), table))
    write_results(options, {"reference_kernel_ms": kernel_ms, "worlds": rows})
    return 0


def gpu_rows(options: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Return the figures of a GPU."""
    rows: dict[str, dict[str, float]] = {}
    for name, fields in CASES.items():
        for people in PEOPLE[:2]:
            rows[f"{name}, {people}"] = gpu_speed(options.worlds, options.seconds, people=people, **fields)
    return rows


def processor_rows(options: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Return the figures of the processor."""
    rows: dict[str, dict[str, float]] = {}
    for name, fields in CASES.items():
        for people in PEOPLE:
            speeds = world_speeds(options.worlds, options.seconds, people=people, **fields)
            for threads, row in zip(THREADS, speeds, strict=True):
                rows[f"{name}, {people}, {threads} thread{'s' * (threads > 1)}"] = row
        single = single_speed(options.seconds, **fields)
        rows[f"{name}, truth, the single environment"] = {"per_core": single, "per_clock": single}
    for worlds in (16, 1024):
        rows[f"office, 5 bystanders, 360 beams, truth, {worlds} worlds"] = world_speeds(
            worlds, options.seconds, **CASES["office, 5 bystanders, 360 beams"]
        )[0]
    other = ir_sim_speed(options.seconds)
    return rows if other is None else {**rows, IR_SIM: other}


def _shown(row: dict[str, float], key: str) -> str:
    return f"{row[key]:.0f}" if key in row else ""
