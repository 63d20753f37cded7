"""The part of YAML that ROS map files use: `key: value` lines, lists in brackets or by dashes, comments."""

import os

from ..errors import InputError, shown
from .text import numbered_lines

Value = str | list[str]
_MOST_LINES, _MOST_BYTES = 1000, 1 << 16  # a map file has about ten lines, and some have comments


def read_flat_yaml(path: str | os.PathLike[str]) -> dict[str, Value]:
    """Return the entries as text and lists of text, in the order of the file; quotes are taken off.

    Raises:
        InputError: With file and line, for a line of another shape, or a key that comes twice.
    """
    entries: dict[str, Value] = {}
    key = ""
    for number, line in numbered_lines(path, most_lines=_MOST_LINES, most_bytes=_MOST_BYTES):
        where = f"{os.fspath(path)}:{number}"
        text = _without_comment(line).rstrip()
        if not text or text in ("---", "...") or text.startswith("%"):
            continue
        if text.lstrip().startswith("- ") and key and not (isinstance(entries[key], str) and entries[key]):
            entries[key] = [*entries[key], _unquoted(text.lstrip()[2:])]
            continue
        name, colon, value = text.partition(":")
        if not colon or name != name.strip() or not name or (value and not value.startswith(" ")):
            raise InputError(f"{where}: expected `key: value`, got {shown(line)}")
        key = _unquoted(name)
        if key in entries:
            raise InputError(f"{where}: the key {shown(key)} comes twice")
        entries[key] = _value(value.strip(), where)
    return entries


def _value(text: str, where: str) -> Value:
    if not text.startswith("["):
        return _unquoted(text)
    if not text.endswith("]"):
        raise InputError(f"{where}: a list must end with ] on its line, got {shown(text)}")
    inner = text[1:-1].strip()
    return [_unquoted(item) for item in inner.split(",")] if inner else []


def _without_comment(line: str) -> str:
    """Return `line` up to a # that begins it or follows a blank, outside of quotes."""
    quote = ""
    for i, sign in enumerate(line):
        if quote:
            quote = "" if sign == quote else quote
        elif sign in "\"'":
            quote = sign
        elif sign == "#" and (i == 0 or line[i - 1] in " \t"):
            return line[:i]
    return line


def _unquoted(text: str) -> str:
    text = text.strip()
    if len(text) >= 2 and text[0] == text[-1] and text[0] in "\"'":
        return text[1:-1]
    return text
