"""`tagalong data`: folders that say they hold public recordings, and originals of any content."""

import lzma
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from borders import bags
from borders.options import run_words, sane_end
from fuzzer import grammars
from fuzzer.arrays import edits, packed
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put
from fuzzer.mutations import gzipped, mutated_bytes, mutated_text
from fuzzer.values import hostile_word
from numpy.random import Generator
from tagalong.scripts.public_data.catalogue import catalogue
from tagalong.scripts.public_data.derive import RECIPES, derive

_STATES = ("there", "made", "not made: ")


@cache
def _paths() -> list[str]:
    return [file.path for collection in catalogue() for file in collection.files]


def _original(rng: Generator, name: str) -> bytes:
    """Return an original that a recipe reads, damaged, packed as its name says."""
    if name.endswith(".bag.xz"):
        content = bags.damaged1(rng) if rng.random() < 0.5 else bags.sound(ros2=False)["drive.bag"]
        whole = lzma.compress(content, preset=0)
        return whole if rng.random() < 0.6 else mutated_bytes(rng, whole)
    text = grammars.relations(rng) if "relations" in name else grammars.carmen(rng)
    text = mutated_text(rng, text) if rng.random() < 0.8 else text
    return gzipped(rng, text) if name.endswith(".gz") and rng.random() < 0.9 else text


def _derivation(rng: Generator) -> Input:
    path = list(RECIPES)[int(rng.integers(len(RECIPES)))]
    source = RECIPES[path][0]
    files = {source: _original(rng, source)}
    if "relations" in source:
        files["slam_logs/intel_full.clf.gz"] = _original(rng, "intel_full.clf.gz")
    return {"path": path, "files": files}


def _laid(value: Input, folder: Path) -> Path:
    """Write the files below `folder`, which holds nothing else then."""
    place = folder / "data"
    for old in sorted(place.rglob("*"), reverse=True):
        if old.is_file():
            old.unlink()
    for name, content in value["files"].items():
        (place / name).parent.mkdir(parents=True, exist_ok=True)
        put((place / name).parent, Path(name).name, content)
    return place


def _derived(value: Input, folder: Path) -> Any:
    place = _laid(value, folder)
    said = derive(value["path"], place, folder / "into")
    made = folder / "into" / value["path"]
    require(made.exists() == (said == "made"), f"told {said[:80]}, which is not so")
    left = list((folder / "into").rglob("*"))
    made.unlink(missing_ok=True)
    require(all(path.is_dir() or path == made for path in left), "a file was left")
    return said


def _told(said: str) -> None:
    require(said.startswith(_STATES), f"told {said[:80]}")
    require(len(said) <= 400 and said.isprintable(), f"{len(said)} characters, or signs that do not print")


def _collection(rng: Generator) -> Input:
    """Return a folder with some files of the catalogue, of any content, and the command that looks at it."""
    files: dict[str, Any] = {}
    for _ in range(int(rng.integers(0, 4))):
        path = _paths()[int(rng.integers(len(_paths())))]
        files[path] = _content(rng, path)
    words = ["data", "check", "DATA"] if rng.random() < 0.6 else ["data", "derive", "DATA", "--into", "OUT"]
    if words[1] == "check" and rng.random() < 0.4:
        words += ["--only", "slam_logs" if rng.random() < 0.5 else hostile_word(rng)]
    if rng.random() < 0.1:
        words[2] = hostile_word(rng) if rng.random() < 0.6 and words[1] == "check" else "IN/fifo"
    return {"words": words, "files": files}


def _content(rng: Generator, path: str) -> Any:
    if path.endswith(".npz"):
        return packed({"ranges": np.ones((2, 3), np.float32)}, edits(rng, ["ranges"]))
    if path.endswith(".gz") and rng.random() < 0.05:
        return {"bomb": b"\n", "megabytes": int(rng.integers(1200, 3000))}
    return _original(rng, path)


def _ran(value: Input, folder: Path) -> Any:
    place = _laid(value, folder)
    place.mkdir(exist_ok=True)
    return run_words([str(place) if word == "DATA" else word for word in value["words"]], folder)


def _warm() -> None:
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(20):
            _derived(_derivation(rng), Path(folder))
        _ran({"words": ["data", "check", "DATA"], "files": {}}, Path(folder))


AREA = Area(
    (
        Border(name="data.derive", make=_derivation, call=_derived, sane=_told, ms=3.0, reserved_mb=5000),
        Border(name="data.commands", make=_collection, call=_ran, sane=sane_end, ms=90.0, reserved_mb=5000),
    ),
    _warm,
)
