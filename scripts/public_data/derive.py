"""Makes files of the catalogue that derive from originals, where a program here does so; checksums say whether it did.

Not all have one: what a binary rawlog, tied stamps or annotations went into is told in words by `docs/data.md`.
"""

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, MissingExtraError, UnwritableError, one_line, shown
from ...slam.files.output import replacing
from ...slam.geometry import between, compose
from ...slam.logs.text import numbered_lines, write_lines
from .bags import npz_of_bag

Pose = NDArray[np.float64]

_INTEL_CLOCK_S = 976052857.340
"""What the clock of the relations says when the log's says 0 [s]."""


def with_odometry(source: Path, target: Path) -> None:
    """Write a log whose FLASER lines keep the corrected pose and have the odometry that its ODOM lines tell.

    A program that corrected the log set the odometry to its own pose after each scan: the ODOM line right after a
    FLASER says that, and is no reading. All others are composed.
    """
    write_lines(target, _with_odometry(source))


def _with_odometry(source: Path) -> Iterator[str]:
    yield (
        f"# derived from {source.name.removesuffix('.gz')}: x y theta = corrected pose "
        "(scan-matching particle filter), odom_* = odometry re-integrated from the ODOM lines"
    )
    yield (
        "# FLASER num_readings [range_readings] x y theta odom_x odom_y odom_theta ipc_timestamp host logger_timestamp"
    )
    for kind, words, odometry in _readings(source, _moved):
        if kind == "FLASER":
            corrected = " ".join(f"{float(word):.6f}" for word in words[-9:-6])
            raw = " ".join(f"{value:.6f}" for value in odometry)
            time = f"{float(words[-1]):.6f}"
            yield f"{' '.join(words[:-9])} {corrected} {raw} {time} nohost {time}"


def _readings(source: Path, moved: Callable[[Pose, Pose, Pose], Pose]) -> Iterator[tuple[str, list[str], Pose]]:
    """Yield (kind, words, odometry so far) of each FLASER line and each ODOM line that is a reading."""
    odometry, before, is_reset = np.zeros(3), np.full(3, np.nan), False
    for number, line in numbered_lines(source, errors="replace"):
        words = line.split()
        if not words or words[0] not in ("ODOM", "FLASER"):
            continue
        if words[0] == "FLASER":
            is_reset = True
            yield "FLASER", words, odometry
            continue
        if len(words) < 4:
            raise InputError(f"{source.name}:{number}: an ODOM line begins with x, y and theta, got {shown(line)}")
        pose = np.array([float(word) for word in words[1:4]])
        if not is_reset:
            odometry = pose if np.isnan(before).any() else moved(odometry, before, pose)
            yield "ODOM", words, odometry
        before, is_reset = pose, False


def _moved(odometry: Pose, before: Pose, pose: Pose) -> Pose:
    """Return the odometry after the motion from `before` to `pose`.

    The last printed digit depends on where angles are wrapped: here, after each step; `_composed` does it otherwise.
    """
    turn = math.remainder(pose[2] - before[2], 2.0 * math.pi)
    x, y = pose[:2] - before[:2]
    c, s = math.cos(before[2]), math.sin(before[2])
    ahead, left = c * x + s * y, c * y - s * x
    c, s = math.cos(odometry[2]), math.sin(odometry[2])
    heading = math.remainder(odometry[2] + turn, 2.0 * math.pi)
    return np.array([odometry[0] + c * ahead - s * left, odometry[1] + s * ahead + c * left, heading])


def _composed(odometry: Pose, before: Pose, pose: Pose) -> Pose:
    return compose(odometry, between(before, pose))


def intel_readings(source: Path, target: Path) -> None:
    """Write a line for each odometry reading of the Intel log: its number, both clocks, the odometry."""

    def lines() -> Iterator[str]:
        """Yield the file's lines."""
        yield "# reading_index t_absolute t_log odom_x odom_y odom_theta"
        readings = (each for each in _readings(source, _composed) if each[0] == "ODOM")
        for number, (_, words, odometry) in enumerate(readings):
            log_s = float(words[-1])
            pose = " ".join(f"{value:.6f}" for value in odometry)
            yield f"{number} {_INTEL_CLOCK_S + log_s:.6f} {log_s:.6f} {pose}"

    write_lines(target, lines())


def intel_relations(source: Path, target: Path) -> None:
    """Write the Intel relations by the lines of the full log, which lies beside them and has their stamps.

    Raises:
        InputError: If that log is missing, or a stamp is not in it.
    """
    log = source.with_name("intel_full.clf.gz")
    lines = (line.split() for _, line in numbered_lines(log, errors="replace"))
    numbers = {words[-3]: k for k, words in enumerate(w for w in lines if w and w[0] == "FLASER")}

    def rows() -> Iterator[str]:
        """Yield the file's lines, which need the full log's numbers."""
        yield "# i j x y theta : pose of scan j seen from scan i (0-based line numbers of the log)"
        for number, line in numbered_lines(source):
            first, second, x, y, *_, yaw = line.split()
            if first not in numbers or second not in numbers:
                stamps = f"{shown(first)} and {shown(second)}"
                raise InputError(f"{source.name}:{number}: no scan of {log.name} has the stamps {stamps}")
            yield f"{numbers[first]} {numbers[second]} {x} {y} {yaw}"

    write_lines(target, rows())


def scans_of_bag(source: Path, target: Path) -> None:
    """Write the scans of a bag as arrays."""
    with replacing(target) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, **npz_of_bag(source))


RECIPES: dict[str, tuple[str, Callable[[Path, Path], None]]] = {
    **{
        f"slam_logs/{name}_with_odometry.log.gz": (f"slam_logs/{name}-corrected.log.gz", with_odometry)
        for name in ("aces", "belgioioso", "fhw")
    },
    "slam_logs/intel_readings_odometry.txt.gz": ("slam_logs/intel.gfs.log.gz", intel_readings),
    "slam_logs/intel_full_relations_by_scan.txt.gz": ("slam_logs/intel.relations.gz", intel_relations),
    **{f"legs/positive_{k}_scans.npz": (f"legs/positive_{k}.bag.xz", scans_of_bag) for k in (1, 2, 3, 5)},
}
"""Derived file -> its original, and what makes the one of the other."""


def derive(path: str, folder: Path, into: Path) -> str:
    """Make a derived file, unless it is there; return what happened: "there", "made", or why not.

    Args:
        path: Of the catalogue.
        folder: That holds the originals.
        into: Where to; its folders are made.

    Raises:
        UnwritableError: If it cannot be written there.
    """
    source, make = RECIPES[path]
    if (into / path).exists():
        return "there"
    if not (folder / source).is_file():
        return f"not made: {source} is missing"
    try:
        make(folder / source, into / path)
    except UnwritableError:  # nor can the others
        raise
    except (InputError, MissingExtraError) as error:
        return f"not made: {error}"
    except (ValueError, IndexError) as error:  # words that are no numbers, or too few of them
        return f"not made: {source} is damaged ({one_line(str(error), 80)})"
    return "made"
