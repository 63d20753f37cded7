"""Compares what the error model does with what the real tracker does, on drives that it was not fitted to."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.tracker_errors.kernel import OUT_OF_SIGHT
from ..lab.statistics import Estimate, ratio, share, t_mean
from .tracker_drives import LEADER, SAME_M, SEEN, UNKNOWN, UNSEEN, TrackedDrive
from .tracker_fit import correlation_s, delay_s, followed

Flags = NDArray[np.bool_]
Statistic = Callable[[Sequence[TrackedDrive]], Estimate]
_FULL_LAG_S = 1.0  # with which velocities are followed to tell their noise from their lag


def _recall(near: float, far: float, in_sight: bool = True) -> Statistic:
    """Return the share of the people between two distances [m] who are tracked."""

    def there(drive: TrackedDrive) -> Flags:
        distance, hidden = drive.sight[:, :, 0], drive.sight[:, :, 2]
        return (distance >= near) & (distance < far) & ((hidden <= OUT_OF_SIGHT) == in_sight)

    return lambda drives: ratio(
        [int((there(d) & (d.phase != UNKNOWN) & (d.off <= SAME_M)).sum()) for d in drives],
        [int(there(d).sum()) for d in drives],
    )


def _per(count: Callable[[TrackedDrive], float], of: Callable[[TrackedDrive], float]) -> Statistic:
    return lambda drives: ratio([count(d) for d in drives], [of(d) for d in drives])


def _rms(phase: int, what: Callable[[TrackedDrive], NDArray[np.float64]]) -> Statistic:
    """Return the root of the mean square of an error (T, n, 2) of people of one phase."""

    def root(drives: Sequence[TrackedDrive]) -> Estimate:
        """Return the root, and the roots of the interval's ends."""
        squares = ratio(
            [float((what(d)[d.phase == phase] ** 2).sum()) for d in drives],
            [int((d.phase == phase).sum()) for d in drives],
        )
        mean, low, high = (float(np.sqrt(value)) for value in (squares.mean, squares.low, squares.high))
        return Estimate(mean, low, high, squares.n)

    return root


def _of_each(value: Callable[[Sequence[TrackedDrive]], float]) -> Statistic:
    return lambda drives: t_mean([value([drive]) for drive in drives if (drive.phase == SEEN).sum() > 100])


def _taken_for_another(drive: TrackedDrive) -> int:
    wrong = (drive.leads > LEADER).astype(int)
    return int((np.diff(wrong, prepend=0) > 0).sum())


def _first_known_s(drives: Sequence[TrackedDrive]) -> Estimate:
    """Return for how long people walk in sight within 4 m before they are tracked for the first time [s]."""
    times = []
    for drive in drives:
        sight = drive.sight
        shown = (sight[:, :, 0] < 4.0) & (sight[:, :, 2] <= OUT_OF_SIGHT) & (sight[:, :, 5] > 0.3)
        known = drive.phase != UNKNOWN
        for i in np.flatnonzero(known.any(axis=0) & shown.any(axis=0)):
            times.append(float(shown[: int(known[:, i].argmax()), i].sum()) * drive.dt)
    return t_mean(times)


def _tracked(drive: TrackedDrive) -> float:
    return float((drive.phase != UNKNOWN).sum())


STATISTICS: dict[str, Statistic] = {
    "recall in sight, 0 .. 2 m": _recall(0.0, 2.0),
    "recall in sight, 2 .. 4 m": _recall(2.0, 4.0),
    "recall in sight, 4 .. 6 m": _recall(4.0, 6.0),
    "recall in sight, 6 .. 10 m": _recall(6.0, 10.0),
    "recall out of sight, 0 .. 4 m": _recall(0.0, 4.0, in_sight=False),
    "tracked but not seen, share": _per(lambda d: float((d.phase == UNSEEN).sum()), _tracked),
    "walking in sight before tracked [s]": _first_known_s,
    "false tracks a scan": _per(lambda d: float(len(d.false)), lambda d: float(len(d.phase))),
    "false tracks seen, a scan": _per(lambda d: float(sum(f.seen for f in d.false)), lambda d: float(len(d.phase))),
    "leader seen, share of scans": _per(lambda d: float((d.leads == LEADER).sum()), lambda d: float(len(d.leads))),
    "another taken for the leader, a minute": _per(_taken_for_another, lambda d: len(d.leads) * d.dt / 60.0),
    "another taken for the leader, share of scans": _per(
        lambda d: float((d.leads > LEADER).sum()), lambda d: float(len(d.leads))
    ),
    "numbers changed, a tracked minute": _per(lambda d: float(d.switches), lambda d: _tracked(d) * d.dt / 60.0),
    "place error RMS, seen [m]": _rms(SEEN, lambda d: d.place - d.position),
    "place error RMS, not seen [m]": _rms(UNSEEN, lambda d: d.place - d.position),
    "velocity error RMS, seen [m/s]": _rms(SEEN, lambda d: d.motion - d.velocity),
    "velocity error RMS beside its lag [m/s]": _rms(SEEN, lambda d: d.motion - followed(d.velocity, _FULL_LAG_S, d.dt)),
    "correlation time of the place error [s]": _of_each(
        lambda drives: correlation_s(drives, lambda d: d.place - d.position)
    ),
    "delay of the place [s]": _of_each(delay_s),
    "confidence, seen": _per(lambda d: float(d.trust[d.phase == SEEN].sum()), lambda d: float((d.phase == SEEN).sum())),
    "tours done": lambda drives: share([d.ending == "tour_done" for d in drives]),
}
"""Name -> what it is of some drives; intervals hold drives for independent."""


def compare(real: Sequence[TrackedDrive], modelled: Sequence[TrackedDrive]) -> list[dict[str, Any]]:
    """Return a row for each statistic: both estimates, and whether their 95 % intervals meet."""
    rows = []
    for name, statistic in STATISTICS.items():
        ours, theirs = statistic(modelled), statistic(real)
        meet = not (ours.low > theirs.high or theirs.low > ours.high)
        rows.append({"statistic": name, "real": theirs, "modelled": ours, "agree": meet})
    return rows
