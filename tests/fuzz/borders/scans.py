"""Scans in npz files, scans made by programs, and who is found in them."""

from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.arrays import edits, packed
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put
from fuzzer.mutations import with_extremes
from fuzzer.sanity import finite, sane_scan
from fuzzer.scans import drive, hostile_drive, scan_of
from numpy.random import Generator
from tagalong.perception import LeaderSelector, PeopleFilter
from tagalong.perception.people_filter import near_points
from tagalong.slam.logs.drive_folder import read_feet
from tagalong.slam.logs.scans_npz import NEEDED, read_scans_npz

NAME = "scans.npz"


def _npz(rng: Generator) -> Input:
    shape = [int(n) for n in rng.integers(1, 9, 2)]
    return {"shape": shape, "edits": edits(rng, [*NEEDED, "bag_time"]) if rng.random() < 0.95 else []}


def _read_npz(value: Input, folder: Path) -> Any:
    count, beams = value["shape"]
    arrays = {
        "ranges": np.full((count, beams), 3.0), "angle_min": np.array(-1.0), "angle_increment": np.array(0.1),
        "range_min": np.array(0.1), "range_max": np.array(10.0), "bag_time": 0.1 * np.arange(count),
    }  # fmt: skip
    return read_scans_npz(put(folder, NAME, packed(arrays, value["edits"])))


def _sane_scans(scans: Any) -> None:
    require(len(scans) > 0, "no scans")
    for scan in scans:
        sane_scan(scan)


def _feet(rng: Generator) -> Input:
    return edits(rng, ["feet"])


def _read_feet(value: Input, folder: Path) -> Any:
    return read_feet(put(folder, NAME, packed({"feet": np.ones((3, 2, 2))}, value)))


def _sane_feet(feet: Any) -> None:
    require(feet.ndim == 3 and feet.shape[2] == 2, f"feet of shape {feet.shape}")
    finite(feet[~np.isnan(feet)], "feet", 1e7)


def _tracked(value: Input, folder: Path) -> Any:
    """Do as `tagalong perceive` does with scans."""
    people_filter, selector = PeopleFilter(), LeaderSelector()
    updates = []
    for frame in value:
        update = people_filter.update(scan_of(frame), frame["odometry"])
        selector.update(update.people, frame["odometry"])
        assert update.without_people is not None
        updates.append(update)
    return updates


def _sane_people(updates: Any) -> None:
    for update in updates:
        finite(update.people.positions, "people's places")
        finite(update.people.velocities, "people's velocities")
        finite(update.detections.positions, "legs")
        finite(update.detections.confidence, "legs' confidence", 1.0)


def _filter(rng: Generator) -> Input:
    return [drive(rng, 2)[0], with_extremes(rng, rng.normal(0.0, 2.0, (3, 2)), 0.2).tolist()]


def _filtered(value: Input, folder: Path) -> Any:
    scan = scan_of(value[0])
    return scan.without(near_points(scan, value[1], 0.35))


def _warm() -> None:
    rng = np.random.default_rng(0)
    for _ in range(3):
        _tracked(drive(rng, 6, 60), Path())


AREA = Area(
    (
        Border(name="scans.npz", make=_npz, call=_read_npz, sane=_sane_scans, file=NAME, ms=1.4),
        Border(name="scans.feet", make=_feet, call=_read_feet, sane=_sane_feet, file=NAME, ms=1.0),
        Border(
            name="scans.scan", make=lambda rng: hostile_drive(rng, 2), ms=0.31, sane=_sane_scans,
            call=lambda value, folder: [scan_of(frame) for frame in value],
        ),
        Border(name="scans.tracker", make=hostile_drive, call=_tracked, sane=_sane_people, ms=1.8),
        Border(name="scans.people_filter", make=_filter, call=_filtered, ms=0.38),
    ),
    _warm,
)  # fmt: skip
