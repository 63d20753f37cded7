"""The places where the robot may be: each followed by odometry and scans, weighed by all that it saw on the way."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Share, Step, Within, check_numbers, check_positive
from ..geometry import compose, wrap_angle
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from .beam_fit import BeamFit, Sight
from .place_belief import PlaceBelief
from .place_map import PlaceMap

Array = NDArray[np.float64]

_FREE_WITHIN = 0.3  # [m] of a robot's centre some place is free, though drawn maps have holes where no beam went


@dataclass(frozen=True, kw_only=True)
class HypothesesConfig:
    """Settings of `Hypotheses`.

    Attributes:
        angular_step: Step between the headings that a search of the map tries [rad].
        maxima: A search keeps at most so many distinct maxima: the right one may be the hundredth by one scan.
        separation: When two maxima are distinct, and how much worse than the best a maximum may score.
        least_score: Mean worth of a point, in [0, 1], below which nothing is found.
        points: A search uses about so many points of the scan.
        evidence: By how much a hypothesis is less likely, as a logarithm, that misfits twice as much as is usual, for
            each scan that is independent of the others.
        level: What is usual before anything was seen ...
        level_scans: ... counts as much as so many independent scans: by chance the best of many places fits better than
            is usual. With 2 the second log of Wean Hall was sure and wrong in 3.7 % of the scans told, with 10 in
            0.2 %; stretches of five other logs hardly differ, and a robot that wakes up on a clean map is found later.
        least_level: The usual misfit is not taken for less, as no map is so good ...
        most_level: ... nor for more: there the map is of elsewhere.
        excess: A robot that is at none of the hypotheses is thought to misfit so much more than is usual.
        jump: Logarithm of how likely it is that the robot leaves all hypotheses from one independent scan to the next.
        odometry: Weight of the odometry's squared residuals: neighbouring ones err alike.
        same: Hypotheses nearer than this are one [m, rad].
        mode: Hypotheses nearer than this to the best agree with it [m, rad].
        sure: Least probability of these together with which the place is told.
        hopeless: Hypotheses whose likelihood is below the best by more than this, as a logarithm, are forgotten.
        memory: What is usual is the mean of about so many independent scans.
        off_map: Whether the robot may be off the map: a place is told only if it is likelier than the unknown.
    """

    angular_step: Step = float(np.radians(2.5))
    maxima: Annotated[int, Within(1, 1000)] = 200
    separation: Separation = field(default_factory=lambda: Separation(linear=0.5, angular=0.35, least_share=0.6))
    least_score: Share = 0.4
    points: Annotated[int, Within(1, 10_000)] = 120
    evidence: float = 2.0
    level: Share = 0.2
    level_scans: float = 10.0
    least_level: Share = 0.08
    most_level: Share = 0.4
    excess: float = 0.3
    jump: Annotated[float, Within(-100.0, 0.0)] = -7.0
    odometry: float = 0.1
    same: tuple[float, float] = (0.25, 0.1)
    mode: tuple[float, float] = (0.5, 0.175)
    sure: Share = 0.99
    hopeless: Annotated[float, Within(1.0, 1000.0)] = 20.0
    memory: float = 50.0
    off_map: bool = True

    def __post_init__(self) -> None:
        check_numbers(self)
        check_positive(self, "maxima", "points", "evidence", "level", "least_level", "excess", "hopeless", "sure")


class Hypotheses:
    """Follows places and weighs them.

    The log-likelihood of a hypothesis is what it has misfitted so far, over what is usual, beside a prior. So evidence
    counts the more, the better the map explains the scans: what it does not explain, people, moved things and its own
    errors, is the same for many beams and scans, and no proof. What is said of none of the hypotheses is kept as one
    more, `elsewhere`: it misfits somewhat more than is usual, the robot may step into it at any time, and what a search
    finds comes from it.

    The robot may have left the map: then, too, some place on it fits best. So the best one is told only if, since it
    was found, it is likelier than one where all beams end in the unknown.

    Args:
        place: The map.
        fit: Judge of poses on it.
        config: Settings.

    Attributes:
        poses: (k, 3) T_map_robot, the likeliest first.
        explained: (k,) share of the beams explained.
        usual: Share of the beams that the best one usually explains where it is sure; 0: not known yet.
        parents: (k,) which hypothesis before the last scan each one comes from; -1: it was found by a search.
    """

    def __init__(self, place: PlaceMap, fit: BeamFit, config: HypothesesConfig) -> None:
        self._place, self._fit, self._config = place, fit, config
        linear, angular = config.separation.linear, config.separation.angular
        self._places = float(np.log(max(place.free_area / linear**2, 1.0) * 2.0 * np.pi / angular))
        self.poses, self.explained, self.usual = np.empty((0, 3)), np.empty(0), 0.0
        self._now, self.parents = np.empty(0), np.empty(0, np.int64)  # misfit of the last scan; before it
        self._misfits, self._priors = np.empty(0), np.empty(0)  # sum of all, weighed by freshness; logarithm
        self._known = np.empty(0)  # by how much less it misfitted, since it was found, than the unknown does
        self._elsewhere = np.zeros(2)  # the same two of all other places together
        self._level, self._learned, self._fresh = config.level, config.level_scans, 1.0

    def __len__(self) -> int:
        return len(self.poses)

    def begin(self, pose: Array) -> None:
        """Take one pose (3,) for likely."""
        self.poses, self.parents = pose[None], np.full(1, -1, np.int64)
        self._misfits, self._priors, self._now, self.explained = np.zeros((4, 1))
        self._elsewhere, self._known = np.array([0.0, self._config.jump]), np.full(1, np.inf)

    def weigh(self, sight: Sight, motion: Array, sigma: Array, fresh: float) -> None:
        """Move all hypotheses on and weigh them by a scan.

        Args:
            sight: The scan.
            motion: (3,) of the odometry since the scan that was weighed before.
            sigma: (2,) its standard deviations [m, rad].
            fresh: Share of the scan that is independent of the one before.
        """
        config, self._fresh = self._config, fresh
        self._step_elsewhere(config.jump + float(np.log(fresh)))
        self.poses, residuals = self._fit.follow(sight, self.poses, motion, sigma)
        self._now, self.explained = self._fit.judge(sight, self.poses)
        self.parents = np.arange(len(self.poses))
        if len(self):
            self._learn_level(float(self._now[0]))
        self._misfits = self._misfits + fresh * self._now
        self._known = self._known + fresh * (self._fit.unseen - self._now)
        self._priors = self._priors - config.odometry * residuals
        self._elsewhere[0] += fresh * (self._bounded_level + config.excess)
        self._tidy()

    def search(self, sight: Sight) -> None:
        """Search the whole map by the scan that was weighed last, and add what is found."""
        poses = _found(self._place, self._fit, self._config, sight)
        now, explained = self._fit.judge(sight, poses)
        if not len(self) and len(poses):
            self._learn_level(float(now.min()))
            self._elsewhere[0] = self._fresh * (self._bounded_level + self._config.excess)
        elsewhere = self._bounded_level + self._config.excess
        self.poses = np.concatenate((self.poses, poses))
        self._misfits = np.concatenate((self._misfits, self._elsewhere[0] + self._fresh * (now - elsewhere)))
        self._priors = np.concatenate((self._priors, np.full(len(poses), self._elsewhere[1] - self._places)))
        self._known = np.concatenate((self._known, self._fresh * (self._fit.unseen - now)))
        self._now, self.explained = np.concatenate((self._now, now)), np.concatenate((self.explained, explained))
        self.parents = np.concatenate((self.parents, np.full(len(poses), -1, np.int64)))
        self._elsewhere[0] += self._fresh * max(0.0, self._unfound(sight) - elsewhere)
        self._tidy()
        self._step_elsewhere(self._config.jump)

    def _step_elsewhere(self, jump: float) -> None:
        """Let the robot step from the best hypothesis to elsewhere, at a log-likelihood of `jump`."""
        if len(self) and self._weights[0] + jump > self._other:
            self._elsewhere = np.array([self._misfits[0], self._priors[0] + jump])

    @property
    def _weights(self) -> Array:
        """(k,) log-likelihoods of the hypotheses."""
        return self._priors - self._config.evidence * self._misfits / self._bounded_level

    @property
    def _other(self) -> float:
        """Log-likelihood of all other places together."""
        misfit, prior = self._elsewhere.tolist()
        return float(prior - self._config.evidence * misfit / self._bounded_level)

    def costs(self, misfits: Array, fresh: Array) -> Array:
        """Return what trajectories with such `misfits` (..., n) lose in log-likelihood at scans of freshness (n,)."""
        return self._config.evidence * misfits * fresh / self._bounded_level

    @property
    def least(self) -> float:
        """Log-likelihood of a jump to one other place."""
        return self._config.jump - self._places

    def _unfound(self, sight: Sight) -> float:
        """Return how much the scan misfits where a search has found nothing: as anywhere on the map."""
        factor = self._fresh * self._config.evidence / self._bounded_level
        misfits, _ = self._fit.judge(sight, self._place.anywhere)
        return float(np.log(len(misfits)) - np.logaddexp.reduce(-factor * misfits)) / factor

    def settle(self) -> None:
        """Learn what is usual, where the place is sure."""
        memory, explained = 1.0 / self._config.memory, float(self.explained[0])
        self.usual = explained if self.usual == 0.0 else self.usual + memory * (explained - self.usual)

    @property
    def leads_on(self) -> bool:
        """Whether the best hypothesis is the one, or agrees with the one, that was the best before the last scan."""
        if not len(self) or not (self.parents >= 0).any():
            return False
        before = int(np.argmin(np.where(self.parents >= 0, self.parents, len(self) + self._config.maxima)))
        return bool(self.parents[before] == 0 and near(self.poses[:1], self.poses[before], self._config.mode)[0])

    @property
    def probability(self) -> float:
        """Probability that the robot is at the best hypothesis, or so near to it that they agree, and on the map."""
        if not len(self):
            return 0.0
        total = np.logaddexp(np.logaddexp.reduce(self._weights), self._other)
        agree = near(self.poses, self.poses[0], self._config.mode)
        known = self._config.evidence * float(self._known[agree].max()) / self._bounded_level
        off_map = np.logaddexp(0.0, -known) if self._config.off_map else 0.0
        return float(np.exp(np.logaddexp.reduce(self._weights[agree]) - total - off_map))

    @property
    def doubt(self) -> float:
        """Probability that the robot is at none of the hypotheses."""
        if not len(self):
            return 1.0
        return float(np.exp(self._other - np.logaddexp(np.logaddexp.reduce(self._weights), self._other)))

    def belief(self, motion: Array, sure: bool) -> PlaceBelief:
        """Return what is believed after a `motion` (3,) of the odometry since the last scan that was weighed."""
        ratios = self._weights - (self._weights[0] if len(self) else 0.0)
        poses = compose(self.poses, motion) if len(self) else self.poses
        return PlaceBelief(poses, ratios, self.explained.copy(), sure)

    def distrust(self) -> None:
        """Take all other places for as likely as the hypotheses: nothing was seen for too long."""
        self._step_elsewhere(0.0)

    @property
    def _bounded_level(self) -> float:
        return float(np.clip(self._level, self._config.least_level, self._config.most_level))

    def _learn_level(self, misfit: float) -> None:
        """Learn what is usual from a `misfit` of the best hypothesis, but not from one that is far beyond it."""
        config = self._config
        misfit = min(misfit, 2.0 * max(self._level, config.least_level))
        self._learned = min(self._learned, config.memory) + self._fresh
        self._level += self._fresh / self._learned * (misfit - self._level)

    def _tidy(self) -> None:
        """Sort the hypotheses, join equal ones, drop hopeless ones and those that stand in walls or the unknown."""
        config, weights = self._config, self._weights
        stand = self._place.is_open(self.poses[:, :2], _FREE_WITHIN)
        order = [int(k) for k in np.argsort(-weights, kind="stable") if stand[k]]
        behind = -config.evidence * self._misfits / config.most_level  # by the scans alone, and the most careful level
        kept: list[int] = []
        for k in order:
            if behind[k] < behind[order[0]] - config.hopeless or len(kept) >= config.maxima:
                continue
            if not kept or not near(self.poses[kept], self.poses[k], config.same).any():
                kept.append(k)
        self.poses, self.parents = self.poses[kept], self.parents[kept]
        self._misfits, self._priors, self._known = self._misfits[kept], self._priors[kept], self._known[kept]
        self._now, self.explained = self._now[kept], self.explained[kept]


def near(poses: Array, pose: Array, reach: tuple[float, float]) -> NDArray[np.bool_]:
    """Return (k,) which `poses` (k, 3) lie within `reach` [m, rad] of `pose` (3,)."""
    off = poses - pose
    return (np.hypot(off[:, 0], off[:, 1]) <= reach[0]) & (np.abs(wrap_angle(off[:, 2])) <= reach[1])


def _found(place: PlaceMap, fit: BeamFit, config: HypothesesConfig, sight: Sight) -> Array:
    """Return (k, 3) refined maxima of a search of the whole map."""
    points = sight.points
    thinned = points[np.linspace(0, len(points) - 1, min(config.points, len(points))).astype(np.int64)]
    window = SearchWindow(linear=place.half_side, angular=np.pi, angular_step=config.angular_step)
    found = branch_and_bound(
        place.pyramid, thinned, np.append(place.centre, 0.0), window,
        min_score=config.least_score, maxima=config.maxima, separation=config.separation,
    )  # fmt: skip
    return fit.refine(sight, np.array([maximum.pose for maximum in found.maxima]).reshape(-1, 3))
