"""`--record`: drives of any content written for viewers, and names of recordings."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from borders.engines import FEW
from borders.options import run_words, sane_end
from fuzzer import grammars
from fuzzer.border import Area, Border, Input, require
from fuzzer.files import put, put_all
from fuzzer.mutations import choice, mutated_text, with_extremes
from fuzzer.scans import hostile_drive, scan_of
from fuzzer.values import hostile_word
from numpy.random import Generator
from rosbags.highlevel import AnyReader
from tagalong.slam import InputError
from tagalong.slam.logs.recording import open_recording

_NAMES = ("IN/fifo", "IN/loop", "IN", "IN/nowhere/x.mcap", "OUT/" + "n" * 300 + ".rrd", "OUT/a.bag", "OUT/a", "LOG")

_COMMANDS = (["slam", "LOG", "--method", "ekf"], ["perceive", "LOG"])
_ENDINGS = (".mcap", ".rrd")


def _commands(rng: Generator) -> Input:
    """Return a log of any content, the command that reads it, and where the recording goes."""
    log = grammars.carmen(rng) if rng.random() < 0.3 else mutated_text(rng, grammars.carmen(rng))
    command = _COMMANDS[int(rng.integers(len(_COMMANDS)))]
    name = f"OUT/{hostile_word(rng)[:200].replace('/', '_')}" if rng.random() < 0.1 else "OUT/a"
    ending = choice(rng, list(_ENDINGS))
    target = choice(rng, list(_NAMES)) if rng.random() < 0.1 else name + ending
    return {"log": log, "words": [*command, "--out", "OUT", "--record", target]}


def _ran(value: Input, folder: Path) -> Any:
    log = put(folder, "hostile.log", value["log"])
    few = [word for name, number in FEW["ekf"].items() for word in ("--set", f"{name}={number}")]
    words = [str(log) if word == "LOG" and k == 1 else word for k, word in enumerate(value["words"])]
    result = run_words([*words, *(few if words[0] == "slam" else [])], folder)
    target = words[-1].replace("OUT", str(folder / "out"), 1)
    if words[-1].startswith("OUT/a."):
        _read_back(Path(target))
    return result


def _calls(rng: Generator) -> Input:
    """Return a drive and people of any numbers, and the kind of recording."""
    people = np.round(with_extremes(rng, rng.uniform(-5.0, 5.0, (2, 2)), 0.2 * (rng.random() < 0.5)), 3)
    return {"frames": hostile_drive(rng, beams=12), "people": people.tolist(), "ending": choice(rng, list(_ENDINGS))}


def _written(value: Input, folder: Path) -> Any:
    path = put_all(folder / "recorded", {}) / f"a{value['ending']}"
    try:
        with open_recording(path) as recording:
            for frame in value["frames"]:
                scan = scan_of(frame)
                recording.scan(scan)
                recording.odometry(scan.time_s, frame["odometry"])
                recording.people(scan.time_s, value["people"])
    except InputError:
        require(not any(path.parent.iterdir()), "a refusal left a file")
        raise
    return path


def _read_back(path: Path) -> None:
    require(path.stat().st_size > 0, "no recording")
    if path.suffix == ".mcap":
        with AnyReader([path]) as reader:
            for connection, _, raw in reader.messages():
                reader.deserialize(raw, connection.msgtype)


def _warm() -> None:
    """Make all ready but rerun's library: it has threads, which do not come along to children."""
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as folder:
        for command in _COMMANDS:
            words = [*command, "--out", "OUT", "--record", "OUT/a.mcap"]
            _ran({"log": grammars.carmen(rng), "words": words}, Path(folder))


_RERUN_MB = 6000  # of address space, for its threads

AREA = Area(
    (
        Border(
            name="record.commands", make=_commands, call=_ran, sane=sane_end, ms=350.0, reserved_mb=_RERUN_MB,
        ),
        Border(name="record.calls", make=_calls, call=_written, sane=_read_back, ms=150.0, reserved_mb=_RERUN_MB),
    ),
    _warm,
)  # fmt: skip
