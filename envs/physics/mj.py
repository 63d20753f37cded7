"""MuJoCo as type checkers can bear it: its compiled modules carry no type information."""

from typing import Any, TypeAlias

import mujoco as _mujoco

mujoco: Any = _mujoco
MjSpec: TypeAlias = Any
MjsBody: TypeAlias = Any
MjModel: TypeAlias = Any
MjData: TypeAlias = Any
