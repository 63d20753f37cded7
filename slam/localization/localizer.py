"""Localization against a finished map: a pose where the robot is sure of it, else none."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, check_positive, checked_pose
from ..errors import InputError
from ..geometry import between, compose
from ..local.local_odometry import AsTold, LocalOdometry
from ..local.local_slam import LocalSlamConfig
from ..occupancy_map import OccupancyMap
from ..pose_log import PoseLog
from ..scan import LaserScan
from ..scan_to_grid.extrapolator import ExtrapolatorConfig
from ..scan_to_grid.voxel_filter import AdaptiveVoxelConfig
from .beam_fit import BeamFit, BeamFitConfig, Sight
from .hypotheses import Hypotheses, HypothesesConfig
from .place_belief import PlaceBelief
from .place_map import PlaceMap, PlaceMapConfig
from .prepared_scan import PreparedScan, ScanPreparation

Array = NDArray[np.float64]

_START_SIGMA = np.array([0.2, 0.1])  # [m, rad] how well a given start is known
_START_REACH_M = 0.5  # a start is known to about this


class State(Enum):
    """SEARCHING: not sure where the robot is, there is no pose. TRACKING: sure."""

    SEARCHING = "searching"
    TRACKING = "tracking"


@dataclass(frozen=True, kw_only=True)
class LocalizerConfig:
    """Settings of `Localizer`.

    Attributes:
        local: Settings of local SLAM, which tells how the robot moved between scans; None: the odometry does.
        place: How the map is made ready.
        fit: How poses are judged and refined.
        hypotheses: How places are found, followed and weighed.
        voxel_filter: Which points of a scan are used.
        extrapolator: How well it is known how the robot moved.
        min_points: A scan with fewer points says nothing.
        step: A scan is weighed after so many metres or radians.
        fresh: A scan is independent of the ones before after so many metres and radians together.
        search_every: Where none of the hypotheses may be right, the map is searched each so many metres and radians.
        least_of_usual: A scan is surprising when the best hypothesis explains less of it than so much of what is usual.
        patience: So many surprising scans are weighed where the robot stands; people may stand there, too.
        blind_distance: After so many metres without a scan that says anything it is not sure [m].
    """

    local: LocalSlamConfig | None = field(default_factory=LocalSlamConfig)
    place: PlaceMapConfig = field(default_factory=PlaceMapConfig)
    fit: BeamFitConfig = field(default_factory=BeamFitConfig)
    hypotheses: HypothesesConfig = field(default_factory=HypothesesConfig)
    voxel_filter: AdaptiveVoxelConfig = field(default_factory=AdaptiveVoxelConfig)
    extrapolator: ExtrapolatorConfig = field(default_factory=ExtrapolatorConfig)
    min_points: int = 20
    step: float = 0.1
    fresh: float = 1.0
    search_every: float = 0.5
    least_of_usual: float = 0.85
    patience: int = 3
    blind_distance: float = 5.0

    def __post_init__(self) -> None:
        check_numbers(self)
        names = "min_points", "step", "fresh", "search_every", "least_of_usual", "patience", "blind_distance"
        check_positive(self, *names)


@dataclass(frozen=True, eq=False)
class WeighedScan:
    """A scan that was weighed, and what was believed after it.

    Attributes:
        number: Of the scan, from 0.
        sight: The scan, made ready.
        fresh: How independent it was of the one before, in [0, 1].
        poses: (k, 3) T_map_robot of all hypotheses, the likeliest first.
        parents: (k,) which hypothesis of the scan before each one comes from; -1: it was found by a search.
    """

    number: int
    sight: Sight
    fresh: float
    poses: Array
    parents: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LocalizationUpdate:
    """What localization made of one scan.

    Attributes:
        pose: (3,) T_map_robot [m, m, rad]; None: not sure where the robot is (never a guess among several).
        state: SEARCHING exactly where `pose` is None.
        matched: Whether this scan was matched on the map; if not, a pose follows the odometry.
        explained: Share of the scan's beams that end at walls of the map, at the pose or the best hypothesis; None
            where the scan has too few returns to say, or no hypothesis is left.
        belief: The hypotheses while the robot is searched for, and at the scan that found it; None while tracking.
    """

    pose: Array | None
    state: State
    matched: bool
    explained: float | None
    belief: PlaceBelief | None


class Localizer:
    """Finds the robot on a finished map and keeps track of it; says when it is not sure.

    Without a start pose, and whenever none of the places that it follows explains the scans, the whole map is searched.
    There is a pose while one place has nearly all of the probability. How the robot moved from scan to scan is told by
    local SLAM, which notices where the odometry slips, stands still or is late.

    Args:
        grid: The map; one that was made ready before is taken as it is.
        config: Settings.
        start: (3,) T_map_robot at the first scan [m, m, rad], within about 0.5 m and 15 degrees; None: it is searched.
        keep_history: Whether all hypotheses of all scans are kept, for `smooth_drive`; memory grows with the drive.

    Attributes:
        place: The map, made ready.
        fit: Judge of poses on it.
        hypotheses: The places that are followed.
        start: As given.
        history: What was weighed, if it is kept.
        lost: How often it was sure, and then not any longer.

    Raises:
        InputError: If the map has no walls or no free space, or the start is not a finite pose near free space of it.
    """

    def __init__(
        self,
        grid: OccupancyMap | PlaceMap,
        config: LocalizerConfig | None = None,
        start: ArrayLike | None = None,
        *,
        keep_history: bool = False,
    ) -> None:
        self.config = config or LocalizerConfig()
        self.place = grid if isinstance(grid, PlaceMap) else PlaceMap(grid, self.config.place)
        self.fit = BeamFit(self.place, self.config.fit)
        self.hypotheses = Hypotheses(self.place, self.fit, self.config.hypotheses)
        self._preparation = ScanPreparation(self.config.voxel_filter)
        self.start = self._start = None if start is None else self._checked(checked_pose(start, "start"))
        self.history: list[WeighedScan] | None = [] if keep_history else None
        self._moving = LocalOdometry(self.config.local) if self.config.local else AsTold()
        self._told: Array | None = None  # odometry of the last scan ...
        self._odometry: Array | None = None  # ... and as local SLAM has it
        self._weighed_at: Array | None = None  # odometry of the last scan that was weighed
        self._since_search, self._since_sight, self._surprises = np.inf, 0.0, 0
        self._sure = False
        self._odometries, self._updates = PoseLog(), list[Array | None]()
        self.lost = 0

    def _checked(self, start: Array) -> Array:
        """Return `start`, unless it lies where the map knows nothing: there no scan contradicts any pose."""
        away = self.place.to_free_space(start[:2])
        if away > _START_REACH_M:
            raise InputError(
                f"`start` must lie within {_START_REACH_M} m of the map's free space, ({start[0]:g}, {start[1]:g}) is "
                f"{away:.1f} m away"
            )
        return start

    @property
    def pose(self) -> Array | None:
        """(3,) T_map_robot at the last scan; None: not sure."""
        last = self._updates[-1] if self._updates else None
        return None if last is None else last.copy()

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them; NaN where it was not sure."""
        nowhere = np.full(3, np.nan)
        return np.array([nowhere if pose is None else pose for pose in self._updates]).reshape(-1, 3)

    def odometry(self) -> Array:
        """Return (n, 3) T_odom_robot of every scan, as local SLAM has it: how the robot moved."""
        return self._odometries.array()

    def update(self, odometry: ArrayLike, scan: LaserScan) -> LocalizationUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        self._told = checked_pose(odometry, before=self._told)
        before, self._odometry = self._odometry, self._moving.update(self._told, scan)
        self._odometries.append(self._odometry)
        moved = _length(between(self._odometry if before is None else before, self._odometry))
        self._since_search, self._since_sight = self._since_search + moved, self._since_sight + moved
        prepared = self._preparation.prepare(self._odometry, scan)
        result = self._looked(prepared) if len(prepared.points) >= self.config.min_points else self._blind()
        self._updates.append(result.pose)
        return result

    def _blind(self) -> LocalizationUpdate:
        """Return what is known after a scan that says nothing."""
        if self._start is not None:
            self.hypotheses.begin(self._start)
            self._start, self._weighed_at, self._sure = None, self._odometry, True
        if self._sure and self._since_sight > self.config.blind_distance:
            self.hypotheses.distrust()
            self._become(False)
        if not self._sure:
            return LocalizationUpdate(None, State.SEARCHING, False, None, None)
        pose = compose(self.hypotheses.poses[0], self._motion())
        return LocalizationUpdate(pose, State.TRACKING, False, None, None)

    def _looked(self, scan: PreparedScan) -> LocalizationUpdate:
        """Return what is known after a scan that says something."""
        self._since_sight = 0.0
        if self._start is not None:
            self.hypotheses.begin(self._start)
            self._sure = True
        sight = self.fit.sight(scan.odometry, scan.points, scan.sensor)
        fresh = self._freshness()
        pose, explained = self._followed(sight) if not fresh else (None, None)
        surprising = explained is not None and explained < self.config.least_of_usual * self.hypotheses.usual
        if surprising and self._surprises < self.config.patience:
            self._surprises += 1
            fresh = 1.0
        elif explained is not None and not surprising:
            self._surprises = 0
        was_sure = self._sure
        if fresh:
            self._weigh(sight, fresh)
            pose, explained = (
                (self.hypotheses.poses[0], float(self.hypotheses.explained[0]))
                if len(self.hypotheses)
                else (None, None)
            )
        if not self._sure:
            return LocalizationUpdate(
                None, State.SEARCHING, False, explained, self.hypotheses.belief(self._motion(), False)
            )
        belief = None if was_sure else self.hypotheses.belief(self._motion(), True)
        return LocalizationUpdate(pose, State.TRACKING, not surprising, explained, belief)

    def _freshness(self) -> float:
        """Return how independent a scan is of the one that was weighed last; 0: it is not weighed."""
        if self._weighed_at is None:
            return 1.0
        motion = self._motion()
        if max(np.hypot(motion[0], motion[1]), abs(motion[2])) < self.config.step:
            return 0.0
        return min(1.0, _length(motion) / self.config.fresh)

    def _motion(self) -> Array:
        """Return (3,) the motion of the odometry since the last scan that was weighed."""
        assert self._odometry is not None
        return np.zeros(3) if self._weighed_at is None else between(self._weighed_at, self._odometry)

    def _followed(self, sight: Sight) -> tuple[Array | None, float | None]:
        """Return the best hypothesis' pose at a scan that is not weighed, and the share that it explains there."""
        if not len(self.hypotheses):
            return None, None
        motion = self._motion()
        sigma = self.config.extrapolator.sigma(motion)
        poses, _ = self.fit.follow(sight, self.hypotheses.poses[:1], motion, sigma)
        return poses[0], float(self.fit.judge(sight, poses)[1][0])

    def _weigh(self, sight: Sight, fresh: float) -> None:
        motion, hypotheses = self._motion(), self.hypotheses
        sigma = self.config.extrapolator.sigma(motion)
        if self._start is not None:
            sigma, self._start = _START_SIGMA, None
        hypotheses.weigh(sight, motion, sigma, fresh)
        self._weighed_at = sight.odometry
        unsure = 1.0 - self.config.hypotheses.sure
        surprised = self._surprises > 0 and fresh == 1.0
        if hypotheses.doubt > unsure and (self._since_search >= self.config.search_every or surprised):
            self._since_search = 0.0
            hypotheses.search(sight)
        if self.history is not None:
            self.history.append(WeighedScan(len(self._updates), sight, fresh, hypotheses.poses, hypotheses.parents))
        # Another place than the one that was told last is not told before the next scan has confirmed it.
        jumped = self._sure and not hypotheses.leads_on
        self._become(hypotheses.probability >= self.config.hypotheses.sure and not jumped)
        if self._sure:
            hypotheses.settle()

    def _become(self, sure: bool) -> None:
        self.lost += self._sure and not sure
        self._sure = sure


def _length(motion: Array) -> float:
    """Return metres and radians of a motion (3,) together."""
    return float(np.hypot(motion[0], motion[1])) + abs(float(motion[2]))
