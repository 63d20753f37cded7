"""Folders of RGB-D frames: pictures, arrays and descriptions of any content, and the commands that look at them."""

import io
import json
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from borders.options import run_words, sane_end
from fuzzer.arrays import KINDS, header
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put_all
from fuzzer.mutations import choice, extreme_float, mutated_bytes, mutated_text
from fuzzer.sanity import finite
from fuzzer.values import hostile_value, hostile_word
from numpy.random import Generator
from PIL import Image
from tagalong.perception import PeopleFinder, PlaneFinder
from tagalong.perception.rgbd.pictures import read_frames

_ROWS, _COLS = 48, 64
_NOTES: dict[str, Any] = {
    "width": _COLS, "height": _ROWS, "fx": 55.0, "fy": 55.0, "cx": 31.5, "cy": 23.5, "depth_unit_m": 0.001,
    "time_s": 0.0, "distortion": [0.01, 0.0, 0.0, 0.0, 0.0], "principal_point": "centres", "licence": "none stated",
    "camera_height_m": 1.0, "pitch_deg_nose_down": 0.0, "roll_deg_left_up": 0.0, "floor_visible": True,
    "table_top_visible": False, "people": 1, "people_boxes_xyxy": [[10, 5, 30, 40]],
}  # fmt: skip
_SHAPES = ([_ROWS, _COLS], [0, 0], [_ROWS], [3, 3, 3], [10**5, 10**5], [2**31, 2**31], [0, 10**12], [_COLS, _ROWS])
_OPTIONS = {
    "--camera-height": ["1.0"], "--camera-tilt": ["10", "0"], "--sensor": ["stereo"], "--sequence": [],
    "--no-overlays": [], "--odometry": ["log"], "--record": ["OUT/a.mcap"],
}  # fmt: skip
_BENCH = {"--camera-height": ["reference", "none"], "--height-error": ["0.05"], "--columns": ["64", "32", "128"],
          "--left-out": ["OUT"], "--model": ["real"]}  # fmt: skip


@cache
def _depth() -> np.ndarray:
    """Return (rows, columns) millimetres of a floor one metre below and a wall."""
    rows = np.arange(_ROWS)[:, None]
    metres = np.minimum(1.0 / np.maximum((rows - 23.5) / 55.0, 1e-3), 4.0) * np.ones((_ROWS, _COLS))
    return np.round(1000.0 * metres).astype(np.uint16)


@cache
def _picture(kind: str, deep: bool) -> bytes:
    """Return the depths, or a grey picture, as a file."""
    file = io.BytesIO()
    pixels = _depth() if deep else np.full((_ROWS, _COLS, 3), 128, np.uint8)
    Image.fromarray(pixels).save(file, kind)
    return file.getvalue()


def _array(rng: Generator) -> bytes:
    """Return an .npy: sound, with extreme numbers, of another kind, or with a header that says what is not there."""
    draw, file = rng.random(), io.BytesIO()
    if draw < 0.3:
        return header(KINDS[int(rng.integers(len(KINDS)))], _SHAPES[int(rng.integers(len(_SHAPES)))]) + b"\x00" * 64
    if draw < 0.35:
        return header("|O", [1]) + b"\x80\x04N."
    depth = 1e-3 * _depth().astype(np.float32)
    with np.errstate(all="ignore"):
        for _ in range(int(rng.integers(0, 40))):
            depth[int(rng.integers(_ROWS)), int(rng.integers(_COLS))] = extreme_float(rng)
        plain = depth.astype(choice(rng, ["<f4", "<f8", "<u2", "<i4", "|b1", "<f2", "<c8"]))
    np.save(file, plain, allow_pickle=False)
    return file.getvalue() if draw < 0.8 else mutated_bytes(rng, file.getvalue())


def _described(rng: Generator) -> bytes:
    """Return the description of a frame with some values replaced, or its text damaged."""
    notes = dict(_NOTES)
    for _ in range(int(rng.integers(0, 3))):
        key = list(notes)[int(rng.integers(len(notes)))]
        if rng.random() < 0.2:
            del notes[key]
        else:
            notes[key] = _plain(hostile_value(rng, notes[key]))
    text = json.dumps(notes, indent=1).encode()
    return mutated_text(rng, text) if rng.random() < 0.2 else text


def _plain(value: Any) -> Any:
    """Return a value as JSON can say it."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value.decode("latin-1") if isinstance(value, bytes) else value


def _folder(rng: Generator) -> Input:
    """Return the files of a folder of one or two frames, of which something is wrong."""
    files: dict[str, bytes] = {}
    for name in ("a", "b")[: 1 + (rng.random() < 0.3)]:
        if rng.random() < 0.25:
            files[f"{name}_depth.npy"] = _array(rng)
        else:
            files[f"{name}_depth.png"] = _picture("PNG", True)
        if rng.random() < 0.7:
            files[f"{name}.jpg"] = _picture("JPEG", False)
        files[f"{name}.json" if rng.random() < 0.8 else "camera.json"] = _described(rng)
    if rng.random() < 0.3:
        name = list(files)[int(rng.integers(len(files)))]
        files[name] = mutated_bytes(rng, files[name])
    return files


def _looked(value: Input, folder: Path) -> Any:
    planes_finder, finder, seen = PlaneFinder(), PeopleFinder.load(), []
    for recorded in read_frames(put_all(folder / "frames", value)):
        planes = planes_finder.find(recorded.frame)
        seen.append((planes, finder.find(planes.frame, planes)))
    return seen


def _sane(seen: Any) -> None:
    require(len(seen) > 0, "no frame")
    for planes, people in seen:
        finite(planes.mount.up, "the vertical", 1.001)
        finite(people.positions, "people's places", 1e7)
        finite(people.likelihood, "likelihood", 1.0)


def _words(command: list[str], options: dict[str, list[str]]) -> Any:
    def make(rng: Generator) -> Input:
        words = []
        for _ in range(int(rng.integers(0, 3))):
            option = list(options)[int(rng.integers(len(options)))]
            usual = options[option]
            words.append(option)
            if usual:
                written = option == "--record"  # only ever below the folder of the input
                words += [choice(rng, usual) if written or rng.random() < 0.6 else hostile_word(rng)]
            if option == "--camera-tilt":
                words.append("0" if rng.random() < 0.7 else hostile_word(rng))
        return {"files": _folder(rng), "words": [*command, "FRAMES", "--out", "OUT", *words]}

    return make


def _run(value: Input, folder: Path) -> Any:
    frames = str(put_all(folder / "frames", value["files"]))
    return run_words([frames if word == "FRAMES" else word for word in value["words"]], folder)


def _warm() -> None:
    files = {
        "a_depth.png": _picture("PNG", True),
        "a.jpg": _picture("JPEG", False),
        "a.json": json.dumps(_NOTES).encode(),
    }
    with tempfile.TemporaryDirectory() as folder:
        for words in (["perceive", "FRAMES", "--out", "OUT"], ["bench", "rgbd-recorded", "FRAMES", "--out", "OUT"]):
            _run({"files": files, "words": words}, Path(folder))


AREA = Area(
    (
        Border(name="frames.folder", make=_folder, call=_looked, sane=_sane, file="frames", ms=20.0),
        Border(
            name="frames.perceive", make=_words(["perceive"], _OPTIONS), call=_run, sane=sane_end, ms=40.0,
        ),
        Border(
            name="frames.bench", make=_words(["bench", "rgbd-recorded"], _BENCH), call=_run, sane=sane_end, ms=15.0,
        ),
    ),
    _warm,
)  # fmt: skip
