"""The table and the report of the robustness bench."""

from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...slam.files.output import made_folder, write_text
from ...slam.logs.faults import FAULTS
from ..console.tables import format_table
from ..figures.plots import new_figure, save_figure
from ..lab.cells import TIMING
from ..lab.hardware import describe_machine
from ..reproduce.html import report_html
from ..reproduce.report import Figure, Report, Section, Table
from .fault_verdicts import GRAPH, RIVAL, WITHOUT, FaultVerdict, FaultyCell

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

COLUMNS = (
    "drive, fault", "engine", "error [m]", "[deg]", "x undisturbed", "online [m]", "located", "off > 1 m", "told",
    "told wrongly", "processor s", "MB",
)  # fmt: skip
_DECADES = (-2.0, 1.0)  # of the colours: 1 cm to 10 m
_TITLES = {GRAPH: "Graph SLAM", RIVAL: "GMapping", WITHOUT: "Graph SLAM without recovery"}


def write_report(
    out: Path, rows: Sequence[FaultyCell], judged: Sequence[FaultVerdict], truths: Mapping[str, Mapping[str, Any]]
) -> str:
    """Write report.html, which needs nothing else, into `out`; return table and verdicts as text.

    Args:
        out: The folder.
        rows: All cells.
        judged: The verdicts on them.
        truths: What `slam_faults.truth_of` found of the logs that have relations only, by name.
    """
    pictures = made_folder(out / "figures")
    engines = list(dict.fromkeys(row.engine for row in rows))
    figures = [
        Figure(
            file=_error_picture(pictures / f"errors-{k}.png", [row for row in rows if row.engine == engine]),
            caption=f"{_TITLES.get(engine, engine)}: error of each drive with each fault [m].",
        )
        for k, engine in enumerate(engines)
    ]
    words = [cell_words(row) for row in rows]
    report = Report(
        title="SLAM on drives that something is wrong with",
        lead=" ".join(f"{'Holds' if v.holds else 'MISSED'}: {v.asks} ({v.found})." for v in judged),
        sections=(
            Section(title="What is asked for", tables=[_verdict_table(judged), *_missed_tables(judged)]),
            Section(title="Errors", figures=figures),
            Section(
                title="Faults",
                tables=[Table(title="", columns=("name", "what"), rows=[(n, f.says) for n, f in FAULTS.items()])],
            ),
            Section(title="Where the robot was", tables=[_truth_table(truths)] if truths else []),
            Section(title="Every cell", tables=[Table(title="", columns=COLUMNS, rows=words, note=_NOTE)]),
        ),
    )
    write_text(out / "report.html", report_html(report, describe_machine(), date.today().isoformat()))
    return f"{format_table(COLUMNS, words)}\n\n{verdict_text(judged)}"


_NOTE = (
    "Error: mean error of the relations where they are known, else ATE rmse after the best rigid motion. Off: share of "
    "the scans whose online pose is more than 1 m from the truth, laid on it with the least sum of distances. Told: in "
    "how many of the stretches of at least 50 scans that are off the engine said that it is not located. Told wrongly: "
    "share of the scans in which it said so though it was right."
)


def cell_words(row: FaultyCell) -> tuple[str, ...]:
    """Return a row of the table."""
    if row.failed is not None:
        return (row.name, row.engine, row.failed, *([""] * (len(COLUMNS) - 3)))
    result = row.result
    timing = result[TIMING]
    times = row.error / max(row.plain, 1e-4)  # a millimetre's tenth: of a made-up case without any error
    told = f"{result['told']} of {result['stretches']}" if result["stretches"] else ""
    return (
        row.name, row.engine, f"{row.error:.3f}", f"{result['error']['deg']:.2f}", f"{times:.1f}",
        f"{result['online']['m']:.3f}", f"{result['located']:.1%}", f"{result['off']:.1%}", told,
        f"{result['wrongly_told']:.1%}", f"{timing['processor_s']:.1f}", f"{timing['memory_mb']:.0f}",
    )  # fmt: skip


def verdict_text(judged: Sequence[FaultVerdict]) -> str:
    """Return the verdicts as text, each with the cells that miss it."""
    lines = []
    for verdict in judged:
        lines.append(f"{'holds ' if verdict.holds else 'MISSED'}  {verdict.asks}: {verdict.found}")
        lines += [f"          {cell}" for cell in verdict.missed]
    return "\n".join(lines)


def _verdict_table(judged: Sequence[FaultVerdict]) -> Table:
    rows = [(v.asks, "holds" if v.holds else "MISSED", v.found) for v in judged]
    return Table(title="Verdicts", columns=("asked for", "", "found"), rows=rows)


def _truth_table(truths: Mapping[str, Mapping[str, Any]]) -> Table:
    rows = [
        (name, *(f"{found[path][unit]:.3f}" for path in ("truth", "gmapping") for unit in ("m", "deg")))
        for name, found in truths.items()
    ]
    columns = ("log", "path by which poses are off [m]", "[deg]", "GMapping [m]", "[deg]")
    note = (
        "Mean relation error. Where a log has relations only, GMapping's path, pulled into place by them, says where "
        "the robot was; it serves to tell whether poses are 1 m off, not to tell errors."
    )
    return Table(title="", columns=columns, rows=rows, note=note)


def _missed_tables(judged: Sequence[FaultVerdict]) -> list[Table]:
    return [
        Table(title=v.asks, columns=("missed by",), rows=[(cell,) for cell in v.missed]) for v in judged if v.missed
    ]


def _error_picture(path: Path, rows: Sequence[FaultyCell]) -> Path:
    """Draw the errors of one engine as a table of colours, drives below each other and faults beside each other."""
    drives, faults = (list(dict.fromkeys(getattr(row, name) for row in rows)) for name in ("drive", "fault"))
    errors = np.full((len(drives), len(faults)), np.nan)
    for row in rows:
        errors[drives.index(row.drive), faults.index(row.fault)] = min(row.error, 1e3)
    figure = new_figure(2.5 + 0.42 * len(faults), 2.2 + 0.3 * len(drives))
    axes = figure.subplots()
    shown = axes.imshow(np.log10(np.maximum(errors, 1e-4)), cmap="RdYlGn_r", vmin=_DECADES[0], vmax=_DECADES[1])
    axes.set_xticks(range(len(faults)), faults, rotation=90)
    axes.set_yticks(range(len(drives)), drives)
    _write_values(axes, errors)
    ticks = np.arange(_DECADES[0], _DECADES[1] + 1.0)
    bar = figure.colorbar(shown, ax=axes, ticks=ticks, label="error [m]", shrink=0.8)
    bar.ax.set_yticklabels([f"{10.0**tick:g}" for tick in ticks])
    return save_figure(path, figure)


def _write_values(axes: "Axes", errors: Array) -> None:
    for row, column in np.argwhere(np.isfinite(errors)).tolist():
        value = errors[row, column]
        words = "fail" if value >= 1e3 else f"{value:.2f}" if value < 10.0 else f"{value:.0f}"
        axes.text(column, row, words, ha="center", va="center", fontsize=6)
