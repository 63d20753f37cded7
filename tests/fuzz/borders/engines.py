"""Engines fed in process: scans and odometry of any numbers, and settings of any values."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Area, Border, Call, Input, require
from fuzzer.sanity import finite, sane_map, sane_poses
from fuzzer.scans import drive, hostile_drive, scan_of, with_extreme_numbers
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.slam import Localizer, OccupancyMap, RecordedDrive, make_matcher, make_slam
from tagalong.slam.drives.calibration import calibrated
from tagalong.slam.scan_to_scan.laser_odometry import laser_odometry

FEW = {"gmapping": {"particles": 3, "threads": 1}, "cartographer": {}, "ekf": {}}
_MATCHERS = ("icp", "plicp", "mbicp", "hglasm-g-small", "global")


def stalled_drive(rng: Generator) -> Input:
    """Return 10 to 60 frames in a room whose odometry stands still for stretches, jumps, catches up or comes back.

    In every third, up to three numbers are extreme, too.
    """
    count, beams = int(rng.integers(10, 61)), int(rng.integers(20, 60))
    bearings = np.linspace(-2.5, 2.5, beams)
    velocity = np.array([rng.uniform(0.0, 0.1), 0.0, rng.uniform(-0.05, 0.05)])
    way = np.cumsum(np.tile(velocity, (count, 1)), axis=0)
    said_m = way + np.cumsum(rng.normal(0.0, 0.002, (count, 3)), axis=0)
    for _ in range(int(rng.integers(1, 4))):
        first, length = int(rng.integers(count)), int(rng.choice([1, 2, 5, 19, 20, 21, 22, 40]))
        said_m[first : first + length] = said_m[first]
        if rng.random() < 0.5:  # it counts on from where it stood; else it catches up at once
            said_m[first + length :] -= velocity * length
        if rng.random() < 0.3:
            said_m[first + length :] += rng.normal(0.0, (3.0, 3.0, 1.0))
    frames = [
        {
            "odometry": pose.tolist(), "ranges": np.round(_room_ranges(*place, bearings), 3).tolist(),
            "fan": [-2.5, 5.0 / (beams - 1)], "limits": [0.05, 10.0], "time": 0.1 * k, "mount": [0.0, 0.0, 0.0],
        }
        for k, (place, pose) in enumerate(zip(way, said_m, strict=True))
    ]  # fmt: skip
    return with_extreme_numbers(rng, frames, int(rng.integers(1, 4))) if rng.random() < 0.33 else frames


def _room_ranges(x: float, y: float, theta: float, bearings: Any) -> Any:
    """Return the ranges [m] to the walls of a room of 14 by 6 m at whose middle the drive begins."""
    cosine, sine = np.cos(bearings + theta), np.sin(bearings + theta)
    with np.errstate(divide="ignore"):
        along = np.where(cosine > 0, 7.0 - x, 7.0 + x) / np.abs(cosine)
        across = np.where(sine > 0, 3.0 - y, 3.0 + y) / np.abs(sine)
    return np.clip(np.minimum(along, across), 0.0, 20.0)


def driven(name: str) -> Call:
    """Return what drives an engine of this name through the frames of an input."""

    def call(value: Input, folder: Path) -> Any:
        return _driven(make_slam(name, **FEW[name]), value)

    return call


def _driven(engine: Any, frames: Input) -> Any:
    updates = [engine.update(frame["odometry"], scan_of(frame)) for frame in frames]
    engine.finish()
    return updates, engine.trajectory(), engine.map()


def sane_engine(result: Any) -> None:
    """Require finite estimates, one a scan, and a map."""
    updates, path, grid = result
    for update in updates:
        sane_poses(update.pose, "an estimate")
    require(len(path) == len(updates), f"{len(path)} poses for {len(updates)} scans")
    sane_poses(path, "the trajectory")
    sane_map(grid)


def setting_names(config: Any, before: str = "") -> list[tuple[str, Any]]:
    """Return all fields of a configuration and of its parts by their path, with their defaults."""
    names: list[tuple[str, Any]] = []
    for field in fields(config):
        value = getattr(config, field.name)
        if is_dataclass(value):
            names += setting_names(value, f"{before}{field.name}.")
        names.append((before + field.name, value))
    return names


def settings_of(name: str) -> Callable[[Generator], Input]:
    """Return a source of settings of an engine, one to three fields each, and of a short drive."""
    known = setting_names(make_slam(name).config)

    def make(rng: Generator) -> Input:
        chosen = [known[int(k)] for k in rng.integers(0, len(known), int(rng.integers(1, 4)))]
        settings = [[path, hostile_value(rng, usual)] for path, usual in chosen]
        return {"settings": settings, "frames": drive(rng, 3, 12)}

    return make


def _settled(name: str) -> Call:
    def call(value: Input, folder: Path) -> Any:
        settings = {path: tuple(x) if isinstance(x, list) else x for path, x in value["settings"]}
        return _driven(make_slam(name, **{**FEW[name], **settings}), value["frames"])

    return call


def _room() -> OccupancyMap:
    cells = np.zeros((80, 100), dtype=np.float32)
    cells[[0, -1]], cells[:, [0, -1]], cells[30:34, 20:50] = 1.0, 1.0, 1.0
    return OccupancyMap(cells, 0.1, (-4.0, -4.0))


def _localized(value: Input, folder: Path) -> Any:
    start = value[0]["mount"] if len(value) % 2 else None
    localizer = Localizer(_room(), start=start)
    for frame in value:
        localizer.update(frame["odometry"], scan_of(frame))
    return localizer.trajectory()


def _sane_localization(path: Any) -> None:
    sane_poses(path[~np.isnan(path).all(axis=1)], "the trajectory")


def _matched(value: Input, folder: Path) -> Any:
    scans = [scan_of(frame) for frame in value]
    name = _MATCHERS[len(scans[0]) % len(_MATCHERS)]
    return make_matcher(name).match(scans[0], scans[1], value[0]["odometry"])


def _checked(value: Input, folder: Path) -> Any:
    """Do as a command does with a drive: calibrate it, and make odometry from the scans alone."""
    poses = np.array([[*frame["odometry"], 0.0, 0.0, 0.0][:3] for frame in value])
    recording = RecordedDrive(poses, [scan_of(frame) for frame in value], None, "drive")
    return laser_odometry(calibrated(recording).scans).poses


def _warm() -> None:
    rng = np.random.default_rng(0)
    for _ in range(3):
        frames = drive(rng, 5)
        for name in FEW:
            sane_engine(_driven(make_slam(name, **FEW[name]), frames))
        _localized(frames, Path())
        _checked(frames, Path())
        for name in _MATCHERS:
            make_matcher(name).match(scan_of(frames[0]), scan_of(frames[1]), (0.0, 0.0, 0.0))


def _borders() -> tuple[Border, ...]:
    engines = [
        Border(name=f"engines.{name}", make=hostile_drive, call=driven(name), sane=sane_engine, ms=ms)
        for name, ms in (("gmapping", 3.0), ("cartographer", 6.7), ("ekf", 4.2))
    ]
    settings = [
        Border(name=f"engines.{name}_settings", make=settings_of(name), call=_settled(name), sane=sane_engine, ms=ms)
        for name, ms in (("gmapping", 3.0), ("cartographer", 8.0), ("ekf", 3.0))
    ]
    stalled = [
        Border(name=f"engines.{name}_stalled", make=stalled_drive, call=driven(name), sane=sane_engine, ms=ms)
        for name, ms in (("gmapping", 30.0), ("cartographer", 60.0), ("ekf", 30.0))
    ]
    return (
        *engines,
        *settings,
        *stalled,
        Border(name="engines.localizer", make=hostile_drive, call=_localized, sane=_sane_localization, ms=6.9),
        Border(
            name="engines.matchers", make=hostile_drive, call=_matched, ms=0.75,
            sane=lambda match: sane_poses(match.pose, "a match"),
        ),
        Border(
            name="engines.calibration", make=hostile_drive, call=_checked, ms=1.8,
            sane=lambda path: finite(path, "laser odometry"),
        ),
    )  # fmt: skip


AREA = Area(_borders(), _warm)
