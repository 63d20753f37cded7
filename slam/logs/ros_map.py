"""Maps as ROS map_server stores them: an image (PGM) and a YAML file beside it, in its mode `trinary`."""

import os
from pathlib import Path

import numpy as np

from ..errors import InputError, shown
from ..files.input import checked_name
from ..files.output import replacing, write_text
from ..files.pgm import read_pgm
from ..occupancy_map import OccupancyMap
from .flat_yaml import Value, read_flat_yaml

# what map_saver writes: white is free, black is occupied, this grey is unknown
_FREE, _OCCUPIED, _UNKNOWN = 254, 0, 205
_TRUTH = {"true": "1", "false": "0"}
_RESOLUTIONS = 0.001, 10.0  # [m] sides of cells that make sense; others are a unit taken for another
_OCCUPIED_THRESHOLD, _FREE_THRESHOLD = 0.65, 0.196


def write_ros_map(path: str | os.PathLike[str], grid: OccupancyMap) -> None:
    """Write `grid` as PATH.yaml and PATH.pgm (PATH may be given with either ending): free, occupied or unknown.

    What is occupied and free is decided by the map's own thresholds; a known cell on the border is unknown.
    """
    stem = Path(path)
    if stem.suffix in (".yaml", ".pgm"):
        stem = stem.with_suffix("")
    image = stem.with_name(stem.name + ".pgm")
    pixels = np.full(grid.probability.shape, _UNKNOWN, dtype=np.uint8)
    pixels[grid.free] = _FREE
    pixels[grid.occupied] = _OCCUPIED
    rows, cols = grid.probability.shape
    with replacing(image) as temporary:
        temporary.write_bytes(f"P5\n{cols} {rows}\n255\n".encode() + pixels[::-1].tobytes())
    write_text(
        stem.with_name(stem.name + ".yaml"),
        f"image: {image.name}\n"
        "mode: trinary\n"
        f"resolution: {grid.resolution:.9g}\n"
        f"origin: [{grid.origin[0]:.9g}, {grid.origin[1]:.9g}, 0]\n"
        "negate: 0\n"
        f"occupied_thresh: {_OCCUPIED_THRESHOLD}\n"
        f"free_thresh: {_FREE_THRESHOLD}\n",
    )


def read_ros_map(path: str | os.PathLike[str]) -> OccupancyMap:
    """Read a map by its YAML file: probability 1 where occupied, 0 where free, NaN where unknown.

    Raises:
        InputError: If a key is missing or has no sense, the mode is not `trinary`, the map is turned against its frame,
            or the image is missing or no 8-bit PGM.
    """
    file = Path(path)
    entries = read_flat_yaml(file)
    mode = entries.get("mode", "trinary")
    if mode != "trinary":
        raise InputError(f"{file}: only the mode trinary is supported, got {shown(mode)}")
    resolution = _number(file, entries, "resolution")
    if not _RESOLUTIONS[0] <= resolution <= _RESOLUTIONS[1]:
        raise InputError(
            f"{file}: `resolution` must lie in [{_RESOLUTIONS[0]:g}, {_RESOLUTIONS[1]:g}] m, got {resolution:g}"
        )
    occupied_above, free_below = _number(file, entries, "occupied_thresh"), _number(file, entries, "free_thresh")
    if not 0.0 <= free_below <= occupied_above <= 1.0:
        raise InputError(f"{file}: needs 0 <= free_thresh <= occupied_thresh <= 1, got {free_below}, {occupied_above}")
    origin = _origin(file, entries)
    image = entries.get("image")
    if not isinstance(image, str) or not image:
        raise InputError(f"{file}: needs the key `image` with the name of the PGM file")
    pixels, white = read_pgm(file.parent / checked_name(image))
    shades = np.arange(256) / white
    occupancy = shades if _number(file, entries, "negate", 0.0) else 1.0 - shades
    probability = np.full(256, np.nan, dtype=np.float32)
    probability[occupancy > occupied_above] = 1.0
    probability[occupancy < free_below] = 0.0
    return OccupancyMap(probability[pixels[::-1]], resolution, origin)


def _number(file: Path, entries: dict[str, Value], key: str, default: float | None = None) -> float:
    value = entries.get(key, default)
    try:
        number = float(_TRUTH.get(str(value).lower(), str(value)))
    except ValueError:
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{file}: the key `{key}` needs a number, got {'nothing' if value is None else shown(value)}")
    return number


def _origin(file: Path, entries: dict[str, Value]) -> tuple[float, float]:
    value = entries.get("origin")
    try:
        x, y, yaw = map(float, value or ())
    except ValueError:
        x = y = yaw = np.nan
    if not np.isfinite([x, y, yaw]).all():
        raise InputError(f"{file}: the key `origin` needs [x, y, yaw], got {shown(value)}")
    if yaw != 0.0:
        raise InputError(f"{file}: a map that is turned against its frame is not supported (yaw 0), got yaw {yaw}")
    return x, y
