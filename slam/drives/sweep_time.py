"""How long a laser takes for a sweep, and scans as if all of their beams had been measured at once (deskewing).

A laser that spins measures one beam after the other: at 5 to 10 Hz a sweep takes a tenth to a fifth of a second. What a
robot that turns meanwhile sees is bent, by up to how far it turned, and is not what it sees of the same place while it
stands. Drivers say little of it that can be relied on: many leave the time between beams at zero, and one that fills
its message from the back says the opposite of what was. So the scans tell: those taken in the fastest turns are matched
with neighbours taken in other turns, once for each way in which the beams may have followed each other. What makes them
agree best is believed if it does so beyond chance; most lasers of 40 Hz and more turn out to measure at once.
"""

import math
from bisect import insort
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree
from scipy.stats import rankdata

from ..bounds import LEAST_SPACING
from ..errors import InputError, shown
from ..geometry import between, compose, inverse, transform_points
from ..logs.drive import RecordedDrive
from ..scan import LaserScan
from ..scan_to_scan.match import Matcher
from ..scan_to_scan.matchers import make_matcher
from .calibration import thinned

Array = NDArray[np.float64]

_PAIRS, _ENOUGH = 60, 10  # pairs of scans that are compared; fewer than the second tell nothing
NEIGHBOURS = 12
"""Among so many scans before and after one is its partner."""
_NEAR = (0.5, 1.0)  # [m, rad] partners are no farther apart, nor is a way between scans longer that can be one
_OTHERWISE = 0.03  # [rad] by so much a partner turned otherwise, from its scan to the next
_POINTS, _FAR = 20, 0.1  # least points of a scan; what lies farther off [m] is hidden from the partner
_SURE = 3.0  # standard deviations beyond chance
_PARTS = (1.0, 0.5, 0.25)  # a log may hold every second scan, or every fourth
_WORDS = ("clockwise", "ahead", "ended")  # fields of `SweepTime`, in its order
_OTHER_WAY = "counter-clockwise"
_LONGER = 1.5  # times the usual time between scans: some are missing


@dataclass(frozen=True)
class SweepTime:
    """When the beams of a scan are measured.

    Attributes:
        share: Of the time from one scan to the next, how much a whole turn of the laser takes.
        clockwise: Whether the beam of the largest bearing is the first.
        ahead: Whether a full circle begins straight ahead of the laser, not with its first or last beam.
        ended: Whether the time of a scan is that of its last beam, else that of its first.
    """

    share: float
    clockwise: bool = False
    ahead: bool = False
    ended: bool = False

    @classmethod
    def from_words(cls, words: str) -> Self:
        """Return the time that `words` name, such as "1 clockwise ended".

        Raises:
            InputError: If they name none.
        """
        share, *rest = words.split() or [""]
        try:
            number = float(share)
        except ValueError:
            number = math.nan
        said = set(rest)
        twice = len(said) < len(rest) or {"clockwise", _OTHER_WAY} <= said
        if not 0.0 < number <= 1.0 or twice or not said <= {*_WORDS, _OTHER_WAY}:
            what = f"a share in (0, 1] of the time between scans, and any of {_OTHER_WAY}, {', '.join(_WORDS)}"
            raise InputError(f"a laser's sweep is {what}, such as '1 clockwise', got {shown(words)}")
        return cls(number, *(word in said for word in _WORDS))

    @property
    def words(self) -> str:
        """What `from_words` takes; never a mere number, which a command line of ROS would not take for words."""
        rest = [word for word, is_so in zip(_WORDS[1:], (self.ahead, self.ended), strict=True) if is_so]
        return " ".join((f"{self.share:g}", self._order, *rest))

    @property
    def _order(self) -> str:
        return _WORDS[0] if self.clockwise else _OTHER_WAY

    @property
    def note(self) -> str:
        """What is done about it, in a sentence."""
        share = f"{self.share:.0%} of the time between scans"
        return f"a turn of the laser, {self._order}, takes {share}: its motion is taken out"

    def of(self, scan: LaserScan) -> Array:
        """Return (N,) how long from the scan's time each beam is measured, as a share of the time between scans."""
        turned = scan.bearings % (2.0 * np.pi) if self.ahead else scan.bearings - scan.bearings[0]
        if self.clockwise != self.ended:
            turned = turned.max(initial=0.0) - turned
        return self.share * turned / (2.0 * np.pi)


