"""The command line: options of any words, on a drive of a few scans."""

import contextlib
import io
import os
import shutil
import sys
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from borders.engines import FEW, setting_names
from fuzzer import grammars
from fuzzer.border import Area, Border, Call, Input, require
from fuzzer.declared import declared_options, takes_numbers
from fuzzer.files import put
from fuzzer.mutations import choice, mutated_text
from fuzzer.sanity import sane_map, sane_poses
from fuzzer.values import hostile_value, hostile_word, said
from numpy.random import Generator
from tagalong.perception.config import PRESETS
from tagalong.scripts.benchmarks.benchmark import BENCHMARKS
from tagalong.scripts.cli import main
from tagalong.scripts.reproduce.experiment import EXPERIMENTS
from tagalong.slam import InputError, make_slam, read_ros_map
from tagalong.slam.engine import ENGINES
from tagalong.slam.logs import read_tum

_OPTIONS = {
    "slam": ["--method", "--seed", "--resolution", "--set", "--scan-topic", "--quiet", "--out", "--bad"],
    "localize": ["--start", "--map", "--quiet", "--scan-topic", "--out"],
    "perceive": ["--preset", "--forest", "--odometry", "--frame", "--rate", "--min-confidence", "--scan-topic"],
    "score": ["--max-gap", "--json", "--overlay", "--readings", "--people"],
}
_USUAL = {
    "--method": [*ENGINES], "--seed": ["3"], "--resolution": ["0.1"], "--start": ["1"], "--map": ["MAP"],
    "--rate": ["10"],
    "--preset": ["ye2021", "recorded"],
    "--forest": ["real", "simulation"], "--odometry": ["none"], "--frame": ["robot"],
    "--min-confidence": ["0.3"], "--max-gap": ["1"],
}  # fmt: skip
_TARGETS = ("--out", "--json", "--overlay")
"""Options whose value is written to: only ever to names below the folder of the input, never to a device of the
machine, as the tests may run with the rights to replace it."""
_NAMES = ("OUT", "IN/fifo", "IN/loop", "IN", "IN/nowhere/x", "OUT/" + "n" * 300)


_LINES = """
evaluate pid --out OUT
demo --out OUT
teleop --operator model --out OUT/log.txt
train follower --out OUT
train follower --preset office --out OUT
train legs --forest simulation --out OUT
train people --out OUT
train tracker-errors --out OUT
record --out OUT
compare --out OUT
results --quick --out OUT
data record OUT/a.mcap
slam LOG --out OUT
localize LOG --map MAP --out OUT
perceive LOG --out OUT
score TUM TUM2
"""
_LONG_WORK = (
    *(tuple(line.split()) for line in _LINES.strip().splitlines()),
    *(("bench", name, "--out", "OUT") for name in BENCHMARKS),
    *(("reproduce", name, "--out", "OUT") for name in (*EXPERIMENTS, "all")),
)  # fmt: skip
"""Commands, most of which work for minutes: they get one option more that none takes, and have to say so at once."""
_NEVER = ("nan", "-inf", "1.5.2", "", "x", "9" * 5000, "a" * 5000, "1e", "\x00", "½", "99999999999999999999")


def _never_taken(rng: Generator) -> Input:
    fixed = _LONG_WORK[int(rng.integers(len(_LONG_WORK)))]
    options = _bounded()
    names = next(options[fixed[:n]] for n in (2, 1) if fixed[:n] in options)
    return [*fixed, names[int(rng.integers(len(names)))], choice(rng, list(_NEVER))]


@cache
def _bounded() -> dict[tuple[str, ...], list[str]]:
    """Return the options of each command that take numbers, or one of a few words."""
    found: dict[tuple[str, ...], list[str]] = {}
    for command, action in declared_options():
        if takes_numbers(action.type) or action.choices:
            found.setdefault(command, []).append(action.option_strings[0])
    return found


def _refused_at_once(value: Input, folder: Path) -> Any:
    result = run_words(value, folder)
    require(False, f"taken: {value}"[:500])
    return result


def words_of(command: str, fixed: list[str]) -> Any:
    """Return a source of command lines: the fixed words, then up to three options with hostile values."""

    def make(rng: Generator) -> Input:
        words = [command, *fixed]
        for _ in range(int(rng.integers(1, 4))):
            option = _OPTIONS[command][int(rng.integers(len(_OPTIONS[command])))]
            words.append(option)
            if option == "--set":
                words.append(_setting(rng))
            elif option in _TARGETS:
                words.append(_NAMES[int(rng.integers(len(_NAMES)))])
            elif option != "--quiet":
                words += [_word(rng, option) for _ in range(3 if option == "--start" else 1)]
        if rng.random() < 0.1:
            words[1] = hostile_word(rng) if rng.random() < 0.6 else "IN/fifo"
        return words

    return make


def _word(rng: Generator, option: str) -> str:
    usual = _USUAL.get(option, [])
    return choice(rng, usual) if usual and rng.random() < 0.5 else hostile_word(rng)


def _setting(rng: Generator) -> str:
    if rng.random() < 0.1:
        return hostile_word(rng)
    names = setting_names(make_slam(ENGINES[int(rng.integers(len(ENGINES)))]).config)
    path, usual = names[int(rng.integers(len(names)))]
    return f"{path}={said(hostile_value(rng, usual))}"


