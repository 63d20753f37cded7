"""The places where the robot may be: each followed by odometry and scans, weighed by all that it has seen on the way."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ..bounds import Cell, Share, Step, Within, check_numbers
from ..errors import InputError
from ..geometry import compose, wrap_angle
from ..search.branch_and_bound import SearchWindow, Separation, branch_and_bound
from .beam_fit import BeamFit, Sight
from .place_belief import PlaceBelief
from .place_map import PlaceMap

Array = NDArray[np.float64]


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
        least_level: The usual misfit is not taken for less, as no map is so good ...
        most_level: ... nor for more: there the map is of elsewhere.
        excess: A robot that is at none of the hypotheses is thought to misfit so much more than is usual.
        jump: Logarithm of how likely it is that the robot leaves all hypotheses from one independent scan to the next.
        odometry: Weight of the odometry's squared residuals: neighbouring ones err alike.
        same: Hypotheses nearer than this are one [m, rad].
        mode: Hypotheses nearer than this to the best agree with it [m, rad].
        sure: Least probability of these together with which the place is told.
        hopeless: Hypotheses whose likelihood is below the best by more than this, as a logarithm, are forgotten.
        memory: Share of the newest scan in what is usual.
    """

    angular_step: Step = float(np.radians(2.5))
    maxima: Annotated[int, Within(1, 1000)] = 200
    separation: Separation = field(default_factory=lambda: Separation(linear=0.5, angular=0.35, least_share=0.6))
    least_score: Share = 0.4
    points: Annotated[int, Within(1, 10_000)] = 120
    evidence: float = 1.5
    least_level: Share = 0.08
    most_level: Share = 0.4
    excess: float = 0.3
    jump: Annotated[float, Within(-100.0, 0.0)] = -7.0
    odometry: float = 0.1
    same: tuple[float, float] = (0.25, 0.1)
    mode: tuple[float, float] = (0.5, 0.175)
    sure: Share = 0.99
    hopeless: Annotated[float, Within(1.0, 1000.0)] = 15.0
    memory: Share = 0.05

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("maxima", "points", "evidence", "least_level", "excess", "hopeless", "sure"):
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class WeighedScan:
    """One weighed scan.

    Attributes:
        poses: (k, 3) T_map_robot of all hypotheses after it, the likeliest first.
        weights: (k,) their log-likelihoods.
        parents: (k,) which hypothesis of the step before each one comes from; -1: it was found by a search.
        factor: What a misfit was multiplied with.
    """

    poses: Array
    weights: Array
    parents: NDArray[np.int64]
    factor: float


