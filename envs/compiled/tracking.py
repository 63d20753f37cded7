"""Leg detector, tracker and choice of the leader for many worlds: the very kernels of the onboard stack, in a loop."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.selection import Company, LeaderNumbers, forget_leader, select
from ...perception.legs.detection_kernel import Beams, Splitting, find_legs
from ...perception.legs.forest_kernel import PackedForest
from ...perception.legs.range_view import view_of
from ...perception.tracking import following
from ...perception.tracking.evidence import probability
from ...perception.tracking.local_grid import make_pages
from ...perception.tracking.numbers import Numbers
from ...perception.tracking.tracks import Tracks, forget, has_room, hypotheses_of, tracks_of
from ...slam.geometry import composed
from ...slam.processes.turns import next_slice
from ...slam.rigid_kernel import moved_points
from ...slam.view_kernel import inner_kernel, kernel
from .entries import leader_entry, people_entry
from .episodes import REST, STEP

Array = NDArray[np.float64]

TRACKS, CELLS = 1, 2
"""What a world may have no room for."""


class TrackingRules(NamedTuple):
    """What never changes: the laser, and the numbers of detector, tracker and selector."""

    beams: Beams
    splitting: Splitting
    forest: PackedForest
    tracker: Numbers
    selector: LeaderNumbers


class Knowledge(NamedTuple):
    """What the trackers of w worlds know.

    Attributes:
        tracks: Of people.
        leaders: (w,) of `LEADER`.
        time_s: (w,) of the last scan [s].
        lacking: (w,) what there was no room for in the last scan, `TRACKS` or `CELLS`, 0 for nothing; where anything
            was, that scan is as if it had not been.
    """

    tracks: Tracks
    leaders: NDArray[Any]
    time_s: Array
    lacking: NDArray[np.int8]


class Swept(NamedTuple):
    """What the robots measured: (w, beams) ranges [m], (w,) when [s], and (w, 3) where, by odometry."""

    ranges: Array
    time_s: Array
    odometry: Array


class Read(NamedTuple):
    """What is told of it: entries of the observation, how many people are known, and the leader's track."""

    leader: NDArray[np.float32]
    people: NDArray[np.float32]
    tracked: NDArray[np.int64]
    track: NDArray[np.int64]


@kernel
def track_worlds(turns, what, rules, minds, swept, read):
    """Track people in the sweeps of the worlds that did `what` (w,), ask who leads, and tell of it; `turns` at them."""
    first, end = next_slice(turns)
    while first < end:
        for w in range(first, end):
            if what[w] != REST:
                _track(w, what[w], rules, minds, swept, read)
        first, end = next_slice(turns)


@inner_kernel
def _track(w, what, rules, minds, swept, read):
    """Do so in world w."""
    tracks, leader = tracks_of(minds.tracks, w), minds.leaders[w]
    if what != STEP:
        forget(tracks)
        forget_leader(leader)
    found = find_legs(swept.ranges[w], rules.beams, rules.splitting, rules.forest)
    pose, time_s, c = swept.odometry[w], swept.time_s[w], rules.tracker
    view = view_of(swept.ranges[w], rules.beams, lidar_at(pose, rules.beams.mount))
    points = moved_points(view.laser, found.points)
    if not has_room(tracks, np.count_nonzero(found.confidence > 0.0)):
        minds.lacking[w] = TRACKS
    elif not make_pages(tracks.cells, points, pose, c.things_resolution, time_s, c.things_forget_s):
        minds.lacking[w] = CELLS
    if minds.lacking[w]:
        return
    dt = time_s - minds.time_s[w] if what == STEP else 1.0 / c.motion_reference_rate_hz
    minds.time_s[w] = time_s
    sight = following.follow(tracks, found, view, pose, time_s, dt, c)
    following.maintain(tracks, sight, view, pose, points, time_s, dt, c)
    company = company_of(tracks, c)
    row = select(leader, company, pose, time_s, rules.selector)
    _tell(w, leader, row, company, pose, read)


@inner_kernel
def lidar_at(pose, mount):
    """Return (3,) T_odom_lidar of a laser at `mount` (3,) on a robot at `pose` (3,)."""
    x, y, theta = composed(pose[0], pose[1], pose[2], mount[0], mount[1], mount[2])
    return np.array((x, y, theta))


@inner_kernel
def company_of(tracks, c):
    """Return who is tracked now."""
    told = following.told_people(hypotheses_of(tracks), c)
    count = len(told)
    ids, x, confidence = np.empty(count, np.int64), np.empty((count, 4)), np.empty(count)
    unseen_s, age_s = np.empty(count), np.empty(count)
    for i in range(count):
        one = tracks.hypotheses[told[i]]
        ids[i], confidence[i], unseen_s[i], age_s[i] = one.id, probability(one.odds), one.unseen_s, one.placed_s
        for k in range(4):
            x[i, k] = one.x[k]
    return Company(ids, x, confidence, unseen_s, age_s)


@inner_kernel
def _tell(w, leader, row, company, odometry, read):
    """Write what is told of world w, where `row` of the company leads, or nobody (-1)."""
    count = len(company.ids)
    leader_entry(leader, odometry, read.leader[w])
    people_entry(row, odometry, company, np.empty(count, np.bool_), read.people[w])
    read.tracked[w], read.track[w] = count, leader.track
