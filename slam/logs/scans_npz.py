"""Reads laser scans from `.npz` files: `ranges` (scans, beams), `angle_min`, `angle_increment`, limits and times."""

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..files.input import named, names_file
from ..files.output import read_arrays
from ..files.sizes import DriveLength
from ..scan import LaserScan
from .beams import cut_behind, measured

NEEDED = ("ranges", "angle_min", "angle_increment", "range_min", "range_max")


@names_file
def read_scans_npz(path: str | os.PathLike[str]) -> list[LaserScan]:
    """Return the scans in the file, in its order.

    Beam i points at `angle_min + i * angle_increment`; a range of 0 is no measurement, and a sweep of the full circle
    is cut behind the laser. Times [s] are counted from the first scan and come from `bag_time`, else `stamp`, each
    (scans,); a file without either gives zeros.

    Raises:
        InputError: If the file cannot be read, an array is missing (named) or has another shape, or an angle or a limit
            makes no sense.
    """
    path = Path(path)
    arrays = _load(path)
    ranges = arrays["ranges"]
    if ranges.ndim != 2 or ranges.size == 0:
        raise InputError(f"{path}: `ranges` must have shape (scans, beams), got {ranges.shape}")
    DriveLength(path).add(ranges.shape[1], len(ranges))
    times = arrays.get("bag_time", arrays.get("stamp", np.zeros(len(ranges))))
    if times.shape != (len(ranges),):
        raise InputError(f"{path}: times must have shape ({len(ranges)},), one a scan, got {times.shape}")
    first, step, *limits = (_number(path, name, arrays[name]) for name in NEEDED[1:])
    if not step > 0.0:
        raise InputError(f"{path}: `angle_increment` must be positive [rad], got {step}")
    bearings = first + step * np.arange(ranges.shape[1])
    with np.errstate(invalid="ignore"):  # bytes that are no number stay none
        return [
            LaserScan(*cut_behind(measured(row.astype(np.float64), limits[0]), bearings), *limits, time_s=float(time))
            for row, time in zip(ranges, times - times[0], strict=True)
        ]


def _number(path: Path, name: str, value: NDArray[Any]) -> float:
    if value.size != 1 or not np.isfinite(value).all():
        raise InputError(f"{path}: `{name}` must be one finite number, got {shown(value)}")
    return float(value.item())


def _load(path: Path) -> dict[str, NDArray[Any]]:
    try:
        content = read_arrays(path)
    except InputError as error:
        raise InputError(f"{named(path)} is no .npz file of scans: {error}") from None
    missing = [name for name in NEEDED if name not in content]
    if missing:
        raise InputError(f"{path}: needs the arrays {', '.join(NEEDED)}; missing: {', '.join(missing)}")
    found = {name: content[name] for name in (*NEEDED, "bag_time", "stamp") if name in content}
    for name, array in found.items():
        if array.dtype.kind not in "biuf":
            raise InputError(f"{path} is no .npz file of scans: `{name}` must be numbers, got {array.dtype}")
    return {name: array if name == "ranges" else array.astype(np.float64) for name, array in found.items()}
