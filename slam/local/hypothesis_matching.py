"""Which of the ways in which the robot may have moved explains a scan best, and where it is then."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry import between
from ..scan import LaserScan
from ..scan_to_grid.degenerate_direction import degenerate_direction
from ..scan_to_grid.extrapolator import Prediction
from ..scan_to_grid.scan_matcher import DOUBT, GridMatch, GridScanMatcher
from .active_submaps import ActiveSubmaps
from .seen_points import seen_points, telling_share
from .switching_motion import MotionHypothesis, SwitchingMotion

Array = NDArray[np.float64]

Candidate = tuple[MotionHypothesis, GridMatch | None]
"""A way in which the robot may have moved, and where its scan fits then; None: nowhere."""

_CONTESTED = 4.0  # nats by which a hypothesis may be behind for the scans to come to decide
_NOWHERE = 0.001  # share of the scans that a submap knows nothing of: of a robot that was carried, among people
_APART = np.array([0.2, 0.1])  # [m, rad] places farther from each other are not the same, of two matches


class Rival(NamedTuple):
    """Where a scan fits far better than where it was chosen to be, and the robot would have to have moved oddly.

    Attributes:
        motion: How it would have moved.
        match: Where the scan fits.
        behind: Logarithm of how many times likelier the chosen place is.
    """

    motion: MotionHypothesis
    match: GridMatch
    behind: float


@dataclass(frozen=True, eq=False)
class Look:
    """What was found when a scan was matched, and nothing more done.

    Attributes:
        points: (N, 2) that were matched, robot frame [m].
        hypotheses: How the robot may have moved.
        motion: The one that holds.
        match: Where the scan fits; None: nowhere.
        lead: Logarithm of how many times likelier a fault is than sound odometry.
        in_question: Whether the scan fits so badly there that it is elsewhere, and it is not known where.
        cost: Negative log-likelihood of the scan; of being nowhere that is known, if that is likelier.
        rival: Where else the robot may be by this scan alone; None: nowhere.
        drawn: So many scans had been drawn into submaps.
    """

    points: Array
    hypotheses: list[MotionHypothesis]
    motion: MotionHypothesis
    match: GridMatch | None
    lead: float
    in_question: bool
    cost: float
    rival: Rival | None
    drawn: int

    @property
    def far(self) -> bool:
        """Whether the scan fits only far from where sound odometry expects it."""
        return self.match is not None and (self.match.retried or not self.motion.sound)


class HypothesisMatching:
    """Matches scans along each of the ways in which the robot may have moved.

    Args:
        matcher: Matches a scan near one prediction.
        active: The submaps, on whose front scans are matched.
    """

    def __init__(self, matcher: GridScanMatcher, active: ActiveSubmaps) -> None:
        self._matcher, self._active = matcher, active

    def match(
        self, motion: SwitchingMotion, scan: LaserScan, points: Array, hypotheses: list[MotionHypothesis]
    ) -> Look:
        """Return which of the `hypotheses` about a `motion` explains a scan of `points` (N, 2) best."""
        if not self._active.begun:  # there is no map: the scan says nothing for or against a fault
            first = hypotheses[0]
            lead = first.cost - hypotheses[-1].cost
            return Look(points, hypotheses, first, None, lead, False, first.cost, None, self._active.drawn)
        degenerate = degenerate_direction(scan, points)
        sensor = np.array(scan.T_robot_lidar[:2], dtype=np.float64)
        first = self._matched(points, sensor, hypotheses[0].prediction, degenerate)
        found = [(hypotheses[0], first)]
        fits = first.pose if first and not self._matcher.is_poor(first) else None
        for other in hypotheses[1:]:
            if fits is None or not other.is_needless(hypotheses[0], fits):
                found.append((other, self._matched(points, sensor, other.prediction, degenerate)))
        telling = self._matcher.independent(points)
        (chosen, match, lead), in_question = self._best(found, telling), False
        if match and self._matcher.is_poor(match):
            chosen, match, lead, in_question = self._anywhere(motion, points, sensor, hypotheses, found)
        cost = _cost(self._matcher, found[0][0], (chosen, match), telling)
        rival = self._rival(found, (chosen, match), cost, telling) if match and not in_question else None
        cost = min(cost, self._nowhere(telling))
        return Look(points, hypotheses, chosen, match, lead, in_question, cost, rival, self._active.drawn)

    def _nowhere(self, telling: int) -> float:
        """Return the negative log-likelihood of a scan of so many points if nothing is known of where it is."""
        return self._matcher.cost(None, telling) - math.log(_NOWHERE)

    def _rival(self, found: list[Candidate], chosen: Candidate, cost: float, telling: int) -> Rival | None:
        """Return what of `found` is nearly as likely as what was `chosen`, and explains the scan far better.

        Args:
            found: The candidates.
            chosen: One of them, or a place far off.
            cost: Its negative log-likelihood.
            telling: Points of the scan that tell.
        """
        fit, rivals = self._matcher.cost(chosen[1], telling), list[Rival]()
        for motion, match in found:
            if match is None or motion.sound == chosen[0].sound or not self._matcher.explains(match):
                continue
            behind = _cost(self._matcher, found[0][0], (motion, match), telling) - cost
            if behind < _CONTESTED and fit - self._matcher.cost(match, telling) > DOUBT and are_apart(match, chosen[1]):
                rivals.append(Rival(motion, match, behind))
        return min(rivals, key=lambda rival: rival.behind, default=None)

    def _anywhere(
        self,
        motion: SwitchingMotion,
        points: Array,
        sensor: Array,
        hypotheses: list[MotionHypothesis],
        found: list[Candidate],
    ) -> tuple[MotionHypothesis, GridMatch | None, float, bool]:
        """Return as `match` for a scan that fits nowhere well of what was `found`: it is searched for more widely.

        A place counts where no other is about as likely, nor what was `found`; it becomes the last of the `hypotheses`.
        """
        telling = self._matcher.independent(points)
        first, best, anywhere = found[0][0], self._best(found, telling), motion.anywhere
        places: list[tuple[float, list[Candidate]]] = []
        for match in self._matcher.search(self._active.front, points, anywhere) if anywhere else ():
            match = replace(match, seen=telling_share(self._active.front, points, sensor, match.pose))
            if not self._matcher.explains(match):
                continue
            candidates: list[Candidate] = [(first, match), (motion.found(match.pose), match)]
            cost = min(_cost(self._matcher, first, candidate, telling) for candidate in candidates)
            places.append((cost, candidates))
        stays = _cost(self._matcher, first, best[:2], telling)
        nowhere = self._nowhere(telling)
        if not places:
            return *best, stays > nowhere
        places.sort(key=lambda place: place[0])
        (least, likeliest), *others = places
        jump, match = likeliest[-1]
        alike = any(cost < least + DOUBT and are_apart(match, candidates[0][1]) for cost, candidates in others)
        if (alike or least > min(nowhere, stays - DOUBT)) and are_apart(match, best[1]):
            return *best, stays > min(least + DOUBT, nowhere)
        best = self._best([*found, *likeliest], telling)
        if best[1] is match:
            hypotheses[:] = [*(other for other in hypotheses if other.sound), jump]
        return *best, False

    def _matched(
        self, points: Array, sensor: Array, prediction: Prediction, degenerate: Array | None
    ) -> GridMatch | None:
        """Return the match of a scan near one prediction, by what the submap may have seen of it; None: too little."""
        front = self._active.front
        seen = seen_points(front, points, prediction)
        found = self._matcher.match(front, seen, prediction, degenerate)
        if found is None:
            return None
        score = found.score * len(seen) / len(points)
        return replace(found, score=score, seen=telling_share(front, points, sensor, found.pose))

    def _best(self, found: list[Candidate], points: int) -> tuple[MotionHypothesis, GridMatch | None, float]:
        """Return the likeliest of some hypotheses with their matches: the first is that of the odometry."""
        costs = [_cost(self._matcher, found[0][0], candidate, points) for candidate in found]
        sound = min(cost for cost, (motion, _) in zip(costs, found, strict=True) if motion.sound)
        fault = min((cost for cost, (motion, _) in zip(costs, found, strict=True) if not motion.sound), default=np.inf)
        return *found[int(np.argmin(costs))], sound - fault


def are_apart(match: GridMatch | None, other: GridMatch | None) -> bool:
    """Return whether two matches are of different places."""
    if match is None or other is None:
        return True
    x, y, turn = between(match.pose, other.pose).tolist()
    return math.hypot(x, y) > _APART[0] or abs(turn) > _APART[1]


def _cost(matcher: GridScanMatcher, by_odometry: MotionHypothesis, candidate: Candidate, points: int) -> float:
    """Return the negative log-likelihood of a scan of so many `points` by a hypothesis, with its match.

    That the robot is elsewhere than its odometry says needs a scan that fits there: where nothing is known, none fits
    badly.
    """
    motion, match = candidate
    if motion.prediction.pose is not by_odometry.prediction.pose and not (match and matcher.explains(match)):
        return np.inf
    fit = motion.cost_at(match.pose, match.told) if match else motion.cost
    return matcher.cost(match, points) + fit
