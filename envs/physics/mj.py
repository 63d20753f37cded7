"""MuJoCo as type checkers can bear it: its compiled modules carry no type information.

Its import starts no process. GLFW's Python package, which it imports for its windows, asks every library that it finds
for its version in a Python of its own; one that outlives a killed command complains of its closed pipe. Told which
library to load (PYGLFW_LIBRARY), it asks none.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeAlias


@contextmanager
def _glfw_told() -> Iterator[None]:
    """Name the library in GLFW's own package, on Linux, unless somebody has named one, until the block ends."""
    spec = find_spec("glfw") if sys.platform == "linux" and not os.environ.get("PYGLFW_LIBRARY") else None
    session = os.environ.get("PYGLFW_LIBRARY_VARIANT") or os.environ.get("XDG_SESSION_TYPE", "")
    kind = "wayland" if session.lower() == "wayland" else "x11"
    library = Path(spec.origin).parent / kind / "libglfw.so" if spec is not None and spec.origin else None
    if library is None or not library.is_file():  # built without one: it looks for the system's
        yield
        return
    os.environ["PYGLFW_LIBRARY"] = str(library)
    try:
        yield
    finally:
        del os.environ["PYGLFW_LIBRARY"]


with _glfw_told():
    import mujoco as _mujoco

mujoco: Any = _mujoco
MjSpec: TypeAlias = Any
MjsBody: TypeAlias = Any
MjModel: TypeAlias = Any
MjData: TypeAlias = Any
