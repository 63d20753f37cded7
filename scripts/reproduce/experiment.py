"""What an experiment of `tagalong reproduce` is, and which there are."""

import argparse
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from ...slam.errors import unknown_name
from ..lab.cells import Cell
from .report import Report

EXPERIMENTS: dict[str, str] = {
    "following": "mapping behind a leader, raw against filtered scans (Ye et al. 2021)",
    "scan-matching": "hybrid genetic scan matching, and what beats it (Cuzzocrea et al. 2022)",
    "clustering": "four ways to find landmarks in scans, and an extended Kalman filter on them (Urvina et al. 2023)",
    "immobile": "laser and RGB-D camera in one map of what never moves (Zhang et al. 2019)",
    "guidance": "following, joystick and exploration compared as guides (Ye et al. 2021, Table I)",
}
"""Name -> what it reproduces; the module `tagalong.scripts.reproduce.NAME` (`-` as `_`) holds its `EXPERIMENT`."""


@runtime_checkable
class Experiment(Protocol):
    """One published experiment, as cells and a report made of their results."""

    @property
    def name(self) -> str:
        """Its name on the command line."""
        ...

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Declare its own options, and an epilog with an example.

        There are already --out, --jobs, --backend, --quick and --data.
        """
        ...

    def cells(self, options: argparse.Namespace) -> Sequence[Cell]:
        """Return everything to be computed; `options.quick` asks for the same on fewer repeats.

        Raises:
            InputError: If an option is wrong.
        """
        ...

    def report(self, results: Mapping[str, Any], options: argparse.Namespace, folder: Path) -> Report:
        """Judge the results and draw the figures.

        Args:
            results: What the cells returned, by cell name.
            options: The options.
            folder: Where figures go, as PNG; `options.out / "cells"` holds what the cells kept.
        """
        ...


def load_experiment(name: str) -> Experiment:
    """Return the experiment called `name`.

    Raises:
        InputError: If there is none.
    """
    if name not in EXPERIMENTS:
        raise unknown_name("experiment", name, tuple(EXPERIMENTS))
    return import_module(f".{name.replace('-', '_')}", __package__).EXPERIMENT
