"""The report of an experiment: sections of text, tables and figures, and the numbers behind them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any


@dataclass(frozen=True, kw_only=True)
class Table:
    """A table.

    Attributes:
        title: What it shows.
        columns: Names of the columns, with units.
        rows: Words; each as long as `columns`. Numbers come with their interval ("1.04 [0.90, 1.18]").
        note: How it was measured, and whatever must be known to read it.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A picture.

    Attributes:
        file: The PNG (or GIF) file.
        caption: What is seen on it, and which figure of the paper it stands beside.
    """

    file: Path
    caption: str


@dataclass(frozen=True, kw_only=True)
class Section:
    """A piece of a report.

    Attributes:
        title: Its heading.
        text: Paragraphs, parted by empty lines.
        tables: Its tables.
        figures: Its figures, below the tables.
    """

    title: str
    text: str = ""
    tables: Sequence[Table] = ()
    figures: Sequence[Figure] = ()


@dataclass(frozen=True, kw_only=True)
class Report:
    """Everything that an experiment has to say.

    Attributes:
        title: Its title.
        lead: What was found, in a few sentences.
        sections: The rest.
        results: The numbers, for `results.json`; what depends on the clock stands under keys "timing".
    """

    title: str
    lead: str
    sections: Sequence[Section]
    results: Mapping[str, Any] = field(default_factory=dict)
