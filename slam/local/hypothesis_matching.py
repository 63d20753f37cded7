"""Which of the ways in which the robot may have moved explains a scan best, and where it is then."""

import math
from dataclasses import replace

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

_NOWHERE = 0.001  # share of the scans that a submap knows nothing of: of a robot that was carried, among people
_APART = np.array([0.2, 0.1])  # [m, rad] places farther from each other are not the same, of two matches


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
    ) -> tuple[MotionHypothesis, GridMatch | None, float, bool]:
        """Return the hypothesis that explains the scan best, its match on the submap, and the lead of a fault.

        None: nothing matches. The lead is the logarithm of how many times likelier a fault is than sound odometry. The
        last is whether the place is in question, as of a `Look`.
        """
        if not self._active.begun:  # there is no map: the scan says nothing for or against a fault
            return hypotheses[0], None, hypotheses[0].cost - hypotheses[-1].cost, False
        degenerate = degenerate_direction(scan, points)
        sensor = np.array(scan.T_robot_lidar[:2], dtype=np.float64)
        known = motion.anywhere is not None
        first = self._matched(points, sensor, hypotheses[0].prediction, degenerate, known)
        found = [(hypotheses[0], first)]
        fits = first.pose if first and not self._matcher.is_poor(first) else None
        for other in hypotheses[1:]:
            if fits is None or not other.is_needless(hypotheses[0], fits):
                found.append((other, self._matched(points, sensor, other.prediction, degenerate, known)))
        telling = self._matcher.independent(points)
        best = self._best(found, telling)
        if best[1] and self._matcher.is_poor(best[1]):
            return self._anywhere(motion, points, sensor, hypotheses, found)
        return *best, False

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
        nowhere = self._matcher.cost(None, telling) - math.log(_NOWHERE)
        if not places:
            return *best, stays > nowhere
        places.sort(key=lambda place: place[0])
        (least, likeliest), *others = places
        jump, match = likeliest[-1]
        alike = any(cost < least + DOUBT and _are_apart(match, candidates[0][1]) for cost, candidates in others)
        if (alike or least > min(nowhere, stays - DOUBT)) and _are_apart(match, best[1]):
            return *best, stays > min(least + DOUBT, nowhere)
        best = self._best([*found, *likeliest], telling)
        if best[1] is match:
            hypotheses[:] = [*(other for other in hypotheses if other.sound), jump]
        return *best, False

    def _matched(
        self, points: Array, sensor: Array, prediction: Prediction, degenerate: Array | None, known: bool
    ) -> GridMatch | None:
        """Return the match of a scan near one prediction, by what the submap may have seen of it; None: too little.

        `known`: whether it is known about where on the submap the robot is.
        """
        front = self._active.front
        match = self._matcher.match if known else self._matcher.match_anyhow
        seen = seen_points(front, points, prediction)
        found = match(front, seen, prediction, degenerate)
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


def _are_apart(match: GridMatch | None, other: GridMatch | None) -> bool:
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
