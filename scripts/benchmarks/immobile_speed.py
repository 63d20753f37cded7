"""How fast the immobile-area map is made, stage by stage, sensors simulated too."""

from time import process_time

import numpy as np

from ...envs.recording.operator import Operator
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.sensors.lidar import LidarConfig
from ...envs.world.world import World, WorldConfig
from ...perception.immobile.mapper import ImmobileMapper
from ...perception.immobile.view import make_view
from ...perception.rgbd.people_finder import PeopleFinder
from ...perception.rgbd.planes import PlaneFinder
from ...slam.geometry import between
from ...slam.grid import GridConfig, OccupancyGrid
from .latency import WARM_UP, Latency, latency

STAGES = (
    "world, laser and camera",
    "planes",
    "people",
    "projection",
    "view into the grid",
    "scan into the grid",
    "conventional grid",
)
"""What is timed, in its order."""


def immobile_latencies(steps: int, camera_hz: float = 10.0) -> dict[str, Latency]:
    """Return the processor time of each stage of the lab drive, and of all together, a control period of 0.1 s.

    Args:
        steps: Timed control periods.
        camera_hz: Frames a second [Hz], 128 x 106 pixels.
    """
    laser = LidarConfig(range_max=10.0, height=0.32)
    config = WorldConfig(
        scene="lab", route="operator", people=0, leader=False, lidar=laser, camera=RgbdConfig(rate_hz=camera_hz)
    )
    world = World(config, np.random.default_rng(0))
    operator, mapper = Operator(world.scene), ImmobileMapper()
    conventional = OccupancyGrid(GridConfig(max_range=laser.range_max))
    planes, people = PlaneFinder(), PeopleFinder.load()
    times: dict[str, list[float]] = {name: [] for name in (*STAGES, "everything")}
    seen_s = -np.inf
    for _ in range(steps + WARM_UP):
        clock = _Clock()
        world.step(operator.command(world.truth))
        clock.lap(times[STAGES[0]])
        pose, scan, frame = between(world.start, world.truth.robot_pose), world.scan(), world.frames[-1]
        mapper.add_scan(pose, scan)
        clock.lap(times[STAGES[5]])
        conventional.write(pose, scan)
        clock.lap(times[STAGES[6]])
        if frame.time_s > seen_s and frame.time_s > 0.0:
            seen_s = frame.time_s
            found = planes.find(frame)
            clock.lap(times[STAGES[1]])
            somebody = people.find(frame, found)
            clock.lap(times[STAGES[2]])
            view = make_view(frame, found, somebody)
            clock.lap(times[STAGES[3]])
            mapper.add_view(view)
            clock.lap(times[STAGES[4]])
        times["everything"].append(clock.total())
    return {name: latency(values[WARM_UP:]) for name, values in times.items()}


def real_time_factor(stages: dict[str, Latency], period_s: float = 0.1) -> float:
    """Return how many times faster than real time the whole is, on one core, by the mean."""
    return 1e3 * period_s / stages["everything"].mean_ms


class _Clock:
    """Processor time since the last lap, so that other programs do not count."""

    def __init__(self) -> None:
        self._start = self._last = process_time()

    def lap(self, times: list[float]) -> None:
        now = process_time()
        times.append(now - self._last)
        self._last = now

    def total(self) -> float:
        return process_time() - self._start
