"""A cell in a process of its own, whose memory is then the cell's alone."""

from pathlib import Path
from typing import Any

from ...slam.processes.crew import Crew
from .cells import Cell
from .hardware import code_fingerprint


def run_alone(cell: Cell, folder: Path) -> dict[str, Any]:
    """Return the cell's result in `folder`; computed now, in a new process, where this code has not made it yet.

    Raises:
        WorkerError: If that process is lost.
    """
    stored = cell.stored(folder)
    if stored is not None and cell.code(folder) == code_fingerprint():
        return stored
    with Crew(1) as crew:
        ((_, result),) = crew.results(_run, [(cell, folder)])
    return result


def _run(cell: Cell, folder: Path) -> dict[str, Any]:
    return cell.run(folder)
