"""Inputs as text files, so that a finding can be kept, read and sent again."""

import base64
import json
from pathlib import Path
from typing import Any

from fuzzer.border import Input


def encoded(value: Input) -> Any:
    """Return the input as JSON knows it; bytes become {"text": ...} where they are plain text, else {"base64": ...}."""
    if isinstance(value, bytes):
        plain = value.isascii() and all(byte in (9, 10) or 32 <= byte < 127 for byte in value)
        return {"text": value.decode()} if plain else {"base64": base64.b64encode(value).decode()}
    if isinstance(value, dict):
        return {"dict": [[key, encoded(entry)] for key, entry in value.items()]}
    if isinstance(value, list | tuple):
        return [encoded(entry) for entry in value]
    return value


def decoded(value: Any) -> Input:
    """Return the input that `encoded` made `value` of; tuples have become lists."""
    if isinstance(value, list):
        return [decoded(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    ((kind, content),) = value.items()
    if kind == "text":
        return content.encode()
    return base64.b64decode(content) if kind == "base64" else {key: decoded(entry) for key, entry in content}


def write_finding(path: Path, border: str, value: Input, about: dict[str, Any]) -> None:
    """Write an input of a border with what is known about it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"border": border, **about, "input": encoded(value)}, indent=1) + "\n")


def read_finding(path: Path) -> tuple[str, Input]:
    """Return the name of the border and the input in a file that `write_finding` wrote."""
    content = json.loads(path.read_text())
    return content["border"], decoded(content["input"])
