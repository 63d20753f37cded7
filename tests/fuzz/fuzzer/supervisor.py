"""Watches the children that send inputs: a crash, a hang or a swallowed memory names the very input."""

import json
import os
import select
import signal
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from fuzzer.border import Border
from fuzzer.codec import encoded
from fuzzer.worker import (
    BEGAN_CPU,
    DECLINED,
    MEMORY_KB,
    NUMBER,
    PEAK_KB,
    SEEN,
    SLOWEST,
    SLOWEST_S,
    STARTED,
    TAKEN,
    Inputs,
    forked,
    new_board,
    processor_s,
    resident_kb,
)
from numpy.typing import NDArray

HANG_S = 10.0
"""An input hangs that works longer, or waits longer and does not work at all [s]."""
_BUSY_S = 120.0  # ... or is not done after so long on a machine that has no time for it
_IDLE = 0.05  # share of the time: who works less only waits
_LOOK_S = 0.05
_MOST_LOST = 12  # children of one border that crash, hang or swallow memory, before it is given up


@dataclass
class Tally:
    """What became of the inputs of one border.

    Attributes:
        border: Its name.
        inputs: How many were sent.
        accepted: How many gave a sane result.
        refused: How many were refused in one line.
        findings: What happened to the others: number, kind, what was told, the input.
        slowest_s: The longest time of one [s].
        slowest: Its number.
        peak_mb: The most memory above the idle process [MB].
        given_up: Whether it was left because too many children were lost.
        seconds: How long it all took [s].
    """

    border: str
    inputs: int = 0
    accepted: int = 0
    refused: int = 0
    findings: list[dict[str, Any]] = field(default_factory=list)
    slowest_s: float = 0.0
    slowest: int = 0
    peak_mb: float = 0.0
    given_up: bool = False
    seconds: float = 0.0


def sent(border: Border, inputs: Inputs, folder: Path) -> Tally:
    """Send inputs through one door, in as many children as it takes."""
    tally, lost, began = Tally(border.name), 0, time.monotonic()
    while len(inputs.numbers):
        board = new_board()
        board[NUMBER] = inputs.numbers.start
        kind, told, findings = _watched(border, inputs, board, folder)
        number = int(board[NUMBER])
        tally.findings += findings
        if kind:
            lost += 1
            value = encoded(inputs.of(border, number))
            tally.findings.append({"number": number, "kind": kind, "told": told, "input": value})
        _add(tally, board, lost_one=bool(kind))
        if lost > _MOST_LOST:
            tally.given_up = True
            break
        inputs = inputs.after(number)
    for finding in tally.findings:  # memory that was noticed after the verdict is told without the input
        finding.setdefault("input", encoded(inputs.of(border, finding["number"])))
    tally.seconds = time.monotonic() - began
    return tally


def _watched(
    border: Border, inputs: Inputs, board: NDArray[np.float64], folder: Path
) -> tuple[str, str, list[dict[str, Any]]]:
    """Return how a child was lost ("" if it ended well), what is known of it, and the findings that it told."""
    folder.mkdir(parents=True, exist_ok=True)
    board[STARTED] = time.monotonic()
    child, pipe = forked(border, inputs, board, folder)
    idle_kb, text, kind = resident_kb(os.getpid()), b"", ""
    while True:
        ready, _, _ = select.select([pipe], [], [], _LOOK_S)
        chunk = os.read(pipe, 1 << 20) if ready else None
        if chunk == b"":
            break
        text += chunk or b""
        if _hangs(child, board):
            kind = "hang"
        elif resident_kb(child) - idle_kb > MEMORY_KB:
            kind = "memory"
        if kind:
            with suppress(ProcessLookupError):
                os.killpg(child, signal.SIGKILL)
            break
    os.close(pipe)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    said = ""
    if not kind and status != 0:
        kind, said = "crash", f"{_name(status)}; {_last_words(folder)}"
    elif kind:
        said = f"after {time.monotonic() - board[STARTED]:.1f} s, {resident_kb(child)} kB"
    return kind, said, [json.loads(line) for line in text.split(b"\n")[:-1]]


def _hangs(child: int, board: NDArray[np.float64]) -> bool:
    """Return whether the input at hand hangs; on a busy machine, work takes longer than it should."""
    waited_s = time.monotonic() - board[STARTED]
    if waited_s <= HANG_S:
        return False
    worked_s = processor_s(child) - board[BEGAN_CPU]
    return worked_s > HANG_S or worked_s < _IDLE * waited_s or waited_s > _BUSY_S


def _last_words(folder: Path) -> str:
    """Return what Python said when the child died: the innermost calls."""
    file = folder / "stderr"
    lines = file.read_text(errors="replace").splitlines() if file.exists() else []
    calls = [line.strip() for line in lines if line.lstrip().startswith("File ")]
    return "; ".join(calls[:5]) or " ".join(lines)[:400]


def _name(status: int) -> str:
    return signal.Signals(-status).name if status < 0 else f"exit status {status}"


def _add(tally: Tally, board: NDArray[np.float64], lost_one: bool) -> None:
    tally.inputs += int(board[SEEN]) + lost_one
    tally.accepted += int(board[TAKEN])
    tally.refused += int(board[DECLINED])
    tally.peak_mb = max(tally.peak_mb, float(board[PEAK_KB]) / 1024.0)
    if board[SLOWEST_S] > tally.slowest_s:
        tally.slowest_s, tally.slowest = float(board[SLOWEST_S]), int(board[SLOWEST])
