"""From the cells of `tagalong results` to the table in the README."""

from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np

from ...slam.errors import InputError
from ...slam.files.input import read_text
from ...slam.files.output import write_text
from ..lab.statistics import share, t_mean
from .acceptance import mean_of
from .people import summary as tracking_summary

BEGIN, END = "<!-- results:begin -->", "<!-- results:end -->"
SCENE_TITLES = {"corridor": "corridor", "meeting_room": "meeting room"}
PAPER_ADNN_CM = {
    ("corridor", "raw"): "paper: 80.24",
    ("corridor", "filtered"): "paper: 5.90",
    ("meeting_room", "raw"): "paper: in a plot only",
    ("meeting_room", "filtered"): "paper: 10.30",
}
"""By scene and scans: what Ye et al. 2021 (III.C) report for GMapping and 2 people."""
LOG_RIVALS = {"intel": "0.056 (0.043 by our scorer)", "belgioioso": "0.122", "aces": "0.95"}
GRAPH_RIVALS = {"intel": "LaMa: 0.038", "belgioioso": "GMapping: 0.122", "aces": "LaMa: 0.095"}

_MOST_BYTES = 1 << 24

Row = tuple[str, str, str, str]


def result_rows(results: Mapping[str, dict[str, Any]]) -> list[Row]:
    """Return (what, value with 95 % interval, others' figure, n) of everything that was measured."""
    rows: list[Row] = []
    for scene, title in SCENE_TITLES.items():
        rows += _following_rows(_group(results, f"following/{scene}/"), title)
        rows += _map_rows(results, scene, title)
        rows += _tracking_rows(_group(results, f"tracking/{scene}/"), title)
    for log in LOG_RIVALS:
        rival = f"original GMapping: {LOG_RIVALS[log]}"
        rows += _log_rows(_group(results, f"logs/{log}/"), f"{log.capitalize()} log, GMapping", rival)
        rival = f"best original, {GRAPH_RIVALS[log]}"
        rows += _log_rows(_group(results, f"graph/{log}/"), f"{log.capitalize()} log, graph SLAM", rival)
    return rows


def require_readme(readme: Path) -> str:
    """Return the text of a README that has a place for the table.

    Raises:
        InputError: If it cannot be read, or the marks are missing.
    """
    text = read_text(readme, _MOST_BYTES, f"a README has at most {_MOST_BYTES} bytes")
    if BEGIN not in text or END not in text:
        raise InputError(f"{readme}: needs the marks {BEGIN} and {END}")
    return text


def write_readme_table(readme: Path, rows: list[Row], machine: Mapping[str, Any], day: date) -> None:
    """Replace what stands between the two marks of the README.

    Raises:
        InputError: If there is no such README with the marks.
    """
    text = require_readme(readme)
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    note = (
        f"By `tagalong results` on {day.isoformat()}, {machine['processor']}, {machine['cores']} cores. Intervals are "
        "Student's over n runs (shares: Wilson's), each of them alone."
    )
    write_text(readme, f"{before}{BEGIN}\n{side_by_side(rows)}\n\n{note}\n{END}{after}")


def side_by_side(rows: Sequence[Row]) -> str:
    """Return the rows as two short tables of Markdown: scene beside scene, and engine beside engine for each log."""
    tables = [
        _folded(
            rows,
            tuple(SCENE_TITLES.values()),
            ("measured in simulation", *SCENE_TITLES.values(), "paper: corridor; meeting room"),
        ),
        _folded(
            [_turned(row) for row in rows if " log, " in row[0]],
            ("GMapping", "graph SLAM"),
            ("recorded log", "GMapping", "graph SLAM", "original programs"),
        ),
    ]
    return "\n\n".join(table for table in tables if table)


