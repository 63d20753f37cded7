"""A table of all numbers of a configuration: the tree of dataclasses, one row a leaf."""

from collections.abc import Iterator
from dataclasses import MISSING, Field, fields, is_dataclass
from typing import Any, NamedTuple, get_type_hints

from ...slam.bounds import Within
from .docstrings import attributes


class Parameter(NamedTuple):
    """One number, text or switch: its path, its default, its bounds and what it means."""

    path: str
    default: Any
    bounds: str
    meaning: str


def parameters(config: Any, prefix: str = "") -> Iterator[Parameter]:
    """Yield every leaf of a configuration.

    Args:
        config: A dataclass, or an instance of one (whose values are the defaults then).
        prefix: Stands before the paths.
    """
    kind = config if isinstance(config, type) else type(config)
    meanings, hints = attributes(kind), get_type_hints(kind, include_extras=True)
    for entry in fields(kind):
        value = getattr(config, entry.name) if not isinstance(config, type) else _default(entry)
        path = f"{prefix}{entry.name}"
        if is_dataclass(value) and not isinstance(value, type):
            yield from parameters(value, f"{path}.")
        else:
            yield Parameter(path, value, _bounds(hints.get(entry.name)), meanings.get(entry.name, ""))


def table(config: Any) -> str:
    """Return the parameters of a configuration as a table of Markdown."""
    rows = ["| parameter | default | within | what it is |", "|---|---|---|---|"]
    for each in parameters(config):
        rows.append(f"| `{each.path}` | {_shown(each.default)} | {each.bounds} | {cell(each.meaning)} |")
    return "\n".join(rows)


def cell(text: str) -> str:
    """Return text that may stand in a cell of a table."""
    return " ".join(text.split()).replace("|", "\\|")


def _default(entry: "Field[Any]") -> Any:
    if entry.default is not MISSING:
        return entry.default
    return entry.default_factory() if entry.default_factory is not MISSING else "required"


def _bounds(hint: Any) -> str:
    """Return the bounds that a type carries, "" for none."""
    found = [each for each in getattr(hint, "__metadata__", ()) if isinstance(each, Within)]
    return f"{found[0].low:g} .. {found[0].high:g}" if found else ""


def _shown(value: Any) -> str:
    if value == "required":
        return "required"
    if callable(value):
        return f"`{getattr(value, '__name__', 'a function')}`"
    text = repr(round(value, 6) if isinstance(value, float) else value)
    return f"`{text if len(text) <= 40 else text[:37] + '...'}`".replace("|", "\\|")
