"""What a benchmark of `tagalong bench` is, and which there are."""

import argparse
from importlib import import_module
from typing import Protocol, cast

from ...slam.errors import unknown_name

BENCHMARKS: dict[str, str] = {
    "speed": "environment steps, perception, SLAM and the immobile-area map, timed on this machine",
    "worlds": "compiled worlds: steps a second by people, beams, worlds and threads, beside the single environment",
    "graph-slam": "graph SLAM on recorded and simulated logs beside the original engines",
    "drawn-worlds": "SLAM in buildings, lasers and drives that are drawn at random",
    "slam-faults": "SLAM on drives with faults of odometry, clock and laser: errors, and whether it knows",
    "slam-among-people": "SLAM beside walking people: raw, by our filter, by the true one; others' trajectories, too",
    "slam-scale": "time and memory of SLAM as buildings and drives grow, on campus corridors that look alike",
    "kidnapping": "how soon a robot that woke up or was carried somewhere knows where it is",
    "people": "how well people are tracked and kept out of scans, in simulated drives",
    "people-recorded": "who is found and who is none in recorded scans, each with what was chosen without it",
    "people-by-sensor": "the same, known by laser, by camera and by both, in the lab",
    "recall-by-distance": "how far people are seen, with few and with many beams",
    "following": "how long a followed person is held in a recorded drive with clicked positions",
    "rgbd-people": "how well people are found in RGB-D frames",
    "rgbd-recorded": "floor, table tops and people in recorded, labelled RGB-D frames",
    "rgbd-planes": "how well planes and the camera's tilt are found in RGB-D frames",
    "simulators": "followers on the same episodes in compiled worlds and in MuJoCo's, with intervals of the difference",
    "soak": "hours of episodes and laps: whether memory and time stay flat",
}
"""Name -> what it measures; the module `tagalong.scripts.benchmarks.NAME` (`-` as `_`) is a `Benchmark`."""


class Benchmark(Protocol):
    """A module that measures one thing, prints a table and writes JSON with the hardware noted."""

    __doc__: str | None

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare its own options; there is already --out."""
        ...

    def run(self, options: argparse.Namespace) -> int:
        """Measure, print and write into `options.out`; return the exit status: 1 where a stated bound was missed."""
        ...


def load_benchmark(name: str) -> Benchmark:
    """Return the benchmark called `name`.

    Raises:
        InputError: If there is none.
    """
    if name not in BENCHMARKS:
        raise unknown_name("benchmark", name, tuple(BENCHMARKS))
    return cast(Benchmark, import_module(f".{name.replace('-', '_')}", __package__))
