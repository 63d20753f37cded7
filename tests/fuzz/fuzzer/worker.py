"""A child process that sends inputs through one door; what it is doing stands in memory that its parent sees."""

import contextlib
import faulthandler
import gc
import json
import mmap
import os
import resource
import sys
import time
import zlib
from pathlib import Path

import numpy as np
from fuzzer.border import Border, Input
from fuzzer.codec import encoded
from fuzzer.verdict import ACCEPTED, REFUSED, judge
from numpy.typing import NDArray

MEMORY_KB = 1 << 20
"""Memory above the idle process that an input may take [kB]."""
NUMBER, STARTED, SEEN, TAKEN, DECLINED, SLOWEST_S, SLOWEST, PEAK_KB, BEGAN_CPU = range(9)
"""Entries of a board: the input at hand and since when; inputs seen, accepted, refused; the slowest; most memory; the
processor's time when the input came."""


def new_board() -> NDArray[np.float64]:
    """Return numbers that parent and child share."""
    return np.frombuffer(mmap.mmap(-1, 9 * 8), dtype=np.float64)


def draws(border: Border, seed: int, number: int) -> np.random.Generator:
    """Return the source of input `number`: the same for the same border, seed and number, whatever ran before."""
    return np.random.default_rng([seed, zlib.crc32(border.name.encode()), number])


def forked(border: Border, inputs: "Inputs", board: NDArray[np.float64], folder: Path) -> tuple[int, int]:
    """Start a child that works through `inputs`; return its process id and the end of a pipe that tells findings."""
    reading, writing = os.pipe()
    gc.collect()
    gc.freeze()
    sys.stdout.flush()
    child = os.fork()
    if child:
        os.close(writing)
        return child, reading
    status = 1
    try:
        os.close(reading)
        _silenced(folder)
        _work(border, inputs, board, folder, writing)
        status = 0
    finally:
        os._exit(status)
    raise AssertionError("a child ends above")


class Inputs:
    """Inputs by number: made from a seed, or given.

    Args:
        seed: Of the draws.
        numbers: Which ones.
        given: Inputs themselves; then `numbers` count them.
    """

    def __init__(self, seed: int, numbers: range, given: list[Input] | None = None) -> None:
        self.seed, self.numbers, self._given = seed, numbers, given

    def of(self, border: Border, number: int) -> Input:
        """Return input `number`."""
        return border.make(draws(border, self.seed, number)) if self._given is None else self._given[number]

    def after(self, number: int) -> "Inputs":
        """Return those that come after input `number`."""
        return Inputs(self.seed, range(number + 1, self.numbers.stop), self._given)


def _silenced(folder: Path) -> None:
    """Send what the child prints nowhere, and what it says when it crashes to a file."""
    os.setpgid(0, 0)
    nowhere, said = os.open(os.devnull, os.O_RDWR), os.open(folder / "stderr", os.O_CREAT | os.O_TRUNC | os.O_WRONLY)
    for stream, file in ((0, nowhere), (1, nowhere), (2, said)):
        os.dup2(file, stream)
    faulthandler.enable()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _work(border: Border, inputs: Inputs, board: NDArray[np.float64], folder: Path, pipe: int) -> None:
    _limit_memory(border.reserved_mb << 10)
    idle_kb = resident_kb(os.getpid())
    for number in inputs.numbers:
        board[STARTED], board[BEGAN_CPU], board[NUMBER] = time.monotonic(), time.process_time(), number
        value = inputs.of(border, number)
        began = time.monotonic()
        board[STARTED], board[BEGAN_CPU] = began, time.process_time()
        verdict = judge(border, value, folder)
        took, over_kb = time.monotonic() - began, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - idle_kb
        board[SEEN] += 1
        board[TAKEN] += verdict.kind == ACCEPTED
        board[DECLINED] += verdict.kind == REFUSED
        if took > board[SLOWEST_S]:
            board[SLOWEST_S], board[SLOWEST] = took, number
        board[PEAK_KB] = max(board[PEAK_KB], over_kb)
        if verdict.is_finding:
            _tell(pipe, {"number": number, "kind": verdict.kind, "told": verdict.told, "input": encoded(value)})
        if over_kb > MEMORY_KB:  # the most that was held is never forgotten: a new child goes on
            _tell(pipe, {"number": number, "kind": "memory", "told": f"{over_kb / 1024:.0f} MB above the idle process"})
            return
        if over_kb > MEMORY_KB // 4:  # so that the next input is not blamed
            return


def _limit_memory(reserved_kb: int) -> None:
    held_kb = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize() // 1024
    most = (held_kb + MEMORY_KB + reserved_kb) * 1024
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (most, most))


def resident_kb(process: int) -> int:
    """Return the memory that a process holds [kB], 0 if it has ended."""
    try:
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * resource.getpagesize() // 1024
    except (OSError, IndexError):
        return 0


def processor_s(process: int) -> float:
    """Return the processor time that a process has used [s], 0 if it has ended."""
    try:
        fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _tell(pipe: int, finding: dict[str, object]) -> None:
    data = (json.dumps(finding) + "\n").encode()
    while data:
        data = data[os.write(pipe, data) :]
