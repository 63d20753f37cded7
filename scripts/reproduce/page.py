"""A report as a page of the documentation: Markdown, with its pictures made small beside it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from PIL import Image

from ...slam.files.output import made_folder, replacing, write_text
from .report import Figure, Report, Section, Table

_WIDEST = 1000  # pixels: what a page shows at most
_COLOURS = 128
_SIGNS = str.maketrans({"<": "&lt;", **{sign: f"\\{sign}" for sign in "\\`*_>[]|#"}})


def write_page(path: Path, report: Report, machine: Mapping[str, Any], day: str, cost: str) -> None:
    """Write a report as `path` (.md), and its pictures into a folder of the same name beside it.

    Args:
        path: Of the page.
        report: What it shows.
        machine: What it was measured with.
        day: When.
        cost: What it cost, and how it was made, in a sentence.
    """
    made = (
        f"Measured on {day}, {machine['processor']}, {machine['cores']} cores, tagalong {machine['tagalong']}. {cost} "
        "Each interval is a 95 % one by itself."
    )
    parts = [f"# {plain(report.title)}", _paragraphs(report.lead), f"*{plain(made)}*"]
    pictures = made_folder(path.with_suffix(""))
    for section in report.sections:
        parts += _section(section, pictures)
    write_text(path, "\n\n".join(part for part in parts if part) + "\n")


def _section(section: Section, pictures: Path) -> list[str]:
    parts = [f"## {plain(section.title)}", _paragraphs(section.text)]
    for table in section.tables:
        parts += [f"**{plain(table.title)}**", _table(table), _paragraphs(table.note)]
    return parts + [_figure(figure, pictures) for figure in section.figures]


def _table(table: Table) -> str:
    ruler = [":---", *["---:"] * (len(table.columns) - 1)]
    return "\n".join(_row(words) for words in ([plain(word) for word in table.columns], ruler, *_cells(table.rows)))


def _cells(rows: Sequence[Sequence[str]]) -> list[list[str]]:
    return [[plain(str(word)) for word in row] for row in rows]


def _row(words: Sequence[str]) -> str:
    return f"| {' | '.join(words)} |"


def _figure(figure: Figure, pictures: Path) -> str:
    """Return the figure's line, having written it small: of moving pictures the first."""
    target = pictures / f"{figure.file.stem}.png"
    with Image.open(figure.file) as image:
        picture = image.convert("RGB")
    if picture.width > _WIDEST:
        picture = picture.resize((_WIDEST, round(picture.height * _WIDEST / picture.width)), Image.Resampling.LANCZOS)
    with replacing(target) as temporary:
        picture.quantize(_COLOURS).save(temporary, format="png", optimize=True)
    caption = plain(figure.caption)
    return f"![{caption}]({pictures.name}/{target.name})\n\n*{caption}*"


def _paragraphs(text: str) -> str:
    return "\n\n".join(plain(part.strip()) for part in text.split("\n\n") if part.strip())


def plain(text: str) -> str:
    """Return words on one line, in which nothing is a sign of Markdown."""
    return " ".join(text.split()).translate(_SIGNS)
