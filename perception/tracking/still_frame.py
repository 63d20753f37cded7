"""How far the odometry frame stands still: only then does memory of places in it tell people from things.

In a frame that stands still, a wall is met again where it was. How often it is, is measured from scan to scan; nothing
is matched and nothing is assumed of the odometry. So a look back tells a walker from a thing under good odometry, and
tells nothing where the odometry is wrong or missing, or where there is nothing but grass, another one in every scan.
There, who keeps the place before a laser that turns may be thought to run through the frame.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ...slam.bounds import Within, check_numbers, check_positive
from ...slam.view_kernel import kernel
from ..legs.detection_kernel import are_wide


@dataclass(frozen=True, kw_only=True)
class StillFrameConfig:
    """How the frame is judged.

    Attributes:
        points: At most so many returns of a scan are asked for, evenly.
        memory_s: Time constant over which scans are judged together: a turn in which the odometry slips lasts about as
            long [s].
        doubt: Returns that must be asked before they count as much as not knowing does.
    """

    points: Annotated[int, Within(1, 100_000)] = 20
    memory_s: float = 1.0
    doubt: float = 10.0

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "points", "memory_s", "doubt")


FRAME = np.dtype([("asked", np.float64), ("missed", np.float64), ("laser", np.float64, 3)])
"""Returns that were asked, lately, and of how many the place was empty; and T_odom_lidar (3,) of the last scan."""


@kernel
def judge_frame(frame, shares, dt, memory_s):
    """Take the `shares` (n, 2) of recent scans in which the places of walls were empty, and occupied, into a `FRAME`.

    The frame is common to all of them, so the middle one tells of it; glass, doors and who stands before a wall are
    outliers.
    """
    kept = np.exp(-dt / memory_s)
    count, middle = middle_miss(shares)
    frame.asked, frame.missed = kept * frame.asked + count, kept * frame.missed + count * middle


@kernel
def stillness(frame, doubt):
    """Return how far the frame stands still, in [0, 1].

    1 where a wall is met again three times in four: people and glass hide the rest. 0 where as often as not, or where
    no wall has been seen yet.
    """
    missed = (frame.missed + 0.5 * doubt) / (frame.asked + doubt)
    return min(max(2.0 - 4.0 * missed, 0.0), 1.0)


@kernel
def unjudged(frame, doubt):
    """Return how far nobody can say whether the frame stands still, in [0, 1]: 1 where no wall has been seen lately."""
    return doubt / (frame.asked + doubt)


@kernel
def middle_miss(shares):
    """Return how many of the places with `shares` (n, 2) tell, and the median of how often these were empty."""
    missed = np.empty(len(shares))
    count = 0
    for i in range(len(shares)):
        told = shares[i, 0] + shares[i, 1]
        if told > 0.0:
            missed[count] = shares[i, 0] / told
            count += 1
    return count, (np.median(missed[:count]) if count else 0.0)


@kernel
def points_of_walls(points, start, end, most):
    """Return (j, 2) some of `points` (k, 2) in clusters, from `start` (m,) to `end` (m,), too wide to be anybody.

    They are every so-manieth of them, so that they are at most `most`.
    """
    wide, count = are_wide(points, start, end), 0
    for c in range(len(start)):
        count += end[c] - start[c] if wide[c] else 0
    step = max(1, int(np.ceil(count / most)))
    kept, met = np.empty(((count + step - 1) // step, 2)), 0
    for c in range(len(start)):
        if wide[c]:
            for i in range(start[c], end[c]):
                if met % step == 0:
                    kept[met // step, 0], kept[met // step, 1] = points[i, 0], points[i, 1]
                met += 1
    return kept
