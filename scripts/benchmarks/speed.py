"""How fast this machine is with tagalong: environment steps, their stages, the SLAM engines, the immobile-area map.

Times depend on the machine and on what else it does. The time of a fixed numpy kernel is printed beside them, so that
figures of two machines can be compared as ratios.

example:
  tagalong bench speed --steps 300
"""

import argparse
from collections.abc import Callable
from dataclasses import asdict, replace
from time import perf_counter
from typing import Any, TypeVar

import gymnasium as gym
import numpy as np
from gymnasium.utils.performance import benchmark_step, benchmark_vector_step
from numpy.typing import NDArray

from ...agents import make_follower
from ...envs.follow_env import FollowEnv
from ...envs.recording.slow_tour import slow_tour
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.world import World, WorldConfig
from ...perception.legs.detector import LegDetector
from ...perception.legs.forest import LegForest
from ...perception.people_filter import PeopleFilter, PeopleFilterConfig
from ...slam.engine import make_slam
from ...slam.scan import LaserScan
from ..console.arguments import at_least
from ..console.tables import format_table
from ..lab.hardware import describe_machine, reference_kernel_s
from . import immobile_speed
from .latency import WARM_UP, Latency, latency
from .results import write_results

T = TypeVar("T")

ENVIRONMENTS = {
    "360 beams, tracker, 4 people": {"beams": 360, "slam": None},
    "1081 beams, tracker, 4 people": {"beams": 1081, "slam": None},
    "1081 beams, tracker, 4 people, gmapping": {"beams": 1081, "slam": "gmapping"},
}
BENCHMARK_S = 10
"""Duration of each of Gymnasium's benchmarks [s]."""
SCANS = {"180 beams": (180, np.pi), "361 beams": (361, np.pi), "1081 beams": (1081, 1.5 * np.pi)}


def environment_speed(steps: int, **fields: Any) -> dict[str, float]:
    """Return how many steps a second an environment makes with the PID follower, resets left out.

    The same steps are made twice, and timed the second time: kernels are compiled where they are called first, some of
    them after hundreds of steps.

    Args:
        steps: Timed steps.
        fields: Keywords of `FollowEnv`.
    """
    env = gym.make("tagalong/Corridor-v0", **fields)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    _step_times(env, steps + WARM_UP)
    times = _step_times(env, steps + WARM_UP)
    env.close()
    stage = latency(times[WARM_UP:])
    rate = 1e3 / stage.mean_ms
    return {
        "steps_per_s": rate,
        "real_time_factor": rate / inner.config.task.control_hz,
        "mean_ms": stage.mean_ms,
        "p95_ms": stage.p95_ms,
    }


def _step_times(env: gym.Env[Any, Any], steps: int) -> list[float]:
    """Return the time of each of `steps` steps [s]; the same steps in every call."""
    follower = make_follower("pid", env.get_wrapper_attr("interface"))
    seed, times = 0, []
    observation, _ = env.reset(seed=seed)
    while len(times) < steps:
        action = follower.act(observation)
        start = perf_counter()
        observation, _, terminated, truncated, _ = env.step(action)
        times.append(perf_counter() - start)
        if terminated or truncated:
            seed += 1
            observation, _ = env.reset(seed=seed)
            follower.reset()
    return times


def gymnasium_speed(seconds: int, *, vector_envs: int, workers: int) -> dict[str, float]:
    """Return steps a second of a single and of a vector environment by Gymnasium's own benchmark functions.

    The office with 5 people, 360 beams and the tracker, random actions, resets included; contacts and lost leaders do
    not end episodes there, since random actions would end them at once.

    Args:
        seconds: Duration of each of the two measurements [s].
        vector_envs: Environments of the vector environment.
        workers: Its processes.
    """
    fields = {"beams": 360, "slam": None, "people_count": 5, "ends_on_contact": False, "lost_limit_s": 1e6}
    single = gym.make("tagalong/Office-v0", disable_env_checker=True, **fields)
    vector = gym.make_vec(
        "tagalong/Office-v0",
        num_envs=vector_envs,
        vectorization_mode="vector_entry_point",
        workers=workers,
        **fields,
    )
    benchmark_step(single, 1, seed=0)
    benchmark_vector_step(vector, 1, seed=0)
    rates = {
        "single environment": benchmark_step(single, seconds, seed=1),
        f"vector environment, {workers} processes": benchmark_vector_step(vector, seconds, seed=1),
    }
    vector.close()
    return rates


