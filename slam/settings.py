"""Fields of a configuration by name, as a user gives them: checked, those of its parts with dots."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from numbers import Integral, Real
from types import NoneType
from typing import Any, TypeVar, get_args

from .bounds import plain_kind
from .errors import InputError, shown, unknown_name

Config = TypeVar("Config")


def with_settings(config: Config, settings: Mapping[str, Any]) -> Config:
    """Return a copy of a configuration with some fields changed.

    Args:
        config: A dataclass, whose values are the defaults.
        settings: Field -> value; "local.ceres.steps" is the field `steps` of `config.local.ceres`.

    Raises:
        InputError: If a field is unknown, or a value is no number, whole number, list of as many numbers, text or part
            where the field is one; and whatever the configuration itself says of its values.
    """
    kinds = {field.name: plain_kind(field.type) for field in fields(config)}  # pyright: ignore[reportArgumentType]
    changes: dict[str, Any] = {}
    parts: dict[str, dict[str, Any]] = {}
    for name, value in settings.items():
        head, dot, rest = name.partition(".")
        if head not in kinds:
            raise unknown_name(f"{type(config).__name__} field", head, tuple(kinds))
        if dot:
            parts.setdefault(head, {})[rest] = value
        else:
            changes[head] = _checked(head, value, getattr(config, head), kinds[head])
    for head, inner in parts.items():
        part = changes.get(head, getattr(config, head))
        if not is_dataclass(part):
            raise InputError(f"`{head}` of {type(config).__name__} has no fields, asked for {next(iter(inner))!r}")
        changes[head] = with_settings(part, inner)
    return replace(config, **changes)  # pyright: ignore[reportArgumentType]


def _checked(name: str, value: object, default: object, kind: object) -> object:
    """Return the value if it is of the kind of its field; None where the field may be None: a part is off then."""
    if default is None or (value is None and NoneType in get_args(kind)):
        return value
    if isinstance(default, tuple):
        return _list_of_numbers(name, value, get_args(kind))
    if isinstance(default, Real):
        return _number(name, value, whole=kind is int)
    if isinstance(default, str) and not isinstance(value, str):
        raise InputError(f"`{name}` must be a text, got {shown(value)}")
    if is_dataclass(default) and not is_dataclass(value):
        inner = ", ".join(f"{name}.{field.name}" for field in fields(default))
        raise InputError(f"`{name}` is no single value; its fields are {inner}; got {shown(value)}")
    return value


def _number(name: str, value: object, whole: bool) -> object:
    if not isinstance(value, Integral if whole else Real):
        raise InputError(f"`{name}` must be a {'whole ' if whole else ''}number, got {shown(value)}")
    return value


def _list_of_numbers(name: str, value: object, kinds: tuple[object, ...]) -> tuple[object, ...]:
    """Return the value as a tuple; `kinds` are those of its entries, (int, ...) for any number of one kind."""
    count = None if Ellipsis in kinds else len(kinds)
    if not isinstance(value, (tuple, list)) or count not in (None, len(value)):
        raise InputError(f"`{name}` must be a list of {count or 'some'} numbers, got {shown(value)}")
    return tuple(_number(name, entry, whole=int in kinds) for entry in value)
