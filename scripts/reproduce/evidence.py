"""All experiments one after the other, and a page for each: what is published as evidence."""

import argparse
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date

from ...slam.files.output import write_text
from ..console.tables import format_table
from ..lab.cells import Cell
from ..lab.hardware import describe_machine
from .experiment import EXPERIMENTS, Experiment, load_experiment
from .page import plain, write_page
from .run import run_experiment

_INDEX = """\
# Evidence

Each page repeats a published experiment and sets our figures beside the paper's, verdict by verdict. They are made by
`{command}`, from cells that are stored as they are done.

| experiment | what it reproduces | core hours |
| :--- | :--- | ---: |
{rows}
"""


@dataclass(frozen=True)
class _Plan:
    """What is to be done for one experiment, and what it costs."""

    experiment: Experiment
    options: argparse.Namespace
    cells: tuple[Cell, ...]

    def costs(self) -> dict[str, float]:
        """Return the processor time of each finished cell, by name [s]."""
        known = {cell.name: cell.cost_s(self.options.out / "cells") for cell in self.cells}
        return {name: cost for name, cost in known.items() if cost is not None}

    def remaining_h(self) -> float | None:
        """Return the core hours still to come, by finished cells of the same kind; None where none is finished."""
        costs, total = self.costs(), 0.0
        for cell in self.cells:
            if cell.name not in costs:
                alike = [cost for name, cost in costs.items() if _kind(name) == _kind(cell.name)] or [*costs.values()]
                if not alike:
                    return None
                total += sum(alike) / len(alike)
        return total / 3600.0


def _kind(name: str) -> str:
    return name.split("/")[0]


def run_all(options: argparse.Namespace, names: tuple[str, ...] = tuple(EXPERIMENTS)) -> None:
    """Run what is missing of all experiments, in `options.out / NAME`; write a page for each, and an index.

    Says beforehand how many cells are missing, and the core hours that they will take as far as finished cells of the
    same kind tell.

    Args:
        options: `out`, `pages` (folder of the pages; None: `out` / "pages"), `jobs`, `backend`, `quick` and `data`.
        names: Which experiments.
    """
    plans = {name: _plan(name, options) for name in names}
    print(_foretold(plans), file=sys.stderr, flush=True)
    pages = options.pages or options.out / "pages"
    command, rows = f"tagalong reproduce all{' --quick' * options.quick} --out DIR", []
    for name, plan in plans.items():
        report, hours = run_experiment(plan.experiment, plan.options), sum(plan.costs().values()) / 3600.0
        made = f"Made by `tagalong reproduce {name}{' --quick' * options.quick}`: {hours:.2f} core hours."
        write_page(pages / f"{name}.md", report, describe_machine(), date.today().isoformat(), made)
        rows.append(f"| [{name}]({name}.md) | {plain(EXPERIMENTS[name])} | {hours:.2f} |")
        write_text(pages / "index.md", _INDEX.format(command=command, rows="\n".join(rows)))
        print(f"wrote {pages / name}.md")


def _plan(name: str, options: argparse.Namespace) -> _Plan:
    """Return an experiment with its own options as they are when nothing is said."""
    experiment, parser = load_experiment(name), argparse.ArgumentParser()
    experiment.add_arguments(parser)
    shared = {key: getattr(options, key) for key in ("jobs", "backend", "quick", "data")}
    own = argparse.Namespace(**{**vars(parser.parse_args([])), **shared, "out": options.out / name})
    return _Plan(experiment, own, tuple(experiment.cells(own)))


def _foretold(plans: Mapping[str, _Plan]) -> str:
    rows = []
    for name, plan in plans.items():
        missing, hours = len(plan.cells) - len(plan.costs()), plan.remaining_h()
        rows.append((name, str(len(plan.cells)), str(missing), "not known yet" if hours is None else f"{hours:.2f}"))
    return format_table(("experiment", "cells", "missing", "core hours to come"), rows)
