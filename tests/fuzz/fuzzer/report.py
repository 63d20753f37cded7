"""Tables of what became of the inputs, for the screen and for the documentation; findings as files."""

import json
import re
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from fuzzer.codec import decoded, write_finding
from fuzzer.supervisor import Tally

HEADER = ("border", "inputs", "accepted", "refused", "findings", "slowest [ms]", "peak [MB]")
_BEGIN, _END = "<!-- fuzz table: begin -->", "<!-- fuzz table: end -->"
_FILES_A_KIND = 3


def rows(tallies: Iterable[Tally]) -> list[tuple[str, ...]]:
    """Return a row for each border, and the sums."""
    tallies = list(tallies)
    table = [
        (
            t.border + (" (given up)" if t.given_up else ""),
            f"{t.inputs:,}", f"{t.accepted:,}", f"{t.refused:,}", f"{len(t.findings):,}",
            f"{1e3 * t.slowest_s:.0f}", f"{t.peak_mb:.0f}",
        )
        for t in tallies
    ]  # fmt: skip
    sums = (sum(t.inputs for t in tallies), sum(t.accepted for t in tallies), sum(t.refused for t in tallies))
    found = sum(len(t.findings) for t in tallies)
    slowest, peak = max(t.slowest_s for t in tallies), max(t.peak_mb for t in tallies)
    return [*table, ("all", *(f"{n:,}" for n in (*sums, found)), f"{1e3 * slowest:.0f}", f"{peak:.0f}")]


def printed(table: list[tuple[str, ...]]) -> str:
    """Return the table with columns of even width."""
    lines = [HEADER, *table]
    widths = [max(len(line[i]) for line in lines) for i in range(len(HEADER))]
    return "\n".join(
        "  ".join([line[0].ljust(widths[0]), *(w.rjust(n) for w, n in zip(line[1:], widths[1:], strict=True))])
        for line in lines
    )


def put_table(path: Path, table: list[tuple[str, ...]], command: str) -> None:
    """Replace the table of a documentation page, between its marks, and say which command made it."""
    lines = ["| " + " | ".join(line) + " |" for line in (HEADER, ("---", *["---:"] * (len(HEADER) - 1)), *table)]
    text = "\n".join([_BEGIN, f"Made by `{command}`:", "", *lines, _END])
    page = path.read_text()
    before, _, rest = page.partition(_BEGIN)
    path.write_text(before + text + rest.partition(_END)[2])


def kinds_of(tally: Tally) -> dict[tuple[str, str], list[dict[str, Any]]]:
    """Return the findings of a border by kind and by what was told, numbers left out."""
    groups: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for finding in tally.findings:
        place = re.findall(r"\[.*\]$", finding["told"]) if finding["kind"] in ("traceback", "memory") else []
        told = place[0] if place else re.sub(r"[-+\d.e]+|'.*'", "_", finding["told"])[:80]
        groups.setdefault((finding["kind"], told), []).append(finding)
    return groups


def write_findings(folder: Path, tally: Tally, seed: int) -> list[str]:
    """Write some inputs of each kind of finding; return a line for each kind."""
    lines = []
    for (kind, _), group in kinds_of(tally).items():
        names = []
        for finding in group[:_FILES_A_KIND]:
            about = {"seed": seed, "number": finding["number"], "kind": kind, "told": finding["told"]}
            name = folder / tally.border / f"{kind.split()[0]}-{seed}-{finding['number']}.json"
            write_finding(name, tally.border, decoded(finding["input"]), about)
            names.append(str(name))
        lines.append(f"{tally.border}: {kind}, {len(group)} x: {group[0]['told'][:500]}\n    {names[0]}")
    return lines


def write_summary(path: Path, tallies: list[Tally], about: dict[str, Any]) -> None:
    """Write all counts as JSON, findings without their inputs."""
    borders = [
        {**asdict(t), "findings": [{k: v for k, v in f.items() if k != "input"} for f in t.findings]} for t in tallies
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({**about, "borders": borders}, indent=1) + "\n")
