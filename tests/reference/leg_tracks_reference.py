"""What the kernels of `leg_kernels.py` do, in plain numpy; the tests compare them."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = NDArray[np.intp]
Tracks = NDArray[np.void]


def moved(legs: Tracks) -> Array:
    """Return (n,) how large the area is that each of `legs` has been in [m]."""
    size = legs["high"] - legs["low"]
    return np.sqrt(size[:, 0] ** 2 + size[:, 1] ** 2)


def promising(legs: Tracks, first: int, c_min: float, unseen_s: float) -> Rows:
    """Return (k,) the rows from `first` on that are believed in and were seen of late."""
    lone = legs[first:]
    return first + np.flatnonzero((lone["confidence"] > c_min) & (lone["unseen_s"] <= unseen_s))


def still(legs: Tracks, first: int, match: Rows, age_s: float, least: float, count: int) -> NDArray[np.bool_]:
    """Return (`count`,) the detections of old tracks from row `first` on that moved less than `least`."""
    old = (legs["age_s"] > age_s) & (moved(legs) < least) & (np.arange(len(legs)) >= first)
    found = np.zeros(count, dtype=bool)
    found[match[old & (match >= 0)]] = True
    return found


def carry_hidden(legs: Tracks, people: Tracks, match: Rows) -> None:
    """Move the unseen legs of `people` along with them."""
    x = np.repeat(people["x"], 2, axis=0)
    x[0::2, :2] += people["offset"]
    x[1::2, :2] -= people["offset"]
    hidden = np.flatnonzero(match[: len(x)] < 0)
    legs["x"][hidden] = x[hidden]


def human_places(people: Tracks, legs: Tracks, least: float, lost: Array) -> Array:
    """Return (h, 2) where people, their legs, lone tracks that moved `least`, and the `lost` are."""
    owned = 2 * len(people)
    walkers = legs["x"][owned:][moved(legs[owned:]) >= least]
    return np.concatenate((people["x"][:, :2], legs["x"][:owned, :2], walkers[:, :2], lost))


def unmatched(match: Rows, count: int) -> Rows:
    """Return (k,) which of `count` detections belong to no track."""
    return np.setdiff1d(np.arange(count), match)


def seen_now(legs: Tracks, people: int) -> tuple[Rows, Rows]:
    """Return the rows (k,) of tracks seen in the last scan, and the person (k,) of each; -1 for nobody."""
    rows = np.flatnonzero(legs["unseen_s"] == 0.0)
    return rows, np.where(rows < 2 * people, rows // 2, -1)


def since_leg(legs: Tracks, people: int) -> Array:
    """Return (`people`,) the time since a leg of each person was seen apart [s]."""
    return np.asarray(legs["unseen_s"][: 2 * people].reshape(-1, 2).min(axis=1))
