"""Cameras' frames and grids that programs fill: depth, poses and points of any numbers."""

from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Area, Border, Input, require
from fuzzer.mutations import extreme_float, with_extremes
from fuzzer.sanity import finite, sane_map
from fuzzer.scans import drive, hostile_drive, scan_of
from numpy.random import Generator
from tagalong.perception import ImmobileMapper, PeopleFinder, PlaneFinder
from tagalong.perception.rgbd import Pinhole, RgbdFrame
from tagalong.slam.grid import OccupancyGrid

_SIZE = (24, 32)


def _frame(rng: Generator) -> Input:
    """Return depths of a floor and a wall with extreme values, and a camera at odd places."""
    rows, wall = np.arange(_SIZE[0])[:, None], float(rng.uniform(1.0, 6.0))
    depth = np.minimum(1.0 / np.maximum(0.05 * (rows - 11.5), 1e-3), wall) * np.ones(_SIZE)
    value: Input = {
        "depth": np.round(with_extremes(rng, depth, 0.02 * rng.random()), 3).tolist(), "height": 1.0,
        "mount": [0.1, 0.0, 0.0], "time": 0.0, "fov": [1.2, 1.0], "size": list(_SIZE),
    }  # fmt: skip
    if rng.random() < 0.4:
        key = ("height", "time")[int(rng.integers(2))]
        value[key] = extreme_float(rng)
    if rng.random() < 0.3:
        value["mount"][int(rng.integers(3))] = extreme_float(rng)
    if rng.random() < 0.1:
        value[("fov", "size")[int(rng.integers(2))]] = [int(rng.integers(0, 40)), float(np.abs(extreme_float(rng)))]
    return value


def _looked(value: Input, folder: Path) -> Any:
    rows, cols = (int(min(size, 10**9)) if np.isfinite(size) else 0 for size in value["size"])
    camera = Pinhole(width=cols, height=rows, horizontal_fov=value["fov"][0], vertical_fov=value["fov"][1])
    depth = np.array(value["depth"], dtype=np.float64).astype(np.float32)
    colour = np.full((*depth.shape, 3), 128, np.uint8)
    frame = RgbdFrame(depth, colour, camera, value["time"], tuple(value["mount"]), value["height"])
    planes = PlaneFinder().find(frame)
    return PeopleFinder.load().find(frame, planes)


def _sane_people(people: Any) -> None:
    finite(people.positions, "people's places", 1e7)
    finite(people.likelihood, "likelihood", 1.0)


def _gridded(value: Input, folder: Path) -> Any:
    grid, mapper = OccupancyGrid(), ImmobileMapper()
    for frame in value:
        scan = scan_of(frame)
        grid.write(frame["odometry"], scan)
        mapper.add_scan(frame["odometry"], scan)
    return [grid.to_map(), mapper.grid.to_map()]


def _sane_maps(maps: Any) -> None:
    require(len(maps) == 2, "two maps")
    for grid in maps:
        sane_map(grid)


def _warm() -> None:
    rng = np.random.default_rng(0)
    _gridded(drive(rng), Path())
    _looked(_frame(rng), Path())


AREA = Area(
    (
        Border(name="perception.camera", make=_frame, call=_looked, sane=_sane_people, ms=2.3),
        Border(name="perception.grids", make=hostile_drive, call=_gridded, sane=_sane_maps, ms=11.0),
    ),
    _warm,
)
