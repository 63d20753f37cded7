"""What numbers from outside may be: bounds that physics sets, checked once where numbers come in.

Behind the border nothing is checked again: kernels index, allocate and loop by what was bounded here. A bound stands
far beyond what any robot does; what lies beyond it is no measurement but a mistake in a file or a program.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from functools import cache
from numbers import Integral, Real
from types import NoneType
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InputError, shown

Array = NDArray[np.float64]

FARTHEST_M = 1e7
"""Largest coordinate [m]: northings of UTM end there. A double resolves nanometres at it, and in cells of a millimetre
it is 1e10, nine digits below where whole numbers of 64 bits end."""
MOST_TURNED = 1e6
"""Largest heading [rad]: some drivers count whole turns. A double resolves 1e-10 rad at it."""
MOST_JUMP_M = 1e4
"""Odometry may be set anew within a drive, but not to a place farther off than any drive is long [m]."""
LATEST_S = 1e11
"""Largest time [s], before and after the epoch: 3000 years. A double resolves 15 us at it."""
LONGEST_RANGE_M = 1e5
"""Largest `range_max` [m]: no planar laser sees farther than a few hundred metres; few drivers say more than 1e4."""
FARTHEST_MOUNT_M = 100.0
"""Largest distance of a laser from the robot's origin, on each axis [m]: a ship's."""
LARGEST_BEARING = 4.0 * math.pi
"""Largest bearing of a beam [rad]: two turns, however a driver counts them."""
LEAST_SPACING = 1e-9
"""Least angle between beams [rad], a hundred nanometres at 100 m: closer ones cannot be told apart."""
MOST_BEAMS = 32_768
"""Most beams of a sweep; the finest planar scanner takes 25,200 samples a turn."""
FINEST_CELL_M, COARSEST_CELL_M = 1e-3, 100.0
"""Sides of cells [m]: lasers measure no better than a millimetre, and nothing is left of a building at 100 m."""
MOST_CELLS = 400_000_000
"""Most cells of a map, 1 km x 1 km at 5 cm: 1.6 GB."""
FREE_CELLS, CELLS_A_SCAN = 50_000_000, 100_000
"""Cells of a map that is drawn: so many at once, 350 m x 350 m at 5 cm, a gigabyte while it grows; and so many more for
each scan in it, 16 m x 16 m: a campus has thousands of scans, one wrong number in a short log has not."""
_MOST_INDEX = 2.0**40  # of a cell from the origin: sums and products of two such still are whole numbers of 64 bits
_LEAST, _MOST = 1e-9, 1e9  # size of a setting that has no bound of its own: no product of a few overflows or vanishes
_MOST_COUNT = 1_000_000  # of a setting that is a whole number, likewise


class Within(NamedTuple):
    """Bounds of a setting, both included, as part of its type: `Annotated[float, Within(0.0, 1.0)]`."""

    low: float
    high: float


Cell = Annotated[float, Within(FINEST_CELL_M, COARSEST_CELL_M)]
"""Side of a cell [m]."""
Reach = Annotated[float, Within(0.0, LONGEST_RANGE_M)]
"""A length that a laser may see [m]."""
Share = Annotated[float, Within(0.0, 1.0)]
"""A share or a probability."""
Angle = Annotated[float, Within(0.0, 2.0 * math.pi)]
"""An angle up to a turn [rad]."""
FINEST_STEP = 1e-3
"""The least step between headings that are tried [rad]."""
Step = Annotated[float, Within(FINEST_STEP, 2.0 * math.pi)]
"""A step between headings that are tried [rad]: a turn has 6283 of the smallest."""
Rounds = Annotated[int, Within(0, 1000)]
"""How often something is repeated that takes a while."""
Threads = Annotated[int, Within(1, 64)]
"""Threads that share work: no work here has more pieces worth a thread each."""
Endless = Annotated[float, Within(0.0, math.inf)]
"""A length or a time that may be without end."""
Seed = Annotated[int, Within(0, 2**32 - 1)]
"""Of random draws: what every generator takes."""


def checked_pose(value: ArrayLike, name: str = "odometry", before: Array | None = None) -> Array:
    """Return a pose from outside as a new array (3,) [m, m, rad].

    Args:
        value: The pose.
        name: What it is called in the error.
        before: (3,) the pose before it, from which it may not be farther than any drive is long; None: there is none.

    Raises:
        InputError: If it is not three finite numbers within the bounds of coordinates and headings.
    """
    try:
        pose = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"`{name}` must be three numbers (x, y, theta), got {shown(value)}") from error
    if pose.shape != (3,):
        raise InputError(f"`{name}` must be a finite pose of shape (3,), got shape {pose.shape}")
    x, y, theta = pose.tolist()
    if not (abs(x) <= FARTHEST_M and abs(y) <= FARTHEST_M and abs(theta) <= MOST_TURNED):  # no NaN is
        raise InputError(f"`{name}` must be a finite pose {_POSE_RULE}, got {shown(pose.tolist())}")
    if before is not None:
        way = math.hypot(x - before.item(0), y - before.item(1))
        if way > MOST_JUMP_M:
            raise InputError(f"`{name}` must not jump by more than {MOST_JUMP_M:g} m between scans, got {way:.6g} m")
    return pose


def check_mount(pose: object, name: str = "T_robot_lidar") -> None:
    """Raise InputError unless a sensor can have that pose (x, y, theta) on a robot [m, m, rad]."""
    try:
        x, y, theta = pose  # pyright: ignore[reportGeneralTypeIssues]
        if abs(x) <= FARTHEST_MOUNT_M and abs(y) <= FARTHEST_MOUNT_M and abs(theta) <= MOST_TURNED:
            return
    except (TypeError, ValueError):
        pass
    raise InputError(
        f"`{name}` must be a pose within {FARTHEST_MOUNT_M:g} m and {MOST_TURNED:g} rad, got {shown(pose)}"
    )


def check_time(time_s: float, name: str = "time_s") -> None:
    """Raise InputError unless a time [s] is finite and one that clocks show."""
    if not -LATEST_S <= time_s <= LATEST_S:
        raise InputError(f"`{name}` must be finite and within {LATEST_S:g} s, got {shown(time_s)}")


_POSE_RULE = f"within {FARTHEST_M:g} m and {MOST_TURNED:g} rad"


def check_poses(poses: Array, name: str, jumps: bool = True) -> None:
    """Raise InputError unless each of `poses` (n, 3) [m, m, rad] is one that `checked_pose` takes after the last.

    Args:
        poses: The poses.
        name: What they are called in the error.
        jumps: Whether they may not jump.
    """
    good = (np.abs(poses) <= (FARTHEST_M, FARTHEST_M, MOST_TURNED)).all(axis=1)
    if not good.all():
        k = int(np.argmin(good))
        raise InputError(f"`{name}` must be finite and {_POSE_RULE}, got {shown(poses[k].tolist())} of scan {k}")
    ways = np.hypot(*np.diff(poses[:, :2], axis=0).T) if jumps and len(poses) > 1 else np.zeros(1)
    if ways.max() > MOST_JUMP_M:
        k = int(np.argmax(ways))
        raise InputError(
            f"`{name}` must not jump by more than {MOST_JUMP_M:g} m between scans, got {ways[k]:.6g} m "
            f"between scans {k} and {k + 1}"
        )


def check_points(points: Array, name: str, gaps: bool = False) -> None:
    """Raise InputError unless the coordinates `points` (..., 2) [m] are finite and within those of any place.

    Args:
        points: The points.
        name: What they are called in the error.
        gaps: Whether some may be NaN, which are not there.
    """
    good = np.abs(points) <= FARTHEST_M
    if gaps:
        good |= np.isnan(points)
    if not good.all():
        raise InputError(f"`{name}` must lie within {FARTHEST_M:g} m, got {shown(points[~good][0])}")


def check_times(times_s: Array, name: str) -> None:
    """Raise InputError unless each of `times_s` (n,) [s] is finite and of an age that clocks show."""
    good = np.abs(times_s) <= LATEST_S
    if not good.all():
        raise InputError(f"`{name}` must be finite and within {LATEST_S:g} s, got {shown(times_s[~good][0])}")


def cell_numbers(cells: Array) -> NDArray[np.int64]:
    """Return the whole cells that places, in cells from the origin, lie in: the one way from a place to an index.

    Raises:
        InputError: If a place is not finite, or so far away that no map reaches there.
    """
    if not (np.abs(cells) <= _MOST_INDEX).all():
        raise InputError(
            "a place lies where no map reaches: a pose or a range is wrong, or the cells are too small; got "
            f"{shown(np.abs(cells).max())} cells from the origin"
        )
    return np.floor(cells).astype(np.int64)


def check_size(columns: float, rows: float, cell: float, most: float, what: str = "the map") -> None:
    """Raise InputError if a grid of `columns` x `rows` cells of side `cell` [m] has more than `most` cells."""
    if not float(columns) * float(rows) <= most:
        raise InputError(
            f"{what} would grow to {columns * cell:.10g} x {rows * cell:.10g} m in cells of {cell:g} m; {most:.0f} "
            "cells are the most: a pose or a range is wrong, or the cells are too small"
        )


@contextmanager
def memory_for(what: str) -> Iterator[None]:
    """Say, where memory runs out inside, what it ran out for.

    Raises:
        InputError: In place of the MemoryError: `what` has become too large for this machine.
    """
    try:
        yield
    except MemoryError as error:
        raise InputError(f"no memory is left for {what}: {str(error)[:120]}") from error


@dataclass(frozen=True)
class _Rule:
    """What a field of a configuration must be: numbers of one kind within bounds."""

    name: str
    whole: bool
    within: Within | None
    count: int | None  # of a tuple; 0: any; None: it is one number
    optional: bool


def check_numbers(config: object) -> None:
    """Check each number of a configuration, a dataclass: of its kind, finite, and within the bounds of its type.

    A field of type `int` or `float`, or a tuple of them, has the bounds that its type says (`Within`); without any it
    must be 0 or of a size that no sum of squares overflows or loses. Parts of it check themselves.

    Raises:
        InputError: Naming the field, the rule and the value.
    """
    for rule in _rules(type(config)):
        value = getattr(config, rule.name)
        if value is None and rule.optional:
            continue
        if rule.count is None:
            _check_number(rule, value, value)
            continue
        if not isinstance(value, (tuple, list)) or (rule.count and len(value) != rule.count):
            raise InputError(f"`{rule.name}` must be {rule.count or 'some'} numbers, got {shown(value)}")
        for number in value:
            _check_number(rule, number, value)


def check_words(config: object) -> None:
    """Check each field of a configuration, a dataclass, that is a word (`str`) or says yes or no (`bool`) to be one.

    Raises:
        InputError: Naming the field, the rule and the value.
    """
    hints = get_type_hints(type(config))
    for field in fields(config):  # pyright: ignore[reportArgumentType]
        kind, value = hints[field.name], getattr(config, field.name)
        if kind in (str, bool) and not isinstance(value, kind):
            rule = "a word" if kind is str else "true or false"
            raise InputError(f"`{field.name}` must be {rule}, got {shown(value)}")


def check_positive(config: object, *names: str) -> None:
    """Check that fields of a configuration are above 0.

    Args:
        config: A dataclass of numbers, or an object with such attributes.
        names: Of the fields; without any it is all of them.

    Raises:
        InputError: Naming the field and the value.
    """
    for name in names or vars(config):
        value = getattr(config, name)
        if not value > 0:  # NaN is not, either
            raise InputError(f"`{name}` must be positive, got {value}")


def _check_number(rule: _Rule, given: object, value: object) -> None:
    if isinstance(given, (bool, np.bool_)) or not isinstance(given, Integral if rule.whole else Real):
        raise InputError(f"`{rule.name}` must be a {'whole ' * rule.whole}number, got {shown(value)}")
    number: Any = given  # one that can be compared, as `Real` does not say
    if rule.within:
        low, high = rule.within
        if not low <= number <= high:
            raise InputError(f"`{rule.name}` must be within {low:g} .. {high:g}, got {shown(value)}")
    elif rule.whole:
        if not -_MOST_COUNT <= number <= _MOST_COUNT:
            raise InputError(f"`{rule.name}` must be within {-_MOST_COUNT} .. {_MOST_COUNT}, got {shown(value)}")
    elif not (number == 0 or _LEAST <= abs(number) <= _MOST):
        raise InputError(f"`{rule.name}` must be 0 or of a size within {_LEAST:g} .. {_MOST:g}, got {shown(value)}")


@cache
def _rules(kind: type) -> tuple[_Rule, ...]:
    """Return the rules of the fields of a dataclass that are numbers."""
    hints = get_type_hints(kind, include_extras=True)
    return tuple(rule for field in fields(kind) for rule in _rule(field.name, hints[field.name]))


def _rule(name: str, hint: Any) -> Iterator[_Rule]:
    within, optional, count = None, False, None
    if NoneType in get_args(hint):
        optional, hint = True, next(part for part in get_args(hint) if part is not NoneType)
    if get_origin(hint) is Annotated:
        hint, *extras = get_args(hint)
        within = next((extra for extra in extras if isinstance(extra, Within)), None)
    if get_origin(hint) is tuple:
        kinds = get_args(hint)
        count, hint = (0 if Ellipsis in kinds else len(kinds)), kinds[0]
    if hint in (int, float) and not is_dataclass(hint):
        yield _Rule(name, hint is int, within, count, optional)


def plain_kind(hint: Any) -> Any:
    """Return the type of a field without its bounds."""
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint
