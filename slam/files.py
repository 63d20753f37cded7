"""Result files appear whole or not at all: they are written under a temporary name and renamed."""

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `path`, same suffix; on success it replaces `path`, on failure it goes.

    Folders above `path` are made. Example: `with replacing("map.png") as p: image.save(p)`.

    Raises:
        InputError: If nothing can be written there.
    """
    target = Path(path)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent)
    except OSError as error:
        raise InputError(f"{target}: cannot be written ({error.strerror})") from error
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        try:
            temporary.replace(target)
        except OSError as error:
            raise InputError(f"{target}: cannot be written ({error.strerror})") from error
    finally:
        temporary.unlink(missing_ok=True)


def read_arrays(path: str | os.PathLike[str]) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file by name, without pickles.

    Raises:
        InputError: If there is no such file, or it is damaged or no npz.
    """
    try:
        with np.load(path, allow_pickle=False) as content:
            return {name: content[name] for name in content.files}
    except FileNotFoundError:
        raise InputError(f"{os.fspath(path)}: no such file") from None
    except Exception as error:  # a damaged byte may stop the zip, its compression, the header's parser or the array
        raise InputError(f"{os.fspath(path)}: no readable npz file ({error})") from error


def made_folder(path: str | os.PathLike[str]) -> Path:
    """Return the folder `path`, made with all above it where it is not there yet.

    Raises:
        InputError: If it cannot be made.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder}: cannot be made ({error.strerror})") from error
    return folder


def require_writable(path: str | os.PathLike[str], *, folder: bool = False) -> None:
    """Make sure that `path` could be written, before hours of work are spent on what goes there; leaves nothing behind.

    Args:
        path: Of a file, which may be there already; of a folder, which may be, too.
        folder: Which of the two.

    Raises:
        InputError: If it is the other one, or the nearest folder above it that exists takes no files, or is no folder.
    """
    target = Path(path)
    if target.exists() and target.is_dir() != folder:
        found, needed = ("a file", "a folder") if folder else ("a folder", "a file")
        raise InputError(f"{target}: is {found}, where {needed} has to be written")
    there = next(folder for folder in (target, *target.absolute().parents) if folder.exists())
    try:
        with tempfile.TemporaryFile(dir=there if there.is_dir() or there != target else there.parent):
            pass
    except OSError as error:
        raise InputError(f"{target}: cannot be written ({there}: {error.strerror})") from error


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write `text` (UTF-8, `\\n` line ends) to `path`, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def write_json(path: str | os.PathLike[str], content: Mapping[str, Any]) -> None:
    """Write `content` as indented JSON to `path`; numpy values become numbers and lists, NaN becomes null."""
    write_text(path, json.dumps(_plain(content), indent=2, allow_nan=False) + "\n")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, float) and not np.isfinite(value):
        return None
    if isinstance(value, Path):
        return str(value)
    return value
