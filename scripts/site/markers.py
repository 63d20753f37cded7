"""Parts of hand-written pages that are made of the code: `<!-- made: KIND WHAT -->` is replaced by a table.

<!-- made: parameters tagalong.slam.GMappingConfig -->       every number of a configuration
<!-- made: files slam/gmapping -->                           every file of a folder, with the first line of each
<!-- made: limits agents/models/follower.json -->            the limits that a shipped model's card states
<!-- made: recordings all -->                               the catalogue of public recordings
    <!-- made: results README.md -->                            the table between the README's marks
"""

import ast
import inspect
import json
import re
from collections.abc import Callable
from pathlib import Path

from ...slam.errors import InputError
from ..benchmarks.acceptance_table import BEGIN, END
from ..public_data.catalogue import catalogue
from ..public_data.derive import RECIPES
from .named import thing_named
from .parameters import cell, table

_MARKER = re.compile(r"<!-- made: (\w+) (\S+) -->")


def with_made_parts(text: str, root: Path) -> str:
    """Return a page whose markers are replaced.

    Args:
        text: The page, Markdown.
        root: Folder of the repository.

    Raises:
        InputError: If a marker is unknown, or what it names is not there.
    """

    def made(found: re.Match[str]) -> str:
        kind, what = found.groups()
        if kind not in _KINDS:
            raise InputError(f"marker {found[0]!r}: unknown kind; there are: {', '.join(_KINDS)}")
        return _KINDS[kind](what, root)

    return _MARKER.sub(made, text)


def _parameters(what: str, root: Path) -> str:
    """Return the table of a configuration: a class, or an instance that stands in a module."""
    return table(thing_named(what.removeprefix("tagalong.")))


def _files(what: str, root: Path) -> str:
    """Return the files of a folder, or one file, with what the first line of each says."""
    place = root / what
    paths = sorted(place.rglob("*.py")) if place.is_dir() else [place]
    if not all(path.is_file() for path in paths) or not paths:
        raise InputError(f"no file or folder {what!r} in the repository")
    rows = ["| file | what is in it |", "|---|---|"]
    for path in paths:
        text = inspect.cleandoc(ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or "").partition("\n\n")[
            0
        ]
        if path.name != "__init__.py":
            rows.append(f"| `{path.relative_to(root).as_posix()}` | {cell(text)} |")
    return "\n".join(rows)


def _limits(what: str, root: Path) -> str:
    """Return what a shipped model's card says of its limits, as a list."""
    limits = json.loads((root / what).read_text(encoding="utf-8"))["limits"]
    return "\n".join(f"- {line}" for line in ([limits] if isinstance(limits, str) else limits))


def _recordings(what: str, root: Path) -> str:
    """Return the catalogue of public recordings: a section for each collection."""
    parts = []
    for each in catalogue():
        parts.append(f"### {each.name}")
        told = [f"- Rests on it: {each.figures}.", f"- Recorded by: {each.collector}.", f"- Origin: {each.origin}."]
        parts.append("\n".join([*told, f"- Licence: {each.licence}."]))
        rows = ["| file | SHA-256 of its content | derives from |", "|---|---|---|"]
        for file in each.files:
            how = f"{cell(file.made_from)}: {cell(file.how)}" if file.made_from else "original"
            how += " (`tagalong data derive`)" if file.path in RECIPES else ""
            rows.append(f"| `{file.path}` | `{file.sha256[:16]}` | {how} |")
        parts.append("\n".join(rows))
    return "\n\n".join(parts)


def _results(what: str, root: Path) -> str:
    """Return the table of results, which `tagalong results --readme` writes into the README."""
    text = (root / what).read_text(encoding="utf-8")
    return text.partition(BEGIN)[2].partition(END)[0].strip()


_KINDS: dict[str, Callable[[str, Path], str]] = {
    "parameters": _parameters,
    "files": _files,
    "limits": _limits,
    "recordings": _recordings,
    "results": _results,
}
