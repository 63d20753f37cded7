"""Resumable cells: independent pieces of an experiment, each with a result file of its own.

A cell that has its file is not run again, so an experiment killed at any moment continues where it was and loses at
most the cells that were running. A file that was made with other arguments is made anew.
"""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import joblib
from tqdm import tqdm

from ...slam.files import write_json
from .backends import parallel_backend

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
    """

    name: str
    function: Callable[..., Mapping[str, Any]]
    arguments: Mapping[str, Any]
    keeps_files: bool = False

    def stored(self, folder: Path) -> dict[str, Any] | None:
        """Return the result in `folder`, or None where there is none for these arguments."""
        path = self._path(folder)
        if not path.exists():
            return None
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except json.JSONDecodeError:
            return None
        return content["result"] if content.get("arguments") == self._plain_arguments else None

    def run(self, folder: Path) -> dict[str, Any]:
        """Compute the result, store it in `folder` and return it as it was stored."""
        more = {}
        if self.keeps_files:
            more["files"] = self.files(folder)
            more["files"].mkdir(parents=True, exist_ok=True)
        result = dict(self.function(**self.arguments, **more))
        write_json(self._path(folder), {"arguments": self._plain_arguments, "result": result})
        stored = self.stored(folder)
        assert stored is not None
        return stored

    def files(self, folder: Path) -> Path:
        """Return the folder of what this cell keeps beside its result."""
        return folder / f"{self.name}.files"

    def _path(self, folder: Path) -> Path:
        return folder / f"{self.name}.json"

    @property
    def _plain_arguments(self) -> dict[str, Any]:
        return json.loads(json.dumps(dict(self.arguments)))


def run_cells(
    cells: Sequence[Cell], folder: str | Path, *, jobs: int = 1, label: str = "cells", backend: str = "loky"
) -> dict[str, Any]:
    """Run the cells that have no result in `folder` yet and return all results by name, in the order of `cells`.

    Args:
        cells: What to run; their order decides nothing but the order of the answer.
        folder: Where the result files are.
        jobs: How many processes.
        label: Name beside the progress bar.
        backend: Who runs the processes: "loky" (this machine), "ray" or "dask" (a cluster that shares `folder`).

    Raises:
        InputError: If there is no such backend.
        MissingExtraError: If its package is not installed.
    """
    target = Path(folder)
    results = {cell.name: cell.stored(target) for cell in cells}
    missing = [cell for cell in cells if results[cell.name] is None]
    tasks = (joblib.delayed(_run_cell)(cell, target) for cell in missing)
    with parallel_backend(backend, jobs):
        done = cast(Iterable[Any], joblib.Parallel(n_jobs=jobs, return_as="generator_unordered")(tasks))
        for name, result in tqdm(done, total=len(cells), initial=len(cells) - len(missing), desc=label, unit="cell"):
            results[name] = result
    return results


def without_timing(value: Any) -> Any:
    """Return `value` (dicts, lists, plain things) without everything that stands under the key `TIMING`."""
    if isinstance(value, Mapping):
        return {key: without_timing(item) for key, item in value.items() if key != TIMING}
    if isinstance(value, (list, tuple)):
        return [without_timing(item) for item in value]
    return value


def _run_cell(cell: Cell, folder: Path) -> tuple[str, dict[str, Any]]:
    return cell.name, cell.run(folder)
