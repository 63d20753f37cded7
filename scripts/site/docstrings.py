"""Docstrings of the house's form as Markdown."""

import inspect
import re
from typing import Any

_SECTIONS = {
    "Args": "Arguments",
    "Attributes": "Attributes",
    "Returns": "Returns",
    "Yields": "Yields",
    "Raises": "Raises",
    "Example": "Example",
}
"""Heading of a section in a docstring -> on a page."""
_ENTRY = re.compile(r"^(\*{0,2}\w[\w.]*)(?: \([^)]*\))?: (.*)$")


def markdown(documented: Any) -> str:
    """Return the docstring of something as Markdown; "" if it has none."""
    return from_text(inspect.getdoc(documented) or "")


def from_text(text: str) -> str:
    """Return a docstring as Markdown: sections under bold words, their entries as lists, doctests as code."""
    done: list[str] = []
    for block in re.split(r"\n(?=\w+:\n)", "\n" + text):
        head, _, rest = block.strip("\n").partition("\n")
        title = _SECTIONS.get(head.removesuffix(":")) if head.endswith(":") else None
        if title is None:
            done.append(_prose(block))
        else:
            body = inspect.cleandoc("\n" + rest)
            done.append(f"**{title}**\n\n{_prose(body) if title == 'Example' else _entries(body)}")
    return "\n\n".join(part for part in (each.strip("\n") for each in done) if part)


def _entries(body: str) -> str:
    """Return the entries of a section as a list; what follows an indented line belongs to its entry."""
    lines: list[str] = []
    for line in body.splitlines():
        found = _ENTRY.match(line)
        if found:
            lines.append(f"- `{found[1]}`: {found[2]}")
        elif line.startswith(" ") and lines:
            lines.append("  " + line.strip())
        else:
            lines.append(line)
    return "\n".join(lines)


def _prose(text: str) -> str:
    """Return running text; doctests in a fence of Python's prompt, other indented stretches in a plain one."""
    lines: list[str] = []
    fence = ""
    for line in [*text.splitlines(), ""]:
        wanted = _fence_of(line, fence)
        if wanted != fence:
            lines += (["```", ""] if fence else []) + (["", f"```{wanted}"] if wanted else [])
            fence = wanted
        lines.append(line.removeprefix("    ") if fence else line)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines))


def _fence_of(line: str, inside: str) -> str:
    """Return in what fence a line belongs, "" for none, where the line before was `inside` one."""
    if not line.strip():
        return ""
    if line.lstrip().startswith(">>>") or inside == "pycon":
        return "pycon"
    return "text" if line.startswith("    ") else ""


def first_line(documented: Any) -> str:
    """Return the first sentence-like line of a docstring, without what follows an empty line."""
    text = inspect.getdoc(documented) or ""
    return " ".join(text.split("\n\n")[0].split())


def attributes(kind: type) -> dict[str, str]:
    """Return what the docstrings of a class and its bases say of each attribute, in one line each."""
    found: dict[str, str] = {}
    for base in reversed(kind.__mro__):
        text = inspect.cleandoc(base.__doc__ or "")
        section = re.search(r"^Attributes:\n((?: +.*\n?|\n)+)", text, flags=re.M)
        name = ""
        for line in inspect.cleandoc("\n" + section[1]).splitlines() if section else ():
            entry = _ENTRY.match(line)
            if entry:
                name = entry[1]
                found[name] = entry[2]
            elif line.strip() and name:
                found[name] += " " + line.strip()
    return found
