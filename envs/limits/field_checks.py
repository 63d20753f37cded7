"""What fields of a configuration may be: of their kind, and no larger than an episode can bear, checked at one place.

Numbers have their bounds in their types, see `tagalong.slam.bounds`; those of environments stand here. Each is far
beyond what anybody wanted yet, and keeps a step below a second and an environment below a gigabyte.
"""

import math
import os
from dataclasses import fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import MOST_BEAMS, Within, check_numbers
from ...slam.errors import InputError, shown

People = Annotated[int, Within(0, 200)]
"""People in a building: the forces between them are as many as their pairs."""
Beams = Annotated[int, Within(2, MOST_BEAMS)]
"""Beams of a laser."""
PIXELS = Within(2, 640)
"""Columns or rows of a camera, each pixel a ray: the Kinect V2 has 512, and a frame of it takes a second or two."""
Slots = Annotated[int, Within(1, 1000)]
"""Rows of an observation: more than there can be people and what is taken for them."""
MapCells = Annotated[int, Within(1, 1024)]
"""Side of a map in an observation, which is new in every step: 4 MB."""
Rate = Annotated[float, Within(0.1, 40.0)]
"""How often something happens [Hz]: at most once a tick of the simulation, at least every ten seconds."""
Opening = Annotated[float, Within(1e-3, 2.0 * math.pi)]
"""An angle of view [rad]."""
Patience = Annotated[float, Within(1e-3, math.inf)]
"""A time that may never end [s]."""
LONGEST_TEXT = 4096
"""Most characters of a text: no path of a file is longer."""


def check_fields(config: object) -> None:
    """Check every field of a configuration, a dataclass, by its type: switches, texts and parts, then numbers.

    Raises:
        InputError: Naming the field, the rule and the value.
    """
    for name, kinds in _plain_fields(type(config)):
        value = getattr(config, name)
        if not isinstance(value, kinds):
            raise InputError(f"`{name}` must be {_told(kinds)}, got {shown(value)}")
        if isinstance(value, str) and not _is_plain(value):
            rule = f"of at most {LONGEST_TEXT} characters, all of which can be written"
            raise InputError(f"`{name}` must be a text {rule}, got {shown(value)}")
    check_numbers(config)


def finite_numbers(value: ArrayLike) -> NDArray[np.float64] | None:
    """Return `value` as an array of finite numbers; None where it is none, be it text that reads as numbers."""
    try:
        array = np.asarray(value)
        numbers = array.astype(np.float64) if array.dtype.kind in "biuf" else None
    except (TypeError, ValueError, RecursionError, OverflowError):
        return None
    return numbers if numbers is not None and np.isfinite(numbers).all() else None


@cache
def _plain_fields(kind: type) -> tuple[tuple[str, tuple[type, ...]], ...]:
    """Return name and kinds of each field of a dataclass that holds no number and no collection."""
    hints = get_type_hints(kind)
    found = []
    for field in fields(kind):
        hint = hints[field.name]
        kinds = get_args(hint) if get_origin(hint) in (Union, UnionType) else (hint,)
        kinds = tuple(get_origin(part) or part for part in kinds)
        if all(part in (bool, str, os.PathLike, NoneType) or is_dataclass(part) for part in kinds):
            found.append((field.name, (*kinds, np.bool_) if bool in kinds else kinds))
    return tuple(found)


def _is_plain(text: str) -> bool:
    """Return whether a file can have this name: no null in it, and no half of a pair of surrogates."""
    return len(text) <= LONGEST_TEXT and "\0" not in text and not any("\ud800" <= c <= "\udfff" for c in text)


def _told(kinds: tuple[Any, ...]) -> str:
    words = {bool: "True or False", str: "a text", os.PathLike: "a path", NoneType: "None", np.bool_: ""}
    return " or ".join(filter(None, (words.get(kind, f"a {getattr(kind, '__name__', kind)}") for kind in kinds)))
