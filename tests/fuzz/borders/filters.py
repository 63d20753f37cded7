"""People taken out of recorded drives: logs and bags of any content in, a copy that differs in ranges alone out."""

import gzip
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from borders import bags
from borders.logs import hostile
from borders.options import run_words
from fuzzer import grammars
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put, put_all
from fuzzer.mutations import choice
from fuzzer.sanity import sane_drive
from fuzzer.values import hostile_word
from numpy.random import Generator
from tagalong.perception.config import perception_preset
from tagalong.perception.filtered_logs.log import filter_log
from tagalong.slam import InputError, read_log

_CONFIG = perception_preset("recorded")
_OPTIONS = {
    "--scan-topic": ["/scan"], "--odometry-topic": ["/odom"], "--topic": ["/scan", "/other", ""],
    "--preset": ["ye2021", "recorded"], "--forest": ["real", "simulation"],
}  # fmt: skip
_TARGETS = ("OUT/a.log", "OUT/a.log.gz", "LOG", "IN/fifo", "IN/loop", "IN", "OUT", "OUT/" + "n" * 300, "IN/nowhere/x")


def filtered(source: Path, target: Path, read: Callable[[Path, Path], Any]) -> Any:
    """Filter `source` to `target`; return what `read` makes of both. A refusal has to leave nothing behind."""
    before = _names(target.parent)
    try:
        filter_log(source, target, _CONFIG)
    except InputError:
        require(_names(target.parent) == before, "a refusal left a file")
        raise
    return read(source, target)


def _names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def _fresh(folder: Path) -> Path:
    """Return a folder for the copy, empty."""
    place = folder / "copy"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    return place


def _carmen(value: Input, folder: Path) -> Any:
    source = put(folder, "drive.log", value)
    return filtered(source, _fresh(folder) / "drive.log", lambda a, b: (_content(a), _content(b)))


def _content(path: Path) -> bytes:
    content = path.read_bytes()
    return gzip.decompress(content) if content[:2] == b"\x1f\x8b" else content


def _only_ranges_differ(contents: tuple[bytes, bytes]) -> None:
    before, after = (content.split(b"\n") for content in contents)
    require(len(before) == len(after), "lines were lost or added")
    for one, other in zip(before, after, strict=True):
        if one != other:
            words, copies = one.split(), other.split()
            require(len(words) == len(copies), "words were lost or added")
            changed = [copy for word, copy in zip(words, copies, strict=True) if word != copy]
            require(set(changed) == {b"0.0"}, f"changed to {changed[:3]}")


def _messages(value: Input, folder: Path) -> Any:
    (folder / "drive.bag").unlink(missing_ok=True)
    source = bags.write_bag(folder / "drive.bag", value, ros2=False)
    return filtered(source, _fresh(folder) / "drive.bag", _read_back)


def _bag1(value: Input, folder: Path) -> Any:
    return filtered(put(folder, "drive.bag", value), _fresh(folder) / "drive.bag", _read_back)


def _bag2(value: Input, folder: Path) -> Any:
    return filtered(put_all(folder / "bag2", value), _fresh(folder) / "bag", _read_back)


def _read_back(source: Path, target: Path) -> Any:
    """Return the copy as a drive, if the original can be read as one: the filter takes what it needs, no more."""
    try:
        read_log(source, "/scan")
    except InputError:
        return None
    return read_log(target, "/scan_filtered")


def _sane_copy(drive: Any) -> None:
    if drive is not None:
        sane_drive(drive)


def _words(rng: Generator) -> Input:
    """Return a command line of hostile options; one in three has targets that are none."""
    target = _TARGETS[int(rng.integers(len(_TARGETS)))] if rng.random() < 0.35 else "OUT/a.log"
    words = ["filter", "LOG", target, "--quiet"]
    for _ in range(int(rng.integers(0, 3))):
        option = list(_OPTIONS)[int(rng.integers(len(_OPTIONS)))]
        words += [option, choice(rng, _OPTIONS[option]) if rng.random() < 0.5 else hostile_word(rng)]
    if rng.random() < 0.1:
        words[1] = hostile_word(rng) if rng.random() < 0.6 else "IN/fifo"
    return words


def _sane_end(result: Any) -> None:
    require(result[0] == 0, f"exit status {result[0]}")


def _warm() -> None:
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as folder:
        _carmen(grammars.carmen(rng), Path(folder))
        _bag1(bags.sound(ros2=False)["drive.bag"], Path(folder))
        run_words(["filter", "--help"], Path(folder))


AREA = Area(
    (
        Border(
            name="filter.carmen", make=hostile(grammars.carmen), call=_carmen, sane=_only_ranges_differ,
            file="drive.log", ms=10.0,
        ),
        Border(
            name="filter.messages", make=bags.messages, call=_messages, sane=_sane_copy, file="drive.bag", ms=40.0,
        ),
        Border(
            name="filter.ros1", make=bags.damaged1, call=_bag1, sane=_sane_copy, file="drive.bag", ms=20.0,
            reserved_mb=5000,  # as of bags.ros1
        ),
        Border(name="filter.ros2", make=bags.damaged2, call=_bag2, sane=_sane_copy, file="bag2", ms=60.0),
        Border(name="filter.options", make=_words, call=run_words, sane=_sane_end, ms=25.0),
    ),
    _warm,
)  # fmt: skip
