"""All that many trackers know as arrays: the people that may be, those who are lost, what was seen, where things stand.

One scan touches a dozen hypotheses, so that calls would cost more than sums: kernels take a scan from its clusters to
its people in two calls, for one tracker or for one after the other of a block.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_kernel, kernel
from ..legs.recent_views import RecentViews, RecentViewsConfig, forget_views, no_views, views_of
from .local_grid import PAGES, Cells, cells_of, free_all, no_cells
from .still_frame import FRAME

HYPOTHESES, LOST, NEXT_ID, NEXT_SERIAL = range(4)
"""Columns of `Tracks.counts`."""

PATH = 8
"""So many former places of a hypothesis are kept."""

HYPOTHESIS = np.dtype(
    [
        ("id", np.int64),  # number of the person; -1: not believed in yet
        ("serial", np.int64),  # which one it is of all that ever began
        ("x", np.float64, 4),  # state (x, y, vx, vy) of the centre between the legs, odometry frame
        ("p", np.float64, 3),  # covariance, see kalman.py
        ("odds", np.float64),  # log odds that it is a person
        ("looks", np.float64),  # how many looks from elsewhere its evidence comes from
        ("evidence", np.float64),  # mean log likelihood ratio of a look, person against thing
        ("born", np.float64, 2),  # where it began [m]
        ("moved", np.float64),  # how far it has moved of its own from there, as far as that is known [m]
        ("swing", np.float64),  # how far it has ever moved before the laser within that time [m]
        ("missing", np.float64),  # what being unseen says: log likelihood ratio, 0 while it is seen
        ("viewed", np.float64, 2),  # where it was, in the laser's frame, at the last look [m]
        ("stood", np.float64, 2),  # and in the odometry frame [m]
        ("legs", np.float64, (2, 2)),  # of both legs from the centre [m]
        ("leg_unseen_s", np.float64, 2),  # since each leg was seen [s]
        ("clusters", np.int64, 2),  # rows of the clusters that are these legs in this scan; -1: none
        ("path", np.float64, (PATH, 2)),  # former places [m]
        ("seen", np.float64, (PATH, 2)),  # of a leg then, in the laser's frame [m]
        ("marked_s", np.float64),  # age at which the last of them was written [s]
        ("stands_s", np.float64),  # for how long it has been seen without moving since it has a number [s]
        ("places", np.int64),  # how many were written
        ("age_s", np.float64),
        ("placed_s", np.float64),  # for how long its place has been known without a break [s]
        ("unseen_s", np.float64),
    ]
)
LOST_PERSON = np.dtype([("id", np.int64), ("x", np.float64, 4), ("seen_s", np.float64)])
"""Somebody whose hypothesis has ended: number, last state, and when last seen [s]."""


class Tracks(NamedTuple):
    """What w trackers know; `tracks_of` has one of them, without the first axis, as kernels take it.

    Attributes:
        hypotheses: (w, room) of `HYPOTHESIS`, people or not.
        lost: (w, room) of `LOST_PERSON`, to be re-identified.
        counts: (w, 4) how many `HYPOTHESES` and `LOST` there are, the next person's number, and hypothesis'.
        frame: (w, 1) of `FRAME`.
        views: What was seen a moment ago.
        cells: Where things stand, see `LocalGrid`.
    """

    hypotheses: NDArray[Any]
    lost: NDArray[Any]
    counts: NDArray[np.int64]
    frame: NDArray[Any]
    views: RecentViews
    cells: Cells


def no_tracks(trackers: int, beams: int, views: RecentViewsConfig, room: int = 64, pages: int = PAGES) -> Tracks:
    """Return trackers that know nothing.

    Args:
        trackers: How many.
        beams: Of their lasers.
        views: How many scans are kept.
        room: Hypotheses that each has room for at first; a crowded office has fifty.
        pages: The same of the grid of things.
    """
    return Tracks(
        hypotheses=np.zeros((trackers, room), HYPOTHESIS),
        lost=np.zeros((trackers, room), LOST_PERSON),
        counts=np.zeros((trackers, 4), np.int64),
        frame=np.zeros((trackers, 1), FRAME),
        views=no_views(trackers, beams, views),
        cells=no_cells(trackers, pages),
    )


def with_room(tracks: Tracks) -> Tracks:
    """Return the same with twice as much room for hypotheses."""
    trackers, room = tracks.hypotheses.shape
    hypotheses = np.zeros((trackers, 2 * room), HYPOTHESIS)
    lost = np.zeros((trackers, 2 * room), LOST_PERSON)
    hypotheses[:, :room], lost[:, :room] = tracks.hypotheses, tracks.lost
    return tracks._replace(hypotheses=hypotheses, lost=lost)


@kernel
def tracks_of(tracks, w):
    """Return what tracker w knows."""
    return Tracks(
        tracks.hypotheses[w], tracks.lost[w], tracks.counts[w], tracks.frame[w], views_of(tracks.views, w),
        cells_of(tracks.cells, w),
    )  # fmt: skip


@kernel
def hypotheses_of(tracks):
    """Return (n,) the hypotheses of one tracker."""
    return tracks.hypotheses[: tracks.counts[HYPOTHESES]]


@kernel
def has_room(tracks, fresh):
    """Return whether there is room for so many `fresh` hypotheses, and for all others to be lost."""
    count, room = tracks.counts[HYPOTHESES], len(tracks.hypotheses)
    return count + fresh <= room and tracks.counts[LOST] + count + fresh <= room


@inner_kernel
def forget(tracks):
    """Let one tracker know nothing."""
    tracks.counts[:] = 0
    tracks.frame[0].asked, tracks.frame[0].missed = 0.0, 0.0
    forget_views(tracks.views)
    free_all(tracks.cells)


@inner_kernel
def keep_hypotheses(tracks, kept):
    """Keep those of the hypotheses that are `kept` (n,), in their order."""
    count = 0
    for i in range(len(kept)):
        if kept[i]:
            if count < i:
                tracks.hypotheses[count] = tracks.hypotheses[i]
            count += 1
    tracks.counts[HYPOTHESES] = count