def run_words(value: Input, folder: Path) -> Any:
    """Run the command line in process; a refusal is raised as the error that was told, other printing is checked."""
    inputs = _inputs(folder)
    shutil.rmtree(folder / "out", ignore_errors=True)
    names = {"OUT": str(folder / "out"), "IN": str(inputs), "LOG": str(inputs / "drive.log")}
    names |= {"MAP": str(inputs / "map.yaml"), "TUM": str(inputs / "a.tum"), "TUM2": str(inputs / "b.tum")}
    words = [_spelled(word, names) for word in value]
    printed = io.StringIO()
    with contextlib.redirect_stderr(printed), contextlib.redirect_stdout(io.StringIO()):
        try:
            code = main(words)
        except SystemExit as end:  # --help
            code = end.code
    require((inputs / "fifo").is_fifo(), "a pipe was replaced by a file")
    lines = [line for line in printed.getvalue().split("\n") if line]
    if code == 2:
        if any("not enough memory" in line for line in lines):
            raise MemoryError(_one_line(lines))
        raise InputError(_one_line(lines))
    return code, lines


def _spelled(word: str, names: dict[str, str]) -> str:
    head, slash, rest = word.partition("/")
    return names[head] + slash + rest if head in names else word


def _one_line(lines: list[str]) -> str:
    """Return the message of a refusal; whatever is longer than a line shows as several."""
    told = [line for line in lines if line.startswith("tagalong")]
    return "\n".join(lines) if len(told) != len(lines) or not lines else told[-1]


def sane_end(result: Any) -> None:
    """Require an exit status that is promised, and short lines."""
    code, lines = result
    require(code in (0, 1), f"exit status {code}")
    require(all(len(line) <= 600 for line in lines), "a long line on stderr")


def _inputs(folder: Path) -> Path:
    """Return a folder with a log, a map and two trajectories."""
    target = folder / "in"
    if not target.is_dir():
        target.mkdir(parents=True)
        os.mkfifo(target / "fifo")
        rng = np.random.default_rng(5)
        put(target, "drive.log", grammars.carmen(np.random.default_rng(2)))
        put(target, "map.yaml", grammars.map_yaml(rng).replace(b"resolution: 0.05", b"resolution: 0.1"))
        put(target, "map.pgm", grammars.map_image(rng, 90))
        put(target, "a.tum", grammars.tum(np.random.default_rng(1)))
        put(target, "b.tum", grammars.tum(np.random.default_rng(1)))
    if not (target / "loop").is_symlink():
        (target / "loop").unlink(missing_ok=True)
        (target / "loop").symlink_to(target / "loop")
    return target


def _log(rng: Generator) -> Input:
    """Return a drive for an engine, of which one to four numbers are extreme."""
    return {"log": mutated_text(rng, grammars.carmen(rng)), "method": ENGINES[int(rng.integers(len(ENGINES)))]}


def _mapped(value: Input, folder: Path) -> Any:
    """Map a hostile log with `tagalong slam`."""
    log = put(folder, "hostile.log", value["log"])
    few = [f"{name}={number}" for name, number in FEW[value["method"]].items()]
    settings = [word for setting in few for word in ("--set", setting)]
    result = run_words(["slam", str(log), "--out", "OUT", "--quiet", "--method", value["method"], *settings], folder)
    sane_poses(read_tum(folder / "out" / "trajectory.tum").poses, "the trajectory")
    sane_map(read_ros_map(folder / "out" / "map.yaml"))
    return result


def _call(value: Input, folder: Path) -> Any:
    if value[0] == "slam" and "gmapping" in value and not any(word.startswith("particles=") for word in value):
        value = [*value, "--set", f"particles={FEW['gmapping']['particles']}"]
    return run_words(value, folder)


_CALL: Call = _call


def _warm() -> None:
    sys.argv = ["tagalong"]
    with tempfile.TemporaryDirectory() as folder:
        for command in ("slam", "localize", "perceive", "score"):
            run_words([command, "--help"], Path(folder))
        for preset in PRESETS:  # each has kernels of its own
            run_words(["perceive", "LOG", "--out", "OUT", "--preset", preset], Path(folder))


AREA = Area(
    (
        Border(
            name="options.slam", make=words_of("slam", ["LOG", "--out", "OUT", "--quiet"]), call=_CALL, sane=sane_end,
            ms=36.0,
        ),
        Border(name="options.slam_log", make=_log, call=_mapped, sane=sane_end, ms=78.0),
        Border(name="options.long_work", make=_never_taken, call=_refused_at_once, ms=14.0),
        Border(
            name="options.localize", make=words_of("localize", ["LOG", "--map", "MAP", "--out", "OUT", "--quiet"]),
            call=_CALL, sane=sane_end, ms=25.0,
        ),
        Border(
            name="options.perceive", make=words_of("perceive", ["LOG", "--out", "OUT"]), call=_CALL, sane=sane_end,
            ms=6.5,
        ),
        Border(name="options.score", make=words_of("score", ["TUM", "TUM2"]), call=_CALL, sane=sane_end, ms=5.2),
    ),
    _warm,
)  # fmt: skip
