"""A cell in a process of its own, whose memory is then the cell's alone."""

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import connection, get_context, parent_process
from pathlib import Path
from threading import Thread
from typing import Any

from .cells import Cell
from .hardware import code_fingerprint


def run_alone(cell: Cell, folder: Path) -> dict[str, Any]:
    """Return the cell's result in `folder`; computed now, in a new process, where this code has not made it yet."""
    stored = cell.stored(folder)
    if stored is not None and cell.code(folder) == code_fingerprint():
        return stored
    with ProcessPoolExecutor(1, mp_context=get_context("spawn"), initializer=_end_with_parent) as process:
        return process.submit(cell.run, folder).result()


def _end_with_parent() -> None:
    """Let this process end as soon as the one that started it does, however that ends."""
    parent = parent_process()
    assert parent is not None

    def wait() -> None:
        connection.wait([parent.sentinel])
        sys.stderr.flush()
        os._exit(1)

    Thread(target=wait, daemon=True).start()
