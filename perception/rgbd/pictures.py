"""Folders of recorded frames: a depth picture, a colour picture and the camera's intrinsics each.

    NAME_depth.png   16 bit, millimetres along the axis (or `depth_unit_m`), 0 where nothing was measured; or an .npy
    NAME.jpg, .png   colour, of the same size; may be missing
    NAME.json        intrinsics; or one camera.json for the whole folder

The intrinsics: `width`, `height`, `fx`, `fy`, `cx`, `cy` [pixels], and, if need be, `distortion` (k1, k2, p1, p2,
k3, k4, k5, k6, or the first few), `principal_point` ("centres": the centre of pixel (0, 0) is at (0, 0), as OpenCV and
ROS have it, which is the default; or "pixel edges": it is at (0.5, 0.5)), `depth_unit_m` (0.001) and `time_s`.
"""

import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown
from ...slam.files.input import checked_name, named, names_file, opened, read_json
from ...slam.files.npz import read_array
from ...slam.files.pictures import decoded
from .frame import Pinhole, RgbdFrame, grey

_MOST_BYTES = 64 << 20
_WHY = "a picture of 8192 x 4096 pixels has less"
_ENDINGS = ("_depth.png", "_depth.npy")
_COLOURS = (".jpg", ".jpeg", ".png")
DEPTH_MODES = ("I;16", "I;16B", "I;16L", "I", "L")
CAMERA_FILE = "camera.json"


@dataclass(frozen=True)
class RecordedFrame:
    """A frame of a folder.

    Attributes:
        name: Its name there.
        frame: The frame; neither height nor tilt of the camera is told.
        notes: What its JSON holds.
    """

    name: str
    frame: RgbdFrame
    notes: Mapping[str, Any]


def read_frames(folder: str | os.PathLike[str]) -> Iterator[RecordedFrame]:
    """Yield the frames of a folder in the order of their names.

    Raises:
        InputError: If it is no folder or holds no frame, or where a file is missing, damaged, or of another size.
    """
    place = checked_name(folder)
    if not place.is_dir():
        raise InputError(f"{named(place)}: is no folder of frames (NAME_depth.png, NAME.jpg, NAME.json)")
    depths = sorted(path for ending in _ENDINGS for path in place.glob(f"*{ending}"))
    if not depths:
        raise InputError(f"{named(place)}: holds no frame; depth pictures are called NAME_depth.png or NAME_depth.npy")
    for number, path in enumerate(depths):
        yield _read_frame(path, number)


def _read_frame(path: Path, number: int) -> RecordedFrame:
    name = path.name.removesuffix("_depth" + path.suffix)
    own = path.with_name(f"{name}.json")
    described = own if own.exists() else path.with_name(CAMERA_FILE)
    if not described.exists():
        raise InputError(f"{named(path)}: its camera is not known; write {own.name} or {CAMERA_FILE} beside it")
    notes = read_json(described)
    if not isinstance(notes, dict):
        raise InputError(f"{named(described)}: must be an object with the camera's intrinsics, got {shown(notes)}")
    camera = read_camera(notes, named(described))
    depth = read_depth(path, _number(notes, "depth_unit_m", named(described), 1e-3))
    colour = next((path.with_name(name + end) for end in _COLOURS if path.with_name(name + end).exists()), None)
    picture = grey(camera) if colour is None else read_colour(colour)
    time_s = _number(notes, "time_s", named(described), float(number))
    try:
        frame = RgbdFrame(depth, picture, camera, time_s, camera_height=None)
    except InputError as error:
        raise InputError(f"{named(path)}: {error}") from error
    return RecordedFrame(name, frame, notes)


def read_camera(notes: Mapping[str, Any], source: str) -> Pinhole:
    """Return the camera that the intrinsics `notes` of a file `source` describe."""
    width, height, fx, fy, cx, cy = (_number(notes, k, source) for k in ("width", "height", "fx", "fy", "cx", "cy"))
    if width != int(width) or height != int(height):
        raise InputError(f"{source}: `width` and `height` must be whole numbers, got {width:g} and {height:g}")
    edges = str(notes.get("principal_point", "centres")).startswith("pixel edges")
    shift = 0.5 if edges else 0.0
    distortion = notes.get("distortion", [])
    if not isinstance(distortion, list) or not all(is_number(k) for k in distortion):
        raise InputError(f"{source}: `distortion` must be a list of finite numbers, got {shown(distortion)}")
    try:
        size, centre = (int(width), int(height)), (cx - shift, cy - shift)
        return Pinhole.from_intrinsics(size, (fx, fy), centre, tuple(map(float, distortion)))
    except InputError as error:
        raise InputError(f"{source}: {error}") from error


def _number(notes: Mapping[str, Any], key: str, source: str, default: float | None = None) -> float:
    value = notes.get(key, default)
    if not is_number(value):
        raise InputError(f"{source}: `{key}` must be a finite number, got {shown(value)}")
    return float(value)


def is_number(value: object) -> TypeGuard[int | float]:
    """Return whether a value of a JSON file is a number that a double can hold: a whole one may have any length."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    return abs(value) <= sys.float_info.max


@names_file
def read_depth(path: str | os.PathLike[str], unit_m: float = 1e-3) -> NDArray[Any]:
    """Return (h, w) depths of a picture of 16 bit, in units of `unit_m` [m], or of an .npy as it holds them."""
    if Path(path).suffix == ".npy":
        depth = read_array(path, _MOST_BYTES)
        if depth.ndim != 2 or depth.dtype.kind not in "iuf":
            raise InputError(f"depths must be numbers of two dimensions, got {depth.dtype} of shape {depth.shape}")
        return depth
    with opened(path, _MOST_BYTES, _WHY) as file:
        picture = decoded(file)
    if picture.mode not in DEPTH_MODES:
        raise InputError(f"a depth picture has one channel of 16 bit, got mode {picture.mode}")
    depth = np.asarray(picture)
    return depth if unit_m == 1e-3 else depth.astype(np.float32) * np.float32(unit_m)


@names_file
def read_colour(path: str | os.PathLike[str]) -> NDArray[np.uint8]:
    """Return (h, w, 3) red, green, blue of a picture."""
    with opened(path, _MOST_BYTES, _WHY) as file:
        return np.asarray(decoded(file).convert("RGB"))
