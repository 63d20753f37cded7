"""`tagalong bench`: how fast this machine is with tagalong."""

import argparse
from dataclasses import asdict
from pathlib import Path

import numpy as np

from ...slam.files.output import write_json
from ..lab.arguments import require_count
from ..lab.hardware import describe_machine, reference_kernel_s
from ..tables import format_table

EPILOG = """\
Times depend on the machine and on what else it does. The time of a fixed numpy kernel is printed beside them, so that
figures of two machines can be compared as ratios. Writes bench.json into DIR.

example:
  tagalong bench --steps 300 --out out/bench
"""

ENVIRONMENTS = {
    "360 beams, tracker, 4 people": {"beams": 360, "slam": None},
    "1081 beams, tracker, 4 people": {"beams": 1081, "slam": None},
    "1081 beams, tracker, 4 people, gmapping": {"beams": 1081, "slam": "gmapping"},
}
BENCHMARK_S = 10
"""Duration of each of Gymnasium's benchmarks [s]."""
SCANS = {"180 beams": (180, np.pi), "361 beams": (361, np.pi), "1081 beams": (1081, 1.5 * np.pi)}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.epilog = EPILOG
    parser.add_argument("--steps", type=int, default=1000, help="timed steps of each part (default: %(default)s)")
    parser.add_argument("--out", type=Path, default=Path("out/bench"), metavar="DIR", help="(default: %(default)s)")


def run(options: argparse.Namespace) -> int:
    """Measure, print tables, write bench.json."""
    from ..benchmarks import immobile_speed, speed

    require_count("--steps", options.steps, 10_000_000, "a day of each part")
    machine = {**describe_machine(), "reference_kernel_ms": 1e3 * reference_kernel_s()}
    print(f"{machine['processor']}, {machine['cores']} cores, Python {machine['python']}")
    print(f"reference numpy kernel: {machine['reference_kernel_ms']:.1f} ms\n")
    print("kernels are compiled before anything is timed; where none are yet, that takes minutes\n")
    environments = {
        name: speed.environment_speed(options.steps, people_count=4, **fields) for name, fields in ENVIRONMENTS.items()
    }
    rows = [
        (name, *(f"{row[key]:.2f}" for key in ("steps_per_s", "real_time_factor", "mean_ms", "p95_ms")))
        for name, row in environments.items()
    ]
    print(format_table(("one environment step, laser at 10 Hz", "steps/s", "x real time", "mean ms", "p95 ms"), rows))
    throughput = speed.gymnasium_speed(BENCHMARK_S, vector_envs=16, workers=2)
    title = "Gymnasium's benchmarks: office, 5 people, 360 beams, tracker"
    print("\n" + format_table((title, "steps/s"), [(name, f"{rate:.0f}") for name, rate in throughput.items()]))
    stages = {
        f"{name}, {beams} beams": stage
        for beams in (360, 1081)
        for name, stage in speed.stage_latencies(options.steps, beams, 4).items()
    }
    print("\n" + _latencies("stage of a step, 4 people", stages))
    scans = {
        f"{name}, {threads} thread{'s' * (threads > 1)}": speed.processed_scan_latency(
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
        "machine": machine,
        "environment": environments,
        "gymnasium_benchmarks": throughput,
        "stages": {name: asdict(stage) for name, stage in stages.items()},
        "immobile_map": {name: asdict(stage) for name, stage in lab.items()},
        "gmapping_processed_scan": {name: asdict(stage) for name, stage in scans.items()},
    }
    write_json(options.out / "bench.json", content)
    print(f"\nwritten to {options.out / 'bench.json'}")
    return 0


def _latencies(title: str, stages: dict) -> str:
    rows = [(name, f"{s.mean_ms:.3f}", f"{s.p95_ms:.3f}", str(s.calls)) for name, s in stages.items()]
    return format_table((title, "mean ms", "p95 ms", "calls"), rows)
