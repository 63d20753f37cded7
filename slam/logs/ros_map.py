"""Maps as ROS map_server stores them: an image and a YAML file beside it. Written are PGM, in its mode `trinary`."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..files.input import checked_name
from ..files.map_image import MapImage, read_map_image
from ..files.output import replacing, write_text
from ..files.sizes import MOST_PIXELS
from ..geometry import inverse, transform_points
from ..occupancy_map import OccupancyMap
from .flat_yaml import Value, read_flat_yaml

# what map_saver writes: white is free, black is occupied, this grey is unknown
_FREE, _OCCUPIED, _UNKNOWN = 254, 0, 205
_TRUTH = {"true": "1", "false": "0"}
_RESOLUTIONS = 0.001, 10.0  # [m] sides of cells that make sense; others are a unit taken for another
_OCCUPIED_THRESHOLD, _FREE_THRESHOLD = 0.65, 0.196
_MODES = "trinary", "scale", "raw"
_PER_CENT = 100.0  # in the mode `raw` a shade is a probability in per cent; a higher one is unknown


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

    The modes `scale` and `raw` know probabilities in between. Where the image is transparent nothing is known. A map
    that is turned against its frame (yaw) is drawn anew along it, each cell as the one that its centre lies in.

    Raises:
        InputError: If a key is missing or has no sense, or the image is missing, no picture or too large.
    """
    file = Path(path)
    entries = read_flat_yaml(file)
    mode = entries.get("mode", "trinary")
    if mode not in _MODES:
        raise InputError(f"{file}: `mode` must be one of {', '.join(_MODES)}, got {shown(mode)}")
    resolution = _number(file, entries, "resolution")
    if not _RESOLUTIONS[0] <= resolution <= _RESOLUTIONS[1]:
        raise InputError(
            f"{file}: `resolution` must lie in [{_RESOLUTIONS[0]:g}, {_RESOLUTIONS[1]:g}] m, got {resolution:g}"
        )
    occupied_above, free_below = _number(file, entries, "occupied_thresh"), _number(file, entries, "free_thresh")
    if not 0.0 <= free_below <= occupied_above <= 1.0:
        raise InputError(f"{file}: needs 0 <= free_thresh <= occupied_thresh <= 1, got {free_below}, {occupied_above}")
    x, y, yaw = _origin(file, entries)
    name = entries.get("image")
    if not isinstance(name, str) or not name:
        raise InputError(f"{file}: needs the key `image` with the name of the picture")
    image = read_map_image(file.parent / checked_name(name))
    negated = bool(_number(file, entries, "negate", 0.0))
    meant = _probabilities(str(mode), image.white, negated, occupied_above, free_below)
    probability = _drawn(image, meant)
    if yaw == 0.0:
        return OccupancyMap(probability, resolution, (x, y))
    return _turned(OccupancyMap(probability, resolution, (0.0, 0.0)), np.array((x, y, yaw)))


def _probabilities(
    mode: str, white: int, negated: bool, occupied_above: float, free_below: float
) -> NDArray[np.float32]:
    """Return (256,) what each shade means: a probability, or NaN."""
    shades = np.arange(256, dtype=np.float64)
    if mode == "raw":
        percent = white - shades if negated else shades
        known = (percent >= 0.0) & (percent <= _PER_CENT)
        return np.where(known, percent / _PER_CENT, np.nan).astype(np.float32)
    occupancy = shades / white if negated else 1.0 - shades / white
    between = (occupancy - free_below) / max(occupied_above - free_below, 1e-9)
    probability = between.clip(0.0, 1.0) if mode == "scale" else np.full(256, np.nan)
    probability[occupancy > occupied_above] = 1.0
    probability[occupancy < free_below] = 0.0
    return probability.astype(np.float32)


def _drawn(image: MapImage, meant: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return (rows, cols) the probabilities of an image, lowest row first."""
    probability = meant[image.shades[::-1]]
    if image.clear is not None:
        probability[image.clear[::-1]] = np.nan
    return probability


def _turned(grid: OccupancyMap, T_map_grid: NDArray[np.float64]) -> OccupancyMap:
    """Return a map whose frame is turned and moved, drawn anew along the axes of the new frame, cell by cell."""
    (rows, cols), cell = grid.probability.shape, grid.resolution
    corners = transform_points(T_map_grid, np.array([(0, 0), (cols, 0), (0, rows), (cols, rows)]) * cell)
    low, high = corners.min(axis=0), corners.max(axis=0)
    wide, tall = np.ceil((high - low) / cell - 1e-6).astype(int)
    if wide * tall > MOST_PIXELS:
        raise InputError(f"a map must have {MOST_PIXELS} cells at most, got {tall} x {wide} when it is turned")
    turned, centres = np.full((tall, wide), np.nan, dtype=np.float32), np.empty((wide, 2))
    centres[:, 0] = low[0] + (np.arange(wide) + 0.5) * cell
    for row in range(tall):
        centres[:, 1] = low[1] + (row + 0.5) * cell
        x, y = np.floor(transform_points(inverse(T_map_grid), centres) / cell).astype(int).T
        inside = (x >= 0) & (y >= 0) & (x < cols) & (y < rows)
        turned[row, inside] = grid.probability[y[inside], x[inside]]
    return OccupancyMap(turned, cell, (float(low[0]), float(low[1])))


def _number(file: Path, entries: dict[str, Value], key: str, default: float | None = None) -> float:
    value = entries.get(key, default)
    try:
        number = float(_TRUTH.get(str(value).lower(), str(value)))
    except ValueError:
        number = np.nan
    if not np.isfinite(number):
        raise InputError(f"{file}: the key `{key}` needs a number, got {'nothing' if value is None else shown(value)}")
    return number


def _origin(file: Path, entries: dict[str, Value]) -> tuple[float, float, float]:
    value = entries.get("origin")
    try:
        x, y, yaw = map(float, value or ())
    except ValueError:
        x = y = yaw = np.nan
    if not np.isfinite([x, y, yaw]).all():
        raise InputError(f"{file}: the key `origin` needs [x, y, yaw], got {shown(value)}")
    return x, y, yaw
