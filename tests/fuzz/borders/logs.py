"""Recorded drives as text."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from fuzzer import grammars
from fuzzer.border import Area, Border, Input
from fuzzer.files import put
from fuzzer.mutations import mutated_bytes, mutated_text
from fuzzer.sanity import sane_drive
from numpy.random import Generator
from tagalong.slam import read_log

NAME = "drive.log"
_BOMBS = (b"\n", b"# comment\n", b"1 ", b"FLASER 1 1 0 0 0 0 0 0 0 h 0\n", b"\x00", b"L 1 ", b"Odometry 0 0 0\n")


def hostile(grammar: Callable[[Generator], bytes]) -> Callable[[Generator], bytes]:
    """Return the source of texts of a format: nine of ten are mutated."""

    def make(rng: Generator) -> bytes:
        text = grammar(rng)
        draw = rng.random()
        return text if draw < 0.1 else mutated_bytes(rng, text) if draw < 0.2 else mutated_text(rng, text)

    return make


def read(value: Input, folder: Path) -> Any:
    """Read a drive as the commands do."""
    return read_log(put(folder, NAME, value))


def _mixed(rng: Generator) -> bytes:
    """Return lines of one format in a log of another."""
    texts = [grammar(rng) for grammar in (grammars.carmen, grammars.beesoft, grammars.dpslam, grammars.tinyslam)]
    one, other = (texts[int(k)].split(b"\n") for k in rng.integers(0, 4, 2))
    cut = int(rng.integers(len(one) + 1))
    return mutated_text(rng, b"\n".join([*one[:cut], *other]))


def _bomb(rng: Generator) -> Input:
    return {"bomb": _BOMBS[int(rng.integers(len(_BOMBS)))], "megabytes": int(rng.integers(1200, 3000))}


AREA = Area(
    (
        Border(name="logs.carmen", make=hostile(grammars.carmen), call=read, sane=sane_drive, file=NAME, ms=1.0),
        Border(name="logs.beesoft", make=hostile(grammars.beesoft), call=read, sane=sane_drive, file=NAME, ms=1.2),
        Border(name="logs.dpslam", make=hostile(grammars.dpslam), call=read, sane=sane_drive, file=NAME, ms=0.75),
        Border(name="logs.tinyslam", make=hostile(grammars.tinyslam), call=read, sane=sane_drive, file=NAME, ms=2.5),
        Border(name="logs.mixed", make=_mixed, call=read, sane=sane_drive, file=NAME, ms=2.8),
        Border(name="logs.gzip_bomb", make=_bomb, call=read, sane=sane_drive, file=NAME, ms=860.0),
    )
)
