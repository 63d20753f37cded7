"""The numbers of the error model, and the file that they are shipped in."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError, shown

Array = NDArray[np.float64]

SHIPPED = Path(__file__).with_name("tracker_errors.json")
"""Fitted by `tagalong train tracker-errors`; the file says to what, and how."""

BORN, MISSED, FOUND, LOST, SECOND, PLACE, DOUBT = range(7)
"""Rows of `TrackerErrors.weights`: what depends on how a person is seen."""
QUANTITIES = ("born_per_s", "missed_per_s", "found_per_s", "lost_per_s", "second_per_s", "place_m", "doubt")
"""Their names."""
SIGHT = (
    "one", "range_m", "beams_log2", "hidden", "out_of_sight", "bearing_rad", "speed_mps", "off_m", "seen_log2", "way_m",
)  # fmt: skip
"""Columns of them: how a person is seen, see `kernel.seen`, how far the track is off, for how long who is missed was
seen, see `kernel.seen_for`, and how far who becomes known has come in sight, see `kernel.come_on`."""


class TrackerErrors(NamedTuple):
    """What the tracker gets wrong; kernels take it as it is.

    A person is unknown, seen, or believed to be somewhere without being seen; the tracker's own three states. What
    leads from one to another are rates, exp(weights . sight) per second, where `sight` says how the person is seen.
    Errors are Gaussian with an exponential correlation (Ornstein and Uhlenbeck 1930).

    Attributes:
        weights: (7, 10) logarithms: rates at which an unknown person becomes known, a seen one is missed, a missed one
            is found again or given up, a seen one gets a second, false track [1/s]; standard deviation of a seen
            person's place, each axis [m]; 1 - confidence.
        place_s: Correlation time of the error of the place [s].
        delay_s: How old a seen place is [s].
        motion_lag_s: Time constant with which a tracked velocity follows the true one [s].
        motion_mps: Standard deviation of the rest of a velocity's error, each axis [m/s].
        motion_s: Its correlation time [s].
        unseen_mps: Standard deviation of what a velocity is off by, besides, while its person is not seen, each axis
            [m/s].
        longest_unseen_s: Who has not been seen for so long is given up [s].
        swap_per_s: Rate at which two people who are seen within `SWAP_M` are taken for each other [1/s].
        swapped_s: For how long, in the mean [s].
        second_stands: Share of second tracks that stay where they begin; the others go with the person.
        second_m: Standard deviation of their distance from the person, each axis [m].
        second_life_s: How long they last, in the mean [s].
        thing_per_s: Rate at which a thing is taken for a person [1/s].
        thing_life_s: For how long, in the mean [s].
        false_confidence: Of such tracks.
    """

    weights: Array
    place_s: float
    delay_s: float
    motion_lag_s: float
    motion_mps: float
    motion_s: float
    unseen_mps: float
    longest_unseen_s: float
    swap_per_s: float
    swapped_s: float
    second_stands: float
    second_m: float
    second_life_s: float
    thing_per_s: float
    thing_life_s: float
    false_confidence: float


NUMBERS = tuple(name for name in TrackerErrors._fields if name != "weights")


def named(errors: TrackerErrors) -> dict[str, Any]:
    """Return the numbers by name, as a file holds them."""
    table = {
        name: dict(zip(SIGHT, row, strict=True)) for name, row in zip(QUANTITIES, errors.weights.tolist(), strict=True)
    }
    return {"weights": table, **{name: getattr(errors, name) for name in NUMBERS}}


def from_named(table: Mapping[str, Any], source: object) -> TrackerErrors:
    """Return the numbers of a table as `named` makes it.

    Raises:
        InputError: Naming `source`, if one is missing or is no finite number, or a time is not positive.
    """
    try:
        weights = np.array([[float(table["weights"][row][column]) for column in SIGHT] for row in QUANTITIES])
        numbers = {name: float(table[name]) for name in NUMBERS}
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{source}: errors of a tracker need a number for each name, got {shown(error)}") from error
    if not (np.isfinite(weights).all() and all(np.isfinite(value) and value >= 0.0 for value in numbers.values())):
        raise InputError(f"{source}: errors of a tracker must be finite, and none but weights negative")
    for name, value in numbers.items():
        if name.endswith("_s") and not name.endswith(("per_s", "delay_s")) and value == 0.0:
            raise InputError(f"{source}: `{name}` must be positive [s], got 0")
    return TrackerErrors(weights=weights, **numbers)


def read_tracker_errors(path: Path) -> TrackerErrors:
    """Return the numbers in a file that `tagalong train tracker-errors` wrote.

    Raises:
        InputError: If there is no such file, or it holds something else.
    """
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: no errors of a tracker can be read ({error})") from error
    if not isinstance(table, dict) or not isinstance(table.get("errors"), dict):
        raise InputError(f"{path}: there is no table `errors` in it")
    return from_named(table["errors"], path)


@cache
def chosen_errors(name: str) -> TrackerErrors:
    """Return the numbers that the package ships, for "shipped", or those in the file `name`.

    Raises:
        InputError: As of `read_tracker_errors`.
    """
    return read_tracker_errors(SHIPPED if name == "shipped" else Path(name))
