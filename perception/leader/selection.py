"""The one person to follow, scan by scan, as a kernel: chosen at onset, kept by number, looked for when lost.

Ye 2021, section II.C. Trackers give somebody who comes back the old number, so that it is enough to keep to the number
of who was chosen; where that one does not come back, whoever appears where the leader must be is taken for it.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import inner_view_kernel, view_kernel
from ..tracking.config import MotionConfig
from ..tracking.kalman import predict_state
from .config import LeaderConfig

LEADER = np.dtype(
    [
        ("known", np.bool_),  # whether anybody was chosen yet
        ("visible", np.bool_),  # whether a leg of the leader was seen in this scan
        ("id", np.int64),  # number of who was chosen
        ("track", np.int64),  # of the person who is the leader now; -1 while it is lost
        ("x", np.float64, 4),  # state (x, y, vx, vy), odometry frame
        ("p", np.float64, 3),  # covariance while it is lost, see kalman.py
        ("confidence", np.float64),  # of its track; 0 while it is lost
        ("unseen_s", np.float64),
        ("time_s", np.float64),  # of the last scan [s]
        ("chosen_s", np.float64),  # when it was chosen [s]
        ("waiting_s", np.float64),  # since when there are people [s]
    ],
    align=True,
)
"""What one robot knows of its leader; a GPU reads numbers only where they are aligned."""


class Company(NamedTuple):
    """Who is tracked in a scan, as kernels take it: see `People`."""

    ids: NDArray[np.int64]
    x: NDArray[np.float64]
    confidence: NDArray[np.float64]
    unseen_s: NDArray[np.float64]
    age_s: NDArray[np.float64]


class LeaderNumbers(NamedTuple):
    """Numbers of `LeaderConfig`, and those of `MotionConfig` by which a lost leader is looked for."""

    onset_s: float
    onset_near: float
    onset_far: float
    patience_s: float
    search_sigmas: float
    search_distance: float
    search_overlap_s: float
    q: float
    reference_rate_hz: float
    initial_variance: float
    coast_s: float


def leader_numbers(leader: LeaderConfig, motion: MotionConfig) -> LeaderNumbers:
    """Return the numbers as kernels take them."""
    named: dict[str, Any] = {**vars(motion), **vars(leader)}
    return LeaderNumbers(**{name: float(named[name]) for name in LeaderNumbers._fields})


def no_leaders(robots: int) -> NDArray[Any]:
    """Return (w,) of `LEADER` that nobody was chosen."""
    leaders = np.zeros(robots, LEADER)
    for one in leaders:
        forget_leader(one)
    return leaders


@view_kernel
def forget_leader(one):
    """Let nobody be chosen."""
    one.known = one.visible = False
    one.id = one.track = -1
    one.confidence = one.unseen_s = one.time_s = one.chosen_s = 0.0
    one.waiting_s = np.inf


@view_kernel
def select(one, company, robot, time_s, c):
    """Say who of the `company` at `time_s`, seen from `robot` (2,), is the leader; `one` (`LEADER`) remembers.

    Returns its row, or -1.
    """
    dt, one.time_s = time_s - one.time_s, time_s
    row = _chosen(one, company, robot, time_s, c)
    if row >= 0:
        one.known, one.id = True, company.ids[row]
    elif not one.known:
        return -1
    if row < 0:
        row = _row_of(company, one.id)
    if row < 0:
        row = _row_of(company, one.track)
    if row < 0:
        row = _looked_for(one, company, dt, c)
    if row < 0:
        one.track, one.visible, one.confidence = -1, False, 0.0
        one.unseen_s += dt
        return -1
    one.track, one.confidence, one.unseen_s = company.ids[row], company.confidence[row], company.unseen_s[row]
    one.visible = company.unseen_s[row] == 0.0
    one.p[0], one.p[1], one.p[2] = c.initial_variance, 0.0, c.initial_variance
    for k in range(4):
        one.x[k] = company.x[row, k]
    return row


@inner_view_kernel
def _row_of(company, number):
    for i in range(len(company.ids)):
        if number >= 0 and company.ids[i] == number:
            return i
    return -1


@inner_view_kernel
def _chosen(one, company, robot, time_s, c):
    """Return who is chosen in this scan; -1: nobody, or the time to choose is over."""
    if len(company.ids) == 0 or (one.known and time_s - one.chosen_s >= c.onset_s):
        return -1
    nearest, least = -1, np.inf
    for i in range(len(company.ids)):
        away = math.hypot(company.x[i, 0] - robot[0], company.x[i, 1] - robot[1])
        if away < least:
            nearest, least = i, away
    one.waiting_s = min(one.waiting_s, time_s)
    patient = not one.known and time_s - one.waiting_s < c.patience_s
    if least > (c.onset_near if patient else c.onset_far):
        return -1
    if not one.known:
        one.chosen_s = time_s
    return nearest


@inner_view_kernel
def _looked_for(one, company, dt, c):
    """Predict the leader; return who appears within its growing uncertainty, tracked since it was lost; -1: nobody."""
    fade = math.exp(-dt / c.coast_s)
    one.x[2] *= fade
    one.x[3] *= fade
    predict_state(one.x, one.p, dt, c.q * dt * c.reference_rate_hz)
    row, least = -1, min(c.search_distance, c.search_sigmas * math.sqrt(one.p[0]))
    for i in range(len(company.ids)):
        if company.age_s[i] <= one.unseen_s + dt + c.search_overlap_s:
            away = math.hypot(company.x[i, 0] - one.x[0], company.x[i, 1] - one.x[1])
            if away < least:
                row, least = i, away
    return row
