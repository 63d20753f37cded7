"""A report as one HTML file that needs nothing else: pictures are inside it, no script, no address."""

import base64
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from .report import Figure, Report, Section, Table

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1c1e22; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; }
h1 { line-height: 1.2; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #d6dae0; }
.lead { font-size: 1.1rem; } .note, figcaption, footer { color: #555a63; font-size: .9rem; }
.scroll { overflow-x: auto; } table { border-collapse: collapse; margin: .5rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid #e4e7ec; text-align: right; white-space: nowrap; }
th:first-child, td:first-child { text-align: left; white-space: normal; } th { border-bottom: 2px solid #969ba3; }
figure { margin: 1.5rem 0; } img { max-width: 100%; height: auto; }
"""
_KINDS = {".png": "image/png", ".gif": "image/gif"}


def report_html(report: Report, machine: Mapping[str, Any], day: str) -> str:
    """Return the page.

    Args:
        report: What it shows; the files of its figures are read.
        machine: What it was measured with, for the foot.
        day: When, for the foot.
    """
    foot = (
        f"Measured on {day}, {machine['processor']}, {machine['cores']} cores, tagalong {machine['tagalong']}. "
        "Each interval is a 95 % one by itself: of twenty, one is expected to miss what it estimates. Where tests are "
        "corrected for their number, it is said."
    )
    return "\n".join(
        (
            "<!DOCTYPE html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(report.title)}</title><style>{_STYLE}</style></head><body>",
            f"<h1>{escape(report.title)}</h1>",
            _paragraphs(report.lead, "lead"),
            *(_section(section) for section in report.sections),
            f"<footer>{escape(foot)}</footer></body></html>",
            "",
        )
    )


def _section(section: Section) -> str:
    parts = [f"<section><h2>{escape(section.title)}</h2>", _paragraphs(section.text)]
    parts += [_table(table) for table in section.tables]
    parts += [_figure(figure) for figure in section.figures]
    return "\n".join((*parts, "</section>"))


def _paragraphs(text: str, kind: str = "") -> str:
    mark = f' class="{kind}"' if kind else ""
    return "\n".join(f"<p{mark}>{escape(part.strip())}</p>" for part in text.split("\n\n") if part.strip())


def _table(table: Table) -> str:
    head, *rows = (_row(row, tag) for row, tag in ((table.columns, "th"), *((row, "td") for row in table.rows)))
    lines = [f'<div class="scroll"><table><caption>{escape(table.title)}</caption>', f"<thead>{head}</thead><tbody>"]
    lines += [*rows, "</tbody></table></div>", _paragraphs(table.note, "note")]
    return "\n".join(lines)


def _row(words: Sequence[str], tag: str) -> str:
    return "<tr>" + "".join(f"<{tag}>{escape(str(word))}</{tag}>" for word in words) + "</tr>"


def _figure(figure: Figure) -> str:
    caption = escape(figure.caption)
    return f'<figure><img alt="{caption}" src="{_inline(figure.file)}"><figcaption>{caption}</figcaption></figure>'


def _inline(file: Path) -> str:
    return f"data:{_KINDS[file.suffix]};base64,{base64.b64encode(file.read_bytes()).decode('ascii')}"