def _folded(rows: Sequence[Row], columns: tuple[str, ...], head: tuple[str, ...]) -> str:
    """Return a table with one row for all that is called "COLUMN: WHAT", by what was measured; "" if there is none."""
    found: dict[str, dict[str, Row]] = {}
    for row in rows:
        column, _, what = row[0].partition(": ")
        if column in columns:
            found.setdefault(what, {})[column] = row
    lines = [f"| {' | '.join((*head, 'n'))} |", "|---" * (len(head) + 1) + "|"]
    for what, parts in found.items():
        values = [parts[column][1] if column in parts else "" for column in columns]
        others = list(
            dict.fromkeys(
                parts[column][2].removeprefix("paper: ") for column in columns if column in parts and parts[column][2]
            )
        )
        counts = list(dict.fromkeys(parts[column][3] for column in columns if column in parts))
        lines.append(f"| {' | '.join((what, *values, '; '.join(others), ', '.join(counts)))} |")
    return "\n".join(lines) if found else ""


def _turned(row: Row) -> Row:
    """Return a row called "X log, ENGINE: WHAT" as "ENGINE: X, WHAT"."""
    title, _, what = row[0].partition(": ")
    log, _, engine = title.partition(" log, ")
    return f"{engine}: {log}, {what}", *row[1:]


def _group(results: Mapping[str, dict[str, Any]], prefix: str) -> list[dict[str, Any]]:
    return [result for name, result in results.items() if name.startswith(prefix)]


def _following_rows(tours: list[dict[str, Any]], title: str) -> list[Row]:
    if not tours:
        return []
    done = share([row["ending"] == "tour_done" for row in tours])
    choices, right = mean_of(tours, "leader_choices").sum(), mean_of(tours, "leader_choices_right").sum()
    error = t_mean(mean_of(tours, "distance_error_rms_m"), least=0.0)
    n = str(len(tours))
    return [
        (f"{title}: tours done without contact [%]", done.text(100, 1), "", n),
        (f"{title}: following distance error, RMS [m]", error.text(1, 3), "", n),
        (f"{title}: leader chosen right [%]", f"{100 * right / max(1.0, choices):.1f}", "", f"{choices:.0f}"),
    ]


def _map_rows(results: Mapping[str, dict[str, Any]], scene: str, title: str) -> list[Row]:
    rows: list[Row] = []
    maps, crowded = (_group(results, f"maps/{scene}/{standing}/") for standing in (0, 1))
    for name in ("raw", "filtered"):
        paper = PAPER_ADNN_CM[scene, name]
        if maps:
            adnn = t_mean(mean_of(maps, name, "adnn", "mean_m"), least=0.0)
            ate = t_mean(mean_of(maps, name, "ate_rmse_m"), least=0.0)
            rows.append((f"{title}: ADNN, {name} scans, 2 people [cm]", adnn.text(100), paper, str(len(maps))))
            rows.append((f"{title}: pose error (ATE), {name} scans [cm]", ate.text(100), "", str(len(maps))))
        if crowded:
            cells = t_mean(mean_of(crowded, name, "dynamic_residue", "cells"), least=0.0)
            what = f"{title}: cells left by people, one standing, {name} scans"
            rows.append((what, cells.text(1, 1), "", str(len(crowded))))
    return rows


def _tracking_rows(drives: list[dict[str, Any]], title: str) -> list[Row]:
    if not drives:
        return []
    figures = tracking_summary([_with_arrays(row) for row in drives])
    mota, n = t_mean(mean_of(drives, "mota"), most=1.0), str(len(drives))
    removed = 100 * figures["removed_tracked"], 100 * figures["removed_people"], 100 * figures["removed_static"]
    return [
        (f"{title}: MOTA of walking people, 4 people", mota.text(1, 3), "", n),
        (
            f"{title}: returns on people removed, tracked for 1 s (overall) [%]",
            f"{removed[0]:.1f} ({removed[1]:.1f})",
            "",
            n,
        ),
        (f"{title}: static returns removed [%]", f"{removed[2]:.2f}", "", n),
    ]


def _with_arrays(row: dict[str, Any]) -> dict[str, Any]:
    return {name: np.array(value) if isinstance(value, list) else value for name, value in row.items()}


def _log_rows(runs: list[dict[str, Any]], title: str, rival: str) -> list[Row]:
    if not runs:
        return []
    key, what = ("relation_m", "mean relation error") if "relation_m" in runs[0] else ("ate_rmse_m", "ATE rmse")
    error = t_mean(mean_of(runs, key), least=0.0)
    return [(f"{title}: {what} [m]", error.text(1, 3), rival, str(len(runs)))]
