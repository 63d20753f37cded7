"""Resumable cells: independent pieces of an experiment, each with a result file of its own.

A cell that has its file is not run again, so an experiment killed at any moment continues where it was and loses at
most the cells that were running. A file that was made with other arguments is made anew, and so is what needs it. One
that was made by other code stays, for code changes often and results seldom: how many there are is said on stderr.
"""

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any

from tqdm import tqdm

from ...slam.errors import InputError
from ...slam.files.output import made_folder, read_json, write_json
from .backends import runner
from .hardware import code_fingerprint

_MOST_RESULT = 1 << 26  # bytes of a result file; arrays belong into files beside it
TIMING = "timing"
"""The key of a result, at any depth, under which stands what depends on the clock; nothing else may."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One piece of an experiment.

    Attributes:
        name: Its name, unique in the experiment, a relative path without suffix ("following/corridor/seed-3").
        function: A module-level function that returns a dict that JSON can hold.
        arguments: Its keyword arguments; numbers, strings, lists and None only.
        keeps_files: The function takes `files`, too: a folder of its own for what JSON cannot hold.
        needs: Names of cells that come first; the function takes `inputs`, too: their folders of files, in this order.
    """

    name: str
    function: Callable[..., Mapping[str, Any]]
    arguments: Mapping[str, Any]
    keeps_files: bool = False
    needs: tuple[str, ...] = ()

    def stored(self, folder: Path) -> dict[str, Any] | None:
        """Return the result in `folder`, or None where there is none for these arguments, or its files are gone."""
        return self._content(folder).get("result")

    def code(self, folder: Path) -> str | None:
        """Return the fingerprint of the code that made the result in `folder`, or None where there is none."""
        return self._content(folder).get("code")

    def cost_s(self, folder: Path) -> float | None:
        """Return the processor time that the result in `folder` took [s], or None where there is none."""
        try:
            content = read_json(self._cost_path(folder))
        except InputError:
            return None
        return float(content[TIMING]["processor_s"]) if self._content(folder) else None

    def run(self, folder: Path) -> dict[str, Any]:
        """Compute the result, store it in `folder` and return it as it was stored."""
        more: dict[str, Any] = {}
        if self.keeps_files:
            more["files"] = made_folder(files_of(self.name, folder))
        if self.needs:
            more["inputs"] = [files_of(name, folder) for name in self.needs]
        began = process_time()
        result = dict(self.function(**self.arguments, **more))
        write_json(self._cost_path(folder), {TIMING: {"processor_s": process_time() - began}})
        content = {"arguments": self._plain_arguments, "code": code_fingerprint(), "result": result}
        write_json(self._path(folder), content)
        stored = self.stored(folder)
        assert stored is not None
        return stored

    def _cost_path(self, folder: Path) -> Path:
        """Return where stands what it cost: beside the results, which are the same bytes whenever they are made."""
        return folder / "costs" / f"{self.name}.json"

    def _path(self, folder: Path) -> Path:
        return folder / f"{self.name}.json"

    def _content(self, folder: Path) -> dict[str, Any]:
        """Return what the file holds; nothing where it is of no use."""
        if self.keeps_files and not files_of(self.name, folder).is_dir():
            return {}
        try:
            content = read_json(self._path(folder), _MOST_RESULT)
        except InputError:
            return {}
        usable = isinstance(content, dict) and content.get("arguments") == self._plain_arguments
        return content if usable else {}

    @property
    def _plain_arguments(self) -> dict[str, Any]:
        return json.loads(json.dumps(dict(self.arguments)))


def files_of(name: str, folder: Path) -> Path:
    """Return the folder of what the cell `name` keeps beside its result in `folder`."""
    return folder / f"{name}.files"


def run_cells(
    cells: Sequence[Cell], folder: str | Path, *, jobs: int = 1, label: str = "cells", backend: str = "local"
) -> dict[str, Any]:
    """Run the cells that have no result in `folder` yet and return all results by name, in the order of `cells`.

    Args:
        cells: What to run; their order decides nothing but the order of the answer. A cell that others need stands
            before them.
        folder: Where the result files are.
        jobs: How many processes.
        label: Name beside the progress bar.
        backend: Who runs the processes: "local" (this machine), "ray" or "dask" (a cluster that shares `folder`).

    Raises:
        InputError: If there is no such backend, or more `jobs` than this machine has use for.
        MissingExtraError: If its package is not installed.
        WorkerError: If a process is lost; the finished cells have their files.
    """
    target = Path(folder)
    results: dict[str, Any] = {}
    for cell in cells:
        whole = all(results.get(name, True) is not None for name in cell.needs)
        results[cell.name] = cell.stored(target) if whole else None
    missing = [cell for cell in cells if results[cell.name] is None]
    _warn_of_other_code([cell for cell in cells if results[cell.name] is not None], target)
    with (
        runner(backend, jobs) as run,
        tqdm(total=len(cells), initial=len(cells) - len(missing), desc=label, unit="cell") as progress,
    ):
        for wave in _waves(missing):
            for name, result in run(_run_cell, [(cell, target) for cell in wave]):
                results[name] = result
                progress.update()
    return results


def _warn_of_other_code(finished: Sequence[Cell], folder: Path) -> None:
    """Say on stderr how many of the finished cells were not made by the code that runs now."""
    other = sum(cell.code(folder) != code_fingerprint() for cell in finished)
    if other:
        said = f"{other} of {len(finished)} finished cells in {folder} were made by other code than this"
        print(f"tagalong: {said}; remove them to make them anew", file=sys.stderr)


def _waves(cells: Sequence[Cell]) -> list[list[Cell]]:
    """Return the cells in groups; each needs only cells of groups before it, or none of `cells`."""
    depth: dict[str, int] = {}
    for cell in cells:
        depth[cell.name] = 1 + max((depth.get(name, -1) for name in cell.needs), default=-1)
    return [
        [cell for cell in cells if depth[cell.name] == level] for level in range(max(depth.values(), default=-1) + 1)
    ]


def without_timing(value: Any) -> Any:
    """Return `value` (dicts, lists, plain things) without everything that stands under the key `TIMING`."""
    if isinstance(value, Mapping):
        return {key: without_timing(item) for key, item in value.items() if key != TIMING}
    if isinstance(value, (list, tuple)):
        return [without_timing(item) for item in value]
    return value


def _run_cell(cell: Cell, folder: Path) -> tuple[str, dict[str, Any]]:
    return cell.name, cell.run(folder)
