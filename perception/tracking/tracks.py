"""All tracks of many trackers as arrays: those of legs, those of the people whom the legs belong to, and the lost.

One scan touches a dozen tracks, so that calls would cost more than sums: kernels take a scan from its clusters to its
people in one call, for one tracker or for one after the other of a block.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel, kernel
from .local_grid import Cells, cells_of, free_all, no_cells

LEGS, PEOPLE, LOST, NEXT_ID = range(4)
"""Columns of `Tracks.counts`."""

LEG = np.dtype(
    [
        ("x", np.float64, 4),  # state (x, y, vx, vy) in the odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("confidence", np.float64),
        ("seen", np.float64, 2),  # where it was last seen
        ("first", np.float64, 2),  # where the track began
        ("low", np.float64, 2),  # smallest x and y it has been at [m]
        ("high", np.float64, 2),  # largest
        ("age_s", np.float64),
        ("unseen_s", np.float64),
        ("owned_s", np.float64),  # time as this person's leg; 0: nobody's
    ]
)
PERSON = np.dtype(
    [
        ("id", np.int64),
        ("x", np.float64, 4),  # state (x, y, vx, vy) in the odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("confidence", np.float64),
        ("offset", np.float64, 2),  # from the centre to the first leg; the second is opposite [m]
        ("age_s", np.float64),
        ("unseen_s", np.float64),
        ("camera_s", np.float64),  # time since a camera saw it; inf: never
    ]
)


class Tracks(NamedTuple):
    """What w trackers know; `tracks_of` has one of them, without the first axis, as kernels take it.

    Attributes:
        legs: (w, room) of `LEG`. Rows 2 i and 2 i + 1 are the legs of person i; those after them are tentative,
            nobody's yet.
        apart: (w, room, room, 2) running mean of the vector between two leg tracks [m]. The legs of one person swing
            past each other, so their mean is a step's width; legs of two people side by side keep their distance.
        people: (w, room) of `PERSON`, confirmed.
        lost: (w, room) of `PERSON`, whose track has ended, to be re-identified.
        counts: (w, 4) how many `LEGS`, `PEOPLE` and `LOST` there are, and the next person's number.
        cells: See `LocalGrid`.
    """

    legs: NDArray[Any]
    apart: NDArray[np.float64]
    people: NDArray[Any]
    lost: NDArray[Any]
    counts: NDArray[np.int64]
    cells: Cells


def no_tracks(trackers: int, room: int = 48, cells: Cells | None = None) -> Tracks:
    """Return trackers that know nothing but `cells`, with room for so many tracks each; a crowded office has thirty."""
    return Tracks(
        legs=np.zeros((trackers, room), LEG),
        apart=np.zeros((trackers, room, room, 2)),
        people=np.zeros((trackers, room), PERSON),
        lost=np.zeros((trackers, room), PERSON),
        counts=np.zeros((trackers, 4), np.int64),
        cells=cells or no_cells(trackers),
    )


def with_room(tracks: Tracks, room: int) -> Tracks:
    """Return the same with more room."""
    grown = no_tracks(len(tracks.counts), room, tracks.cells)._replace(counts=tracks.counts)
    before = tracks.legs.shape[1]
    grown.apart[:, :before, :before] = tracks.apart
    for new, old in ((grown.legs, tracks.legs), (grown.people, tracks.people), (grown.lost, tracks.lost)):
        new[:, :before] = old
    return grown


@kernel
def tracks_of(tracks, w):
    """Return what tracker w knows."""
    return Tracks(
        tracks.legs[w], tracks.apart[w], tracks.people[w], tracks.lost[w], tracks.counts[w],
        cells_of(tracks.cells, w),
    )  # fmt: skip


@kernel
def has_room(tracks, detections):
    """Return whether there is room for the tracks of one more scan with so many `detections`."""
    legs, lost, room = tracks.counts[LEGS], tracks.counts[LOST], len(tracks.legs)
    return legs + detections + 3 <= room and lost + tracks.counts[PEOPLE] <= room  # a leg alone has a hidden one beside


@inner_kernel
def forget(tracks):
    """Let one tracker know nothing."""
    tracks.counts[:] = 0
    free_all(tracks.cells)


@kernel
def take(tracks, order):
    """Keep the leg tracks `order` (k,), in that order."""
    count = tracks.counts[LEGS]
    same = len(order) == count
    for i in range(len(order)):
        same = same and order[i] == i
    if same:
        return
    legs, apart = tracks.legs[:count].copy(), tracks.apart[:count, :count].copy()
    for i in range(len(order)):
        tracks.legs[i] = legs[order[i]]
        for j in range(len(order)):
            for k in range(2):
                tracks.apart[i, j, k] = apart[order[i], order[j], k]
    tracks.counts[LEGS] = len(order)


@kernel
def begin(tracks, z, d, variance):
    """Begin tentative leg tracks at `z` (k, 2) with zero velocity (eq. 5) and the detections' confidence `d` (k,)."""
    before, count = tracks.counts[LEGS], tracks.counts[LEGS] + len(z)
    legs = tracks.legs
    x, p = legs["x"], legs["p"]
    for i in range(before, count):
        for k in range(2):
            place = z[i - before, k]
            x[i, k], x[i, k + 2], p[i, 2 * k] = place, 0.0, variance
            legs["seen"][i, k] = legs["first"][i, k] = legs["low"][i, k] = legs["high"][i, k] = place
        p[i, 1], legs["confidence"][i] = 0.0, d[i - before]
        legs["age_s"][i] = legs["unseen_s"][i] = legs["owned_s"][i] = 0.0
    for i in range(count):
        for j in range(before if i < before else 0, count):
            for k in range(2):
                tracks.apart[i, j, k] = x[i, k] - x[j, k]
    tracks.counts[LEGS] = count


@inner_kernel
def keep_lost(tracks, kept):
    """Keep those of the lost that are `kept` (n,)."""
    count = 0
    for i in range(len(kept)):
        if kept[i]:
            tracks.lost[count] = tracks.lost[i]
            count += 1
    tracks.counts[LOST] = count


@inner_kernel
def count_owned(tracks, dt):
    """Add `dt` seconds to the time that each leg has been its person's; tentative tracks have none."""
    owned, people = tracks.legs["owned_s"], tracks.counts[PEOPLE]
    for i in range(tracks.counts[LEGS]):
        owned[i] = owned[i] + dt if i < 2 * people else 0.0