class Hypotheses:
    """Follows places and weighs them.

    A scan takes `factor` times its misfit from the log-likelihood of a hypothesis. The factor is the larger, the better
    the map usually explains the scans: what it does not explain, people, moved things and its own errors, is the same
    for many beams and scans, and no proof. What is said of none of the hypotheses is kept as one more, `elsewhere`: it
    misfits somewhat more than is usual, the robot may step into it at any time, and what a search finds comes from it.

    Args:
        place: The map.
        fit: Judge of poses on it.
        config: Settings.

    Attributes:
        poses: (k, 3) T_map_robot, the likeliest first.
        explained: (k,) share of the beams explained.
        elsewhere: Log-likelihood of all other places together.
    """

    def __init__(self, place: PlaceMap, fit: BeamFit, config: HypothesesConfig) -> None:
        self._place, self._fit, self._config = place, fit, config
        linear, angular = config.separation.linear, config.separation.angular
        self._places = float(np.log(max(place.free_area / linear**2, 1.0) * 2.0 * np.pi / angular))
        self.poses, self._weights = np.empty((0, 3)), np.empty(0)
        self.explained, self._misfits = np.empty(0), np.empty(0)
        self._parents = np.empty(0, np.int64)
        self.elsewhere, self._level, self._usual, self._factor = 0.0, 0.0, 0.0, 0.0
        self._fresh = 1.0
        self.steps: list[WeighedScan] = []

    def __len__(self) -> int:
        return len(self.poses)

    def begin(self, pose: Array) -> None:
        """Take one pose (3,) for likely."""
        self.poses, self._weights = pose[None], np.zeros(1)
        self.explained, self._misfits = np.zeros(1), np.zeros(1)
        self._parents = np.full(1, -1)
        self.elsewhere = self._config.jump

    def weigh(self, sight: Sight, motion: Array, sigma: Array, fresh: float) -> None:
        """Move all hypotheses on and weigh them by a scan.

        Args:
            sight: The scan.
            motion: (3,) of the odometry since the scan that was weighed before.
            sigma: (2,) its standard deviations [m, rad].
            fresh: Share of the scan that is independent of the one before.
        """
        config = self._config
        self.poses, residuals = self._fit.follow(sight, self.poses, motion, sigma)
        self._misfits, self.explained = self._fit.judge(sight, self.poses)
        self._parents, self._fresh = np.arange(len(self.poses)), fresh
        self._learn_level()
        total = np.logaddexp.reduce(self._weights) if len(self) else -np.inf
        self.elsewhere = float(np.logaddexp(self.elsewhere, total + config.jump + np.log(fresh)))
        self.elsewhere -= self._factor * (self._bounded_level + config.excess)
        self._weights = self._weights - self._factor * self._misfits - config.odometry * residuals
        self._tidy()

    def search(self, sight: Sight) -> None:
        """Search the whole map by the scan that was weighed last, and add what is found."""
        poses = self._found(sight)
        misfits, explained = self._fit.judge(sight, poses)
        if not len(self) and len(poses):
            self._level = float(misfits.min())
            self._factor = self._fresh * self._config.evidence / self._bounded_level
        ahead = self._factor * (self._bounded_level + self._config.excess - misfits)
        self.poses = np.concatenate((self.poses, poses))
        self._weights = np.concatenate((self._weights, self.elsewhere - self._places + ahead))
        self._misfits = np.concatenate((self._misfits, misfits))
        self.explained = np.concatenate((self.explained, explained))
        self._parents = np.concatenate((self._parents, np.full(len(poses), -1)))
        self._tidy()

    def keep(self) -> None:
        """Keep this step, for the trajectory of the whole drive."""
        self.steps.append(WeighedScan(self.poses, self._weights, self._parents, self._factor))

    def settle(self) -> None:
        """Learn what is usual, where the place is sure."""
        memory, explained = self._config.memory, float(self.explained[0])
        self._usual = explained if self._usual == 0.0 else self._usual + memory * (explained - self._usual)

    @property
    def usual(self) -> float:
        """Share of the beams that the best hypothesis usually explains; 0: not known yet."""
        return self._usual

    @property
    def probability(self) -> float:
        """Probability that the robot is at the best hypothesis, or so near to it that they agree."""
        if not len(self):
            return 0.0
        total = np.logaddexp(np.logaddexp.reduce(self._weights), self.elsewhere)
        agree = near(self.poses, self.poses[0], self._config.mode)
        return float(np.exp(np.logaddexp.reduce(self._weights[agree]) - total))

    @property
    def doubt(self) -> float:
        """Probability that the robot is at none of the hypotheses."""
        if not len(self):
            return 1.0
        return float(np.exp(self.elsewhere - np.logaddexp(np.logaddexp.reduce(self._weights), self.elsewhere)))

    def belief(self, motion: Array, sure: bool) -> PlaceBelief:
        """Return what is believed after a `motion` (3,) of the odometry since the last scan that was weighed."""
        ratios = self._weights - (self._weights[0] if len(self) else 0.0)
        poses = compose(self.poses, motion) if len(self) else self.poses
        return PlaceBelief(poses, ratios, self.explained.copy(), sure)

    def distrust(self) -> None:
        """Take all other places for as likely as the hypotheses: nothing was seen for too long."""
        if len(self):
            self.elsewhere = max(self.elsewhere, float(np.logaddexp.reduce(self._weights)))

    @property
    def _bounded_level(self) -> float:
        return float(np.clip(self._level, self._config.least_level, self._config.most_level))

    def _learn_level(self) -> None:
        """Learn the usual misfit from the best hypothesis, and what a misfit counts."""
        if len(self):
            self._level += self._config.memory * (float(self._misfits[0]) - self._level)
        self._factor = self._fresh * self._config.evidence / self._bounded_level

    def _found(self, sight: Sight) -> Array:
        """Return (k, 3) refined maxima of a search of the whole map."""
        place, config, points = self._place, self._config, sight.points
        thinned = points[np.linspace(0, len(points) - 1, min(config.points, len(points))).astype(np.int64)]
        window = SearchWindow(linear=place.half_side, angular=np.pi, angular_step=config.angular_step)
        found = branch_and_bound(
            place.pyramid, thinned, np.append(place.centre, 0.0), window,
            min_score=config.least_score, maxima=config.maxima, separation=config.separation,
        )  # fmt: skip
        return self._fit.refine(sight, np.array([maximum.pose for maximum in found.maxima]).reshape(-1, 3))

    def _tidy(self) -> None:
        """Sort the hypotheses, join equal ones, drop hopeless ones and those that stand in walls or the unknown."""
        config = self._config
        stand = self._place.is_free(self.poses[:, :2])
        order = [int(k) for k in np.argsort(-self._weights, kind="stable") if stand[k]]
        kept: list[int] = []
        for k in order:
            if self._weights[k] < self._weights[order[0]] - config.hopeless or len(kept) >= config.maxima:
                break
            if not kept or not near(self.poses[kept], self.poses[k], config.same).any():
                kept.append(k)
        self.poses, self._weights, self._parents = self.poses[kept], self._weights[kept], self._parents[kept]
        self.explained, self._misfits = self.explained[kept], self._misfits[kept]


def near(poses: Array, pose: Array, reach: tuple[float, float]) -> NDArray[np.bool_]:
    """Return (k,) which `poses` (k, 3) lie within `reach` [m, rad] of `pose` (3,)."""
    off = poses - pose
    return (np.hypot(off[:, 0], off[:, 1]) <= reach[0]) & (np.abs(wrap_angle(off[:, 2])) <= reach[1])
