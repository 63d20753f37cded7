"""From names and values, as a user gives them, to a tree of configurations.

The tree is a dataclass whose fields are dataclasses, its branches, declared by `branch`. The rule for names: a setting
is named by its path with dots ("sensors.lidar.beams"), or by the end of its path ("lidar.beams", "beams") where only
one setting ends so. Only whole paths name what is in a branch that is declared `by_path`.

The rule for values: a branch takes a configuration, or a text or None that chooses one: from a table (`choices`), or as
the value of one of its fields (`chooses`). Settings are applied in their order; a branch as a whole replaces what was
set in it before.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from typing import Any, TypeVar, get_args, get_type_hints

from ...slam.errors import InputError, shown, unknown_name
from ...slam.settings import with_settings

Config = TypeVar("Config")
_Path = tuple[str, ...]
_LONGEST_NAME = 60  # longer ones are like none


@dataclass(frozen=True, eq=False)
class _Branch:
    """How a branch takes settings; see `branch`."""

    choices: Mapping[Any, Any] | None
    title: str
    chooses: str | None
    by_path: bool
    foreign: bool


def branch(
    *,
    choices: Mapping[Any, Any] | None = None,
    title: str = "",
    chooses: str | None = None,
    by_path: bool = False,
    foreign: bool = False,
) -> dict[str, Any]:
    """Return the `metadata` of a dataclass field that is a branch.

    Args:
        choices: Text or None -> the configuration that it chooses.
        title: What the choices are called in an error.
        chooses: The field of the branch that a value which is no configuration is for.
        by_path: What is in it is named by its whole path only.
        foreign: Its fields are whatever its configuration has, which may be of several kinds; by path, too.
    """
    return {"branch": _Branch(choices, title, chooses, by_path or foreign, foreign)}


def with_arguments(config: Config, arguments: Mapping[str, Any]) -> Config:
    """Return a copy of a tree of configurations with some settings changed, by the rules above.

    Raises:
        InputError: If a name is unknown or names several settings, a choice is unknown, a branch that is off is asked
            for a field; and whatever the configurations say of their values.
    """
    wanted: dict[_Path, Any] = {}
    for name, value in arguments.items():
        path, value = _chosen(_path(type(config), name), value, type(config))
        for older in [older for older in wanted if older[: len(path)] == path]:
            del wanted[older]
        wanted[path] = value
    return _built(config, wanted, ())


def argument_names(kind: type) -> tuple[str, ...]:
    """Return the whole path of every setting of a tree of configurations, branches left out."""
    nodes = _nodes(kind)
    return tuple(".".join(path) for path, node in nodes.items() if node is None or node.foreign)


@cache
def _nodes(kind: type) -> dict[_Path, _Branch | None]:
    """Return the branch that each path leads to; None for a single setting."""
    found: dict[_Path, _Branch | None] = {}
    hints = get_type_hints(kind)
    for one in fields(kind):
        node = one.metadata.get("branch")
        found[(one.name,)] = node
        if node is not None and not node.foreign:
            hint = hints[one.name]
            inner = next(part for part in (hint, *get_args(hint)) if is_dataclass(part))
            found |= {(one.name, *path): below for path, below in _nodes(inner).items()}  # pyright: ignore
    return found


@cache
def _ends(kind: type) -> dict[_Path, list[_Path]]:
    """Return the paths that end as each of the keys, of those that need not be written whole."""
    nodes, ends = _nodes(kind), {}
    for path in nodes:
        top = nodes[path[:1]]
        if len(path) > 1 and not (top is not None and top.by_path):
            for k in range(1, len(path)):
                ends.setdefault(path[k:], []).append(path)
    return ends


def _path(kind: type, name: str) -> _Path:
    """Return the path that a name stands for."""
    nodes, parts = _nodes(kind), tuple(name.split("."))
    top = nodes.get(parts[:1])
    if parts in nodes or (top is not None and top.foreign and all(parts)):
        return parts
    found = _ends(kind).get(parts, [])
    if len(found) == 1:
        return found[0]
    if found:
        raise InputError(
            f"`{name}` may be any of {', '.join('.'.join(path) for path in found)}: write more of its path"
        )
    if len(parts) > 1 and top is not None:
        inside = sorted(path[1] for path in nodes if len(path) == 2 and path[0] == parts[0])
        raise InputError(f"`{parts[0]}` has no field {shown('.'.join(parts[1:]))}; its fields: {', '.join(inside)}")
    raise _unknown(kind, name)


def _unknown(kind: type, name: str) -> InputError:
    """Return the error for a name that is nowhere in the tree: it tells the branches, and names that look alike."""
    tops = [path[0] for path in _nodes(kind) if len(path) == 1]
    ends = [".".join(end) for end, paths in _ends(kind).items() if len(paths) == 1]
    alike = get_close_matches(name[:_LONGEST_NAME], [*tops, *ends], 5, 0.6)
    guess = f"like it: {', '.join(alike)}; " if alike else ""
    return InputError(f"unknown argument {shown(name)}; {guess}branches: {', '.join(tops)}")


def _chosen(path: _Path, value: Any, kind: type) -> tuple[_Path, Any]:
    """Return the path and the value that is set there; they are others where a text or None makes a choice."""
    node = _nodes(kind).get(path)
    if node is None or is_dataclass(value):
        return path, value
    if node.chooses is not None:
        return (*path, node.chooses), value
    if node.choices is not None and (value is None or isinstance(value, str)):
        if value not in node.choices:
            raise unknown_name(node.title, value, tuple(str(name) for name in node.choices))
        return path, node.choices[value]
    return path, value


def _built(config: Any, wanted: Mapping[_Path, Any], where: _Path) -> Any:
    """Return `config`, which stands at the path `where`, with the settings `wanted` below it."""
    changes = {}
    for head in dict.fromkeys(path[0] for path in wanted):
        inner = {path[1:]: value for path, value in wanted.items() if path[0] == head}
        part = inner.pop((), getattr(config, head))
        if inner and not is_dataclass(part):
            name, asked = ".".join((*where, head)), ".".join(next(iter(inner)))
            raise InputError(f"`{name}` is {shown(part)}, which has no field {asked!r}: choose another `{name}` first")
        if inner and _nodes(type(config))[(head,)].foreign:  # pyright: ignore[reportOptionalMemberAccess]
            part = with_settings(part, {".".join(path): value for path, value in inner.items()})
        elif inner:
            part = _built(part, inner, (*where, head))
        changes[head] = part
    return replace(config, **changes)
