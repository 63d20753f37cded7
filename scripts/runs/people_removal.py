"""People taken out of a recorded drive before it is mapped, and a file that says who they were."""

import argparse
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from ...perception.hindsight import filtered_scans
from ...perception.legs.forest import LegForest
from ...perception.people_filter import FilteredScan, PeopleFilterConfig
from ...slam.errors import InputError
from ...slam.files.output import write_json
from ...slam.logs.drive import RecordedDrive


def add_people_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options that take people out of the scans."""
    parser.add_argument(
        "--filter-people", action="store_true", help="take tracked people out of the scans before they are mapped"
    )
    parser.add_argument(
        "--forest",
        metavar="NAME",
        help='leg forest of --filter-people: "real", "simulation" or a file (default: real)',
    )


def people_filter_config(filter_people: bool, forest: str | None) -> PeopleFilterConfig | None:
    """Return the people filter that the options ask for; None: they ask for none.

    Raises:
        InputError: If there is no such forest, or a forest without a filter.
    """
    if not filter_people:
        if forest is not None:
            raise InputError("--forest is the leg forest of --filter-people: give that, too")
        return None
    config = PeopleFilterConfig(forest=forest or "real")
    LegForest.load(config.forest)  # complains before the log is read
    return config


def remove_people(
    drive: RecordedDrive, config: PeopleFilterConfig, folder: Path, progress: bool
) -> tuple[RecordedDrive, dict[str, Any]]:
    """Take people out of the scans of `drive`; write who was tracked, and where, to people.json in `folder`.

    Args:
        drive: The drive.
        config: Of the people filter.
        folder: Where the results go.
        progress: Whether a bar on stderr shows how far it is.

    Returns:
        The drive without people, and what was removed, for metrics.json.
    """
    scans, tracks, returns, removed = [], dict[int, dict[str, list[Any]]](), 0, 0
    pause = 0.1 if sys.stderr.isatty() else 10.0  # between two drawings of the bar; a file needs few
    bar = tqdm(
        filtered_scans(drive, config),
        f"people in {drive.name}",
        len(drive),
        file=sys.stderr,
        unit="scan",
        mininterval=pause,
        disable=not progress,
    )
    for number, filtered in enumerate(bar):
        scans.append(filtered.without_people)
        returns += int(np.count_nonzero(filtered.scan.is_return))
        removed += int(np.count_nonzero(filtered.scan.is_return & filtered.removed))
        _add_people(tracks, number, filtered)
    people = [{"id": key, **track} for key, track in sorted(tracks.items())]
    write_json(folder / "people.json", {"frame": "odometry", "people": people})
    result = {"people": len(people), "returns": returns, "removed_returns": removed, "config": asdict(config)}
    return replace(drive, scans=scans), result


def _add_people(tracks: dict[int, dict[str, list[Any]]], number: int, filtered: FilteredScan) -> None:
    """Add to `tracks` where each person is in scan `number`."""
    for key, position in zip(filtered.people.ids.tolist(), filtered.people.positions.tolist(), strict=True):
        track = tracks.setdefault(key, {"scans": [], "positions_m": []})
        track["scans"].append(number)
        track["positions_m"].append([round(coordinate, 4) for coordinate in position])
