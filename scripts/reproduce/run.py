"""Runs an experiment: its missing cells, then its report."""

import argparse
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Any

from ...slam.files.output import made_folder, write_json, write_text
from ..lab.cells import TIMING, run_cells, without_timing
from ..lab.hardware import describe_machine
from .experiment import Experiment
from .html import report_html
from .report import Report

VERSION = 1
"""Of the layout of results.json."""
_NOT_SETTINGS = ("command", "run", "experiment", "out", "jobs", "backend")


def run_experiment(experiment: Experiment, options: argparse.Namespace) -> Report:
    """Run the missing cells and write everything into `options.out`.

    Written: `cells/` (a JSON file a cell), `figures/` (PNG), `results.json`, `timing.json`, `report.html`.
    Two runs with the same options give the same `results.json` to the byte, however often they were interrupted;
    what depends on the clock is in `timing.json` and in the report.

    `results.json`: `version`, `experiment`, `settings` (the options), `machine`, `results` (what the report states)
    and `cells` (what every cell returned, by name).

    Args:
        experiment: The experiment.
        options: `out` (folder), `jobs`, `backend`, `quick`, `data` and the experiment's own.

    Raises:
        InputError: If an option is wrong, or nothing can be written into `out`.
    """
    out: Path = made_folder(options.out)
    cells = experiment.cells(options)
    results = run_cells(cells, out / "cells", jobs=options.jobs, label=experiment.name, backend=options.backend)
    figures = made_folder(out / "figures")
    report = experiment.report(results, options, figures)
    machine = describe_machine()
    content = {
        "version": VERSION,
        "experiment": experiment.name,
        "settings": _settings(options),
        "machine": machine,
        "results": without_timing(report.results),
        "cells": {name: without_timing(result) for name, result in results.items()},
    }
    write_json(out / "results.json", content)
    timing = {name: result[TIMING] for name, result in results.items() if TIMING in result}
    write_json(out / "timing.json", {"cells": timing, "results": _timing_of(report.results)})
    write_text(out / "report.html", report_html(report, machine, date.today().isoformat()))
    return report


def _settings(options: argparse.Namespace) -> dict[str, Any]:
    """Return the options that decide results, as words and numbers; of the data's folder only that there was one."""
    plain = {name: value for name, value in vars(options).items() if name not in _NOT_SETTINGS}
    return {**plain, "data": plain.get("data") is not None}


def _timing_of(value: Any) -> Any:
    """Return the parts of `value` that stand under the key `TIMING`, in their places."""
    if not isinstance(value, Mapping):
        return {}
    parts = {key: item if key == TIMING else _timing_of(item) for key, item in value.items()}
    return {key: item for key, item in parts.items() if item not in ({}, None)}
