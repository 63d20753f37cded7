"""Engines fed in process: scans and odometry of any numbers, and settings of any values."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Area, Border, Call, Input, require
from fuzzer.sanity import finite, sane_map, sane_poses
from fuzzer.scans import drive, hostile_drive, scan_of
from fuzzer.values import hostile_value
from numpy.random import Generator
from tagalong.slam import Localizer, OccupancyMap, RecordedDrive, make_matcher, make_slam
from tagalong.slam.scan_to_scan.laser_odometry import laser_odometry
from tagalong.slam.scan_to_scan.odometry_check import odometry_factors

FEW = {"gmapping": {"particles": 3, "threads": 1}, "cartographer": {}, "ekf": {}}
_MATCHERS = ("icp", "plicp", "mbicp", "hglasm-g-small", "global")


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
    """Do as a command does with a drive: check its odometry, and make one from the scans alone."""
    poses = np.array([[*frame["odometry"], 0.0, 0.0, 0.0][:3] for frame in value])
    recording = RecordedDrive(poses, [scan_of(frame) for frame in value], None, "drive")
    odometry_factors(recording)
    return laser_odometry(recording.scans).poses


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
    return (
        *engines,
        *settings,
        Border(name="engines.localizer", make=hostile_drive, call=_localized, sane=_sane_localization, ms=6.9),
        Border(
            name="engines.matchers", make=hostile_drive, call=_matched, ms=0.75,
            sane=lambda match: sane_poses(match.pose, "a match"),
        ),
        Border(
            name="engines.odometry_check", make=hostile_drive, call=_checked, ms=1.8,
            sane=lambda path: finite(path, "laser odometry"),
        ),
    )  # fmt: skip


AREA = Area(_borders(), _warm)
