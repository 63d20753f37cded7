"""Result files appear whole or not at all: they are written under a temporary name and renamed."""

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, UnwritableError
from .input import checked_name, kind_of_file, named
from .input import read_json as read_json
from .npz import read_arrays as read_arrays

_LONGEST_SUFFIX = 16
"""Characters of a suffix that the temporary name keeps: libraries choose a format by it; more would be no suffix."""


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary path beside `path`, same suffix; on success it replaces `path`, on failure it goes.

    Folders above `path` are made. A link is followed: what it points to is replaced, the link stays. A device, a pipe
    or a folder is never replaced. Example: `with replacing("map.png") as p: image.save(p)`.

    Raises:
        UnwritableError: If nothing can be written there, or the disk is full; also for any other `OSError` in the body.
    """
    with _told(path, "written"):
        target = _real_target(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        suffix = target.suffix if len(target.suffix) <= _LONGEST_SUFFIX else ""
        handle, name = tempfile.mkstemp(prefix=f".{target.stem[:20]}-", suffix=suffix, dir=target.parent)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            temporary.chmod(0o644)
            temporary.replace(target)
        finally:
            with suppress(OSError):  # gone, with its folder perhaps: what went wrong before is what counts
                temporary.unlink(missing_ok=True)


@contextmanager
def new_folder(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a temporary folder beside `path`; on success it becomes `path`, on failure it goes.

    Raises:
        InputError: If something is there already, or nothing can be written there; also for any other `OSError` in the
            body.
    """
    target = checked_name(path)
    with _told(path, "written"):
        if _exists(target):
            raise InputError(f"{named(path)}: is there already; give the name of a new folder")
        target.absolute().parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{target.name[:20]}-", dir=target.absolute().parent) as holder:
            temporary = Path(holder) / "new"
            temporary.mkdir()
            yield temporary
            temporary.replace(target)


@contextmanager
def _told(path: str | os.PathLike[str], done: str) -> Iterator[None]:
    """Tell in one line what the system finds wrong with a path that is to be `done` ("written", "made")."""
    try:
        yield
    except OSError as error:
        raise UnwritableError(f"{named(path)}: cannot be {done} ({error.strerror or error})") from error


def _real_target(path: str | os.PathLike[str]) -> Path:
    """Return where `path` leads, links followed: to a regular file, or to nothing yet.

    Raises:
        InputError: If something else is there, or no file can have such a name.
    """
    target = Path(os.path.realpath(checked_name(path)))
    found = kind_of_file(target.stat().st_mode) if _exists(target) else ""
    if found:
        raise InputError(f"{named(path)}: cannot be written (is {found}, not a file)")
    return target


def made_folder(path: str | os.PathLike[str]) -> Path:
    """Return the folder `path`, made with all above it where it is not there yet.

    Raises:
        InputError: If it cannot be made.
    """
    folder = checked_name(path)
    with _told(folder, "made"):
        folder.mkdir(parents=True, exist_ok=True)
    return folder


def require_writable(path: str | os.PathLike[str], *, folder: bool = False) -> None:
    """Make sure that `path` could be written, before hours of work are spent on what goes there; leaves nothing behind.

    Args:
        path: Of a file, which may be there already; of a folder, which may be, too.
        folder: Which of the two.

    Raises:
        InputError: If it is the other one, or the nearest folder above it that exists takes no files, or is no folder.
    """
    target = checked_name(path)
    with _told(target, "written"):
        if _exists(target) and target.is_dir() != folder:
            found, needed = kind_of_file(target.stat().st_mode) or "a file", "a folder" if folder else "a file"
            raise InputError(f"{named(target)}: is {found}, where {needed} has to be written")
        if not folder:
            _real_target(target)
        there = next(above for above in (target, *target.absolute().parents) if _exists(above))
    try:
        with tempfile.TemporaryFile(dir=there if there.is_dir() or there != target else there.parent):
            pass
    except OSError as error:
        raise InputError(f"{named(target)}: cannot be written ({named(there)}: {error.strerror})") from error


def _exists(path: Path) -> bool:
    """Return whether something is there; a name that is too long raises its `OSError`."""
    try:
        path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    return True


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
