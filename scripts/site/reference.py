"""The reference: a page for each public door, made of what the door lists and of the docstrings."""

import inspect
import re
from collections.abc import Iterator
from dataclasses import is_dataclass
from typing import Any

from .docstrings import attributes, markdown
from .named import module_named
from .parameters import table

DOORS = {
    "slam": "mapping and localization with a planar laser",
    "slam.logs": "drives, trajectories and maps as files",
    "perception": "people and planes",
    "perception.tracking": "what else goes into the tracker",
    "perception.rgbd": "frames of an RGB-D camera",
    "perception.immobile": "the map of what never moves",
    "envs": "the building and the Gymnasium environment",
    "envs.recording": "episodes as recordings and as datasets",
    "envs.scenes": "what buildings are made of",
    "envs.task": "what a follower is told",
    "envs.wrappers": "an observation to learn from",
    "agents": "who drives",
    "agents.learned": "the learned follower",
    "agents.teleop": "joystick and keyboard",
    "agents.training": "training a follower (extra `learn`)",
}
"""Public door -> what it is about."""


def reference_pages() -> Iterator[tuple[str, str]]:
    """Yield (path, Markdown) of each page."""
    rows = ["| door | about | names |", "|---|---|---|"]
    for door, about in DOORS.items():
        module = module_named(door)
        names = ", ".join(f"[`{name}`]({door}.md#{name.lower()})" for name in sorted(module.__all__))
        rows.append(f"| [`tagalong.{door}`]({door}.md) | {about} | {names} |")
        yield f"reference/{door}.md", door_page(door, about)
    text = "What these doors list is public; every other module is private and may change at any time."
    yield "reference/index.md", "# Reference\n\n" + text + "\n\n" + "\n".join(rows) + "\n"


def door_page(door: str, about: str) -> str:
    """Return the page of a door: its manual, then each name."""
    module = module_named(door)
    parts = [f"# tagalong.{door}", f"*{about[0].upper()}{about[1:]}.*", markdown(module)]
    parts += [_entry(name, getattr(module, name)) for name in sorted(module.__all__)]
    return "\n\n".join(parts) + "\n"


def _entry(name: str, offered: Any) -> str:
    """Return what is told of one public name."""
    if inspect.isclass(offered):
        return _class(name, offered)
    if callable(offered):
        return f"## {name}\n\n{_signature(name, offered)}\n\n{markdown(offered)}"
    if isinstance(offered, dict):
        keys = ", ".join(f"`{key}`" for key in offered)
        return f"## {name}\n\nA table by name: {keys}."
    return f"## {name}\n\n```python\n{name} = {_short(repr(offered))}\n```"


def _class(name: str, kind: type) -> str:
    is_config = is_dataclass(kind) and name.endswith("Config")
    parts = [f"## {name}"]
    if is_config:
        told = re.sub(r"\n\n\*\*Attributes\*\*.*", "", markdown(kind), flags=re.S)
        parts += [told, table(kind) if attributes(kind) else ""]
    else:
        parts += [_signature(name, kind), _lower_headings(markdown(kind))]
    parts += list(_members(name, kind))
    return "\n\n".join(part for part in parts if part)


def _lower_headings(text: str) -> str:
    """Return Markdown whose headings stand two levels lower, below that of a name."""
    return re.sub(r"^(#+ )", r"##\1", text, flags=re.M)


def _members(owner: str, kind: type) -> Iterator[str]:
    """Yield public methods and properties that the class itself defines and documents."""
    for name, member in vars(kind).items():
        if name.startswith("_"):
            continue
        function = member.__func__ if isinstance(member, (classmethod, staticmethod)) else member
        if isinstance(member, property) or hasattr(member, "attrname"):
            inner = getattr(member, "fget", None) or getattr(member, "func", None)
            told = markdown(inner)
            if told:
                yield f"### {owner}.{name}\n\n*property* {told}"
        elif inspect.isfunction(function) and function.__doc__:
            yield f"### {owner}.{name}\n\n{_signature(name, function)}\n\n{markdown(function)}"


def _signature(name: str, called: Any) -> str:
    try:
        text = str(inspect.signature(called))
    except (TypeError, ValueError):
        return ""
    text = re.sub(r"(?:tagalong|numpy|gymnasium|collections|pathlib|typing)\.(?:\w+\.)*(?=[A-Z_]\w*)", "", text)
    text = text.replace("'", "")
    if len(name + text) > 88:
        text = _wrapped(text)
    return f"```python\n{name}{text}\n```"


def _wrapped(text: str) -> str:
    """Return a signature with one parameter a line."""
    inside, depth, lines, start = text, 0, [], 1
    for at, letter in enumerate(inside):
        depth += (letter in "([{") - (letter in ")]}")
        if (letter == "," and depth == 1) or (depth == 0 and at > 0):
            lines.append(inside[start:at].strip())
            start = at + 1
            if depth == 0:
                return "(\n" + "".join(f"    {line},\n" for line in lines if line) + ")" + inside[start:]
    return text


def _short(text: str) -> str:
    return text if len(text) <= 200 else text[:197] + "..."