def deskewed(drive: RecordedDrive) -> RecordedDrive:
    """Return the drive with each beam where odometry says it was measured, if its scans say that it took time.

    The scans are then as if measured at once, at their time; their bearings are not evenly spaced any more. Else, and
    without odometry, it is the same drive.
    """
    found = sweep_time(drive)
    if found is None:
        return drive
    ways = _ways(drive, ended=found.ended)
    scans = [at_once(scan, way, found) for scan, way in zip(drive.scans, ways, strict=True)]
    return replace(drive, scans=scans, notes=(*drive.notes, found.note))


def sweep_time(drive: RecordedDrive) -> SweepTime | None:
    """Return when the beams of a drive's scans are measured; None: at once, or it cannot be told."""
    if len(drive) < 2:
        return None
    moments, question = _moments(drive), SweepQuestion(drive.scans[0])
    for first, second in _pairs(moments):
        question.ask(moments[first], moments[second])
    return question.answer


class Moment(NamedTuple):
    """A scan, and how the robot moved about its time.

    Attributes:
        scan: The scan.
        pose: (3,) T_odom_robot at its time.
        onward: (3,) where the robot is after the usual time between scans, seen from there; zero: not known.
        back: (3,) where it was so long before; zero: not known.
    """

    scan: LaserScan
    pose: Array
    onward: Array
    back: Array


class SweepQuestion:
    """When the beams of a laser's scans are measured, asked of pairs of scans between which the robot turned otherwise.

    The sixty pairs that did most so are the ones that count.

    Args:
        scan: Any of its scans.
    """

    def __init__(self, scan: LaserScan) -> None:
        self._candidates, self._matcher = _candidates(scan), make_matcher("plicp")
        self._told = list[tuple[float, list[float]]]()

    def ask(self, one: Moment, other: Moment) -> None:
        """Ask a pair of scans; one of too few points tells nothing."""
        otherwise = abs(one.onward[2] - other.onward[2])
        if len(self._told) == _PAIRS and otherwise <= self._told[0][0]:
            return
        row = _disagreements(one, other, [None, *self._candidates], self._matcher)
        if np.isfinite(row).all():
            insort(self._told, (otherwise, row))
            del self._told[:-_PAIRS]

    @property
    def answer(self) -> SweepTime | None:
        """When they are measured by all that was told; None: at once, or it cannot be told."""
        if len(self._told) < _ENOUGH:
            return None
        told = np.array([row for _, row in self._told])
        best = int(np.argmin(told[:, 1:].mean(axis=0)))
        return self._candidates[best] if _beyond_chance(told[:, 0] - told[:, 1 + best]) > _SURE else None


def _beyond_chance(gains: Array) -> float:
    """Return how far `gains` (n,) are above zero on the whole, in standard deviations of chance.

    The signed ranks tell (Wilcoxon 1945): a match that failed counts no more than any other.
    """
    ranks = np.sign(gains) * rankdata(np.abs(gains))
    return float(ranks.sum() / np.sqrt(np.square(ranks).sum())) if ranks.any() else 0.0


def at_once(scan: LaserScan, way: Array, time: SweepTime) -> LaserScan:
    """Return a scan as it would be if all beams were measured at its time.

    Args:
        scan: As it came.
        way: (3,) T_robot_next of the robot at the next scan; where `time` is `ended`, T_robot_before of the one before
            [m, m, rad].
        time: When the beams were measured.
    """
    return straightened(scan, way, time)[0]


def straightened(scan: LaserScan, way: Array, time: SweepTime) -> tuple[LaserScan, NDArray[np.intp]]:
    """Return `at_once`, and (N,) which beam of `scan` each of its beams is."""
    if not way.any():
        return scan, np.arange(len(scan))
    mount = np.asarray(scan.T_robot_lidar)
    moved = time.of(scan)[:, None] * compose(inverse(mount), compose(way, mount))
    met = scan.is_return
    ends = np.where(met, scan.ranges, 0.0)[:, None] * _directions(scan.bearings + moved[:, 2]) + moved[:, :2]
    turned = np.where(met, np.arctan2(ends[:, 1], ends[:, 0]) - scan.bearings, moved[:, 2])
    bearings = scan.bearings + np.remainder(turned + np.pi, 2.0 * np.pi) - np.pi
    away = np.clip(np.hypot(ends[:, 0], ends[:, 1]), scan.range_min, scan.range_max)
    order = np.argsort(bearings, kind="stable")
    apart = 2.0 * LEAST_SPACING * np.arange(len(order))
    ascending = np.maximum.accumulate(bearings[order] - apart) + apart
    return replace(scan, ranges=np.where(met, away, scan.ranges)[order], bearings=ascending), order


def _directions(bearings: Array) -> Array:
    return np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)