def stage_latencies(steps: int, beams: int, people: int) -> dict[str, Latency]:
    """Return the time of each stage of a step: simulation with laser, legs, tracker (with the legs), filter.

    Args:
        steps: Timed steps.
        beams: Beams of the laser.
        people: People in the building.
    """
    config = WorldConfig(people=people, lidar=LidarConfig(beams=beams, rate_hz=10.0))
    world = World(config, np.random.default_rng(0))
    people_filter = PeopleFilter(PeopleFilterConfig(forest="simulation"))
    detector = LegDetector(LegForest.load("simulation"))
    times: dict[str, list[float]] = {name: [] for name in ("world", "legs", "legs + tracker", "filter")}
    for _ in range(steps + WARM_UP):
        _timed(times["world"], lambda: world.step([0.3, 0.0]))
        scan, odometry = world.scan(), world.odometry
        _timed(times["legs"], lambda scan=scan: detector.detect(scan))
        found = _timed(times["legs + tracker"], lambda s=scan, o=odometry: people_filter.update(s, o))
        _timed(times["filter"], lambda f=found: f.without_people)
    return {name: latency(values[WARM_UP:]) for name, values in times.items()}


def processed_scan_latency(method: str, beams: int, fov: float, scans: int, **options: Any) -> Latency:
    """Return the time of an update in which the engine matched and wrote the scan.

    Args:
        method: Name of the engine.
        beams: Beams kept of the simulated laser's 1081.
        fov: Field of view kept [rad].
        scans: Updates that are timed.
        options: The engine's configuration.
    """
    drive = slow_tour(WorldConfig(), 0).recording
    engine, times = make_slam(method, **options), []
    for odometry, scan in zip(drive.odometry, drive.scans, strict=True):
        part = thinned(scan, beams, fov)
        start = perf_counter()
        update = engine.update(odometry, part)
        if update.integrated:
            times.append(perf_counter() - start)
        if len(times) == scans + 5:
            break
    return latency(times[5:])


def _timed(times: list[float], call: Callable[[], T]) -> T:
    start = perf_counter()
    result = call()
    times.append(perf_counter() - start)
    return result


def thinned(scan: LaserScan, beams: int, fov: float) -> LaserScan:
    """Return `beams` of the scan's beams, evenly spread over `fov` [rad]."""
    wanted = np.linspace(-fov / 2.0, fov / 2.0, beams)
    nearest: NDArray[np.intp] = np.abs(scan.bearings[None] - wanted[:, None]).argmin(axis=1)
    return replace(scan, ranges=scan.ranges[nearest], bearings=scan.bearings[nearest])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "--steps", type=at_least(1, 10_000_000), default=1000, help="timed steps of each part (default: %(default)s)"
    )


def run(options: argparse.Namespace) -> int:
    """Measure, print tables, write results.json."""
    machine, kernel_ms = describe_machine(), 1e3 * reference_kernel_s()
    print(f"{machine['processor']}, {machine['cores']} cores, Python {machine['python']}")
    print(f"reference numpy kernel: {kernel_ms:.1f} ms\n")
    print("kernels are compiled before anything is timed; where none are yet, that takes minutes\n")
    environments = {
        name: environment_speed(options.steps, people_count=4, **fields) for name, fields in ENVIRONMENTS.items()
    }
    rows = [
        (name, *(f"{row[key]:.2f}" for key in ("steps_per_s", "real_time_factor", "mean_ms", "p95_ms")))
        for name, row in environments.items()
    ]
    print(format_table(("one environment step, laser at 10 Hz", "steps/s", "x real time", "mean ms", "p95 ms"), rows))
    throughput = gymnasium_speed(BENCHMARK_S, vector_envs=16, workers=2)
    title = "Gymnasium's benchmarks: office, 5 people, 360 beams, tracker"
    print("\n" + format_table((title, "steps/s"), [(name, f"{rate:.0f}") for name, rate in throughput.items()]))
    stages = {
        f"{name}, {beams} beams": stage
        for beams in (360, 1081)
        for name, stage in stage_latencies(options.steps, beams, 4).items()
    }
    print("\n" + _latencies("stage of a step, 4 people", stages))
    scans = {
        f"{name}, {threads} thread{'s' * (threads > 1)}": processed_scan_latency(
            "gmapping", *size, scans=40, threads=threads, linear_update=0.2
        )
        for name, size in SCANS.items()
        for threads in (1, 2)
    }
    print("\n" + _latencies("GMapping, 30 particles, processed scan", scans))
    lab = immobile_speed.immobile_latencies(options.steps)
    print("\n" + _latencies("immobile-area map, camera at 10 Hz", lab))
    print(f"everything: {immobile_speed.real_time_factor(lab):.1f} x real time on one core")
    content = {
        "reference_kernel_ms": kernel_ms,
        "environment": environments,
        "gymnasium_benchmarks": throughput,
        "stages": {name: asdict(stage) for name, stage in stages.items()},
        "immobile_map": {name: asdict(stage) for name, stage in lab.items()},
        "gmapping_processed_scan": {name: asdict(stage) for name, stage in scans.items()},
    }
    write_results(options, content)
    print(f"\nwritten to {options.out / 'results.json'}")
    return 0


def _latencies(title: str, stages: dict) -> str:
    rows = [(name, f"{s.mean_ms:.3f}", f"{s.p95_ms:.3f}", str(s.calls)) for name, s in stages.items()]
    return format_table((title, "mean ms", "p95 ms", "calls"), rows)
