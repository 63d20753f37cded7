"""One command at a time writes into a folder: the second is refused."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ...slam.errors import InputError
from ...slam.files.output import made_folder

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Make `folder`, and be the only one who writes there until the block ends; after an error an empty one goes again.

    The lock is the system's, on the folder itself: it leaves no file behind and ends with the process, however that
    ends. Where the system has none for folders (Windows, some network drives), nobody is refused.

    Raises:
        InputError: If it cannot be made, or another command writes there.
    """
    absent = [path for path in (folder, *folder.parents) if not path.exists()]
    handle = _locked(folder)
    try:
        yield
    except Exception:
        for path in absent:
            with suppress(OSError):  # something is in it, or somebody else removed it
                path.rmdir()
        raise
    finally:
        if handle is not None:
            os.close(handle)


def _locked(folder: Path) -> int | None:
    """Return a handle that locks `folder`, which is made; None where that cannot be."""
    made_folder(folder)
    if fcntl is None:
        return None
    handle = None
    try:
        handle = os.open(folder, os.O_RDONLY)
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(handle), os.stat(folder)):
            return handle
    except BlockingIOError:
        if handle is not None:
            os.close(handle)
        raise InputError(f"{folder}: another command is writing there; wait, or give another --out") from None
    except FileNotFoundError:  # who had it before has just removed it
        pass
    except OSError:  # a file system without locks
        return handle
    if handle is not None:
        os.close(handle)
    return _locked(folder)