def _ways(drive: RecordedDrive, *, ended: bool) -> Array:
    """Return (n, 3) where the robot is after the usual time between scans, or was (`ended`), seen from each scan.

    Zero where that is not known.
    """
    ways = np.zeros((len(drive), 3))
    motions, steps_s = between(drive.odometry[:-1], drive.odometry[1:]), np.diff(drive.times_s)
    ways[:-1] = usual_ways(motions, steps_s, usual_step_s(drive.times_s))
    if ended:
        ways[1:] = inverse(ways[:-1])
        ways[0] = 0.0
    return ways


def usual_step_s(times_s: Array) -> float:
    """Return the usual time between scans taken at `times_s` (n,) [s]; 0: it is not known."""
    return max(0.0, float(np.median(np.diff(times_s)))) if len(times_s) > 1 else 0.0


def usual_ways(motions: Array, steps_s: Array, usual_s: float) -> Array:
    """Return (n, 3) how the robot moved in the usual time between scans.

    Args:
        motions: (n, 3) from scan to scan, in the robot's frame at the first of both.
        steps_s: (n,) how long those took [s].
        usual_s: The usual time [s]; 0: each is.
    """
    share = np.where(steps_s > _LONGER * usual_s, usual_s / np.maximum(steps_s, usual_s), 1.0) if usual_s else 1.0
    ways = motions * np.reshape(share, (-1, 1))
    ways[(np.hypot(ways[:, 0], ways[:, 1]) > _NEAR[0]) | (np.abs(ways[:, 2]) > _NEAR[1])] = 0.0
    return ways


def _moments(drive: RecordedDrive) -> list[Moment]:
    ways = (_ways(drive, ended=ended) for ended in (False, True))
    return [Moment(*all_of_one) for all_of_one in zip(drive.scans, drive.odometry, *ways, strict=True)]


def _pairs(moments: list[Moment]) -> list[tuple[int, int]]:
    """Return the scans of the fastest turns, each with the one nearby during which the robot turned most otherwise."""
    pairs, last = [], len(moments) - 1
    turns = np.array([moment.onward[2] for moment in moments[:last]])
    for new in np.argsort(-np.abs(turns), kind="stable")[:_PAIRS].tolist():
        low = max(0, new - NEIGHBOURS)
        partner = turned_otherwise(moments[new], moments[low : min(last, new + NEIGHBOURS + 1)])
        if partner is not None:
            pairs.append((low + partner, new))
    return pairs


def turned_otherwise(moment: Moment, others: Sequence[Moment]) -> int | None:
    """Return which of `others`, near the same place, the robot turned most otherwise at; None: nowhere enough."""
    if not others:
        return None
    apart = between(moment.pose, np.array([other.pose for other in others]))
    reach = (np.hypot(apart[:, 0], apart[:, 1]) <= _NEAR[0]) & (np.abs(apart[:, 2]) <= _NEAR[1])
    otherwise = np.where(reach, np.abs([other.onward[2] - moment.onward[2] for other in others]), 0.0)
    return int(np.argmax(otherwise)) if otherwise.max() > _OTHERWISE else None


def _candidates(scan: LaserScan) -> list[SweepTime]:
    """Return when the beams of scans may be measured, if not at once."""
    spacing = (scan.bearings[-1] - scan.bearings[0]) / max(len(scan) - 1, 1) if len(scan) else 0.0
    circle = len(scan) * spacing > 1.9 * np.pi
    return [
        SweepTime(share, clockwise, ahead, ended)
        for share in _PARTS
        for clockwise in (False, True)
        for ahead in ((False, True) if circle else (False,))
        for ended in (False, True)
    ]


def _disagreements(one: Moment, other: Moment, times: list[SweepTime | None], matcher: Matcher) -> list[float]:
    """Return how far two scans lie from each other once matched [m], for each of `times`; nan where they tell none."""
    reference, new = thinned(one.scan), thinned(other.scan)
    if min(len(reference.points), len(new.points)) < _POINTS:
        return [np.nan] * len(times)
    guess = between(compose(one.pose, one.scan.T_robot_lidar), compose(other.pose, other.scan.T_robot_lidar))
    away = list[float]()
    for time in times:
        a, b = reference, new
        if time is not None:
            a = at_once(reference, one.back if time.ended else one.onward, time)
            b = at_once(new, other.back if time.ended else other.onward, time)
        found = matcher.match(a, b, guess)
        distances, _ = KDTree(a.points).query(transform_points(found.pose, b.points), distance_upper_bound=_FAR)
        away.append(float(np.minimum(distances, _FAR).mean()))
    return away
