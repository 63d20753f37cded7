"""Localization against a finished map: a pose where the robot is sure of it, else none."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import check_numbers, checked_pose
from ..errors import InputError
from ..geometry import between
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from ..scan_to_grid.extrapolator import ExtrapolatorConfig, OdometryExtrapolator, Prediction
from ..scan_to_grid.scan_matcher import GridScanMatcher, GridScanMatcherConfig
from ..scan_to_grid.voxel_filter import AdaptiveVoxelConfig
from .evidence import Evidence, EvidenceConfig
from .global_search import GlobalSearch, GlobalSearchConfig, PlaceBelief
from .place_map import PlaceMap, PlaceMapConfig
from .prepared_scan import PreparedScan, ScanPreparation

Array = NDArray[np.float64]

_START_SIGMA = np.array([0.2, 0.1])  # [m, rad] how well a given start is known
_START_REACH_M = 0.5  # a start is known to about this
_MEMORY = 0.05  # share of the newest scan in the typical share explained


class State(Enum):
    """SEARCHING: not sure where the robot is, there is no pose. TRACKING: sure."""

    SEARCHING = "searching"
    TRACKING = "tracking"


@dataclass(frozen=True, kw_only=True)
class LocalizerConfig:
    """Settings of `Localizer`.

    Attributes:
        place: How the map is made ready.
        evidence: How poses are judged.
        search: How the robot is searched for on the whole map.
        voxel_filter: Which points of a scan are used.
        extrapolator: Error model of the odometry.
        matcher: How scans are matched while tracking.
        min_points: A scan with fewer points says nothing.
        least_of_usual: A match is rejected when it explains less of its beams than so much of what is usual ...
        least_explained: ... or less than this.
        patience: After so many rejected matches in a row the robot counts as lost.
        trust: Then the tracked pose still counts as so many times likelier than any other before the map is searched,
            where the odometry may have led to it; one that it cannot have led to is given up at once.
        blind_distance: After so many metres without a scan that says anything it counts as lost, too [m].
    """

    place: PlaceMapConfig = field(default_factory=PlaceMapConfig)
    evidence: EvidenceConfig = field(default_factory=EvidenceConfig)
    search: GlobalSearchConfig = field(default_factory=GlobalSearchConfig)
    voxel_filter: AdaptiveVoxelConfig = field(default_factory=AdaptiveVoxelConfig)
    extrapolator: ExtrapolatorConfig = field(default_factory=ExtrapolatorConfig)
    matcher: GridScanMatcherConfig = field(default_factory=GridScanMatcherConfig)
    min_points: int = 20
    least_of_usual: float = 0.85
    least_explained: float = 0.5
    patience: int = 3
    trust: float = 150.0
    blind_distance: float = 5.0

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("min_points", "least_of_usual", "least_explained", "patience", "trust", "blind_distance"):
            if not getattr(self, name) > 0:
                raise InputError(f"`{name}` must be positive, got {getattr(self, name)}")


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

    Without a start pose, and whenever several informative scans in a row contradict the tracked pose, the whole map is
    searched. There is a pose again when one hypothesis is `sure_ratio` times as likely as any other.

    Args:
        grid: The map; one that was made ready before is taken as it is.
        config: Settings.
        start: (3,) T_map_robot at the first scan [m, m, rad], within about 0.5 m and 15 degrees; None: it is searched.

    Raises:
        InputError: If the map has no walls or no free space, or the start is not a finite pose near free space of it.
    """

    def __init__(
        self, grid: OccupancyMap | PlaceMap, config: LocalizerConfig | None = None, start: ArrayLike | None = None
    ) -> None:
        self.config = config or LocalizerConfig()
        self.place = grid if isinstance(grid, PlaceMap) else PlaceMap(grid, self.config.place)
        self._evidence = Evidence(self.place, self.config.evidence)
        self._search = GlobalSearch(self.place, self._evidence, self.config.search)
        self._preparation = ScanPreparation(self.config.voxel_filter)
        self._start = None if start is None else self._checked(checked_pose(start, "start"))
        self._tracker: OdometryExtrapolator | None = None
        self._odometry: Array | None = None
        self._updates: list[Array | None] = []
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

    def update(self, odometry: ArrayLike, scan: LaserScan) -> LocalizationUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        self._odometry = checked_pose(odometry, before=self._odometry)
        prepared = self._preparation.prepare(self._odometry, scan)
        if self._start is not None:
            self._track_from(prepared.odometry, self._start)
        result = self._search_for(prepared) if self._tracker is None else self._track(self._tracker, prepared)
        self._start = None
        self._updates.append(result.pose)
        return result

    def _search_for(self, scan: PreparedScan) -> LocalizationUpdate:
        if len(scan.points) < self.config.min_points:
            return LocalizationUpdate(None, State.SEARCHING, False, None, None)
        return self._concluded(self._search.update(scan), scan)

    def _concluded(self, belief: PlaceBelief, scan: PreparedScan) -> LocalizationUpdate:
        """Return what a belief means; if it is sure, tracking begins."""
        explained = float(belief.explained[0]) if len(belief.explained) else None
        if not belief.sure:
            return LocalizationUpdate(None, State.SEARCHING, False, explained, belief)
        self._search.forget()
        self._track_from(scan.odometry, belief.poses[0])
        return LocalizationUpdate(belief.poses[0], State.TRACKING, True, explained, belief)

    def _track_from(self, odometry: Array, pose: Array) -> None:
        self._tracker = OdometryExtrapolator(self.config.extrapolator, odometry)
        self._tracker.correct(odometry, pose)
        self._matcher = GridScanMatcher(self.config.matcher)
        self._rejected, self._usual, self._blind_from = 0, 0.0, pose

    def _track(self, tracker: OdometryExtrapolator, scan: PreparedScan) -> LocalizationUpdate:
        prediction = tracker.predict(scan.odometry)
        if self._start is not None:
            prediction = Prediction(self._start, _START_SIGMA)
        distance = float(np.hypot(*(prediction.pose[:2] - self._blind_from[:2])))
        if len(scan.points) < self.config.min_points:
            if distance > self.config.blind_distance:
                return self._give_up(scan, prediction, prediction.pose)
            return LocalizationUpdate(prediction.pose, State.TRACKING, False, None, None)
        match = self._matcher.match(self.place, scan.points, prediction)
        assert match is not None  # there are enough points
        explained = float(self._evidence.judge(scan, match.pose[None])[1][0])
        if explained < max(self.config.least_of_usual * self._usual, self.config.least_explained):
            self._search.remember(scan)
            self._rejected += 1
            if self._rejected >= self.config.patience:
                return self._give_up(scan, prediction, match.pose)
            return LocalizationUpdate(prediction.pose, State.TRACKING, False, explained, None)
        if not self._reaches(prediction, match.pose):
            self._search.remember(scan)
            return self._give_up(scan, prediction, match.pose)
        if self._rejected:
            self._search.forget()
        self._usual = explained if self._usual == 0.0 else self._usual + _MEMORY * (explained - self._usual)
        self._rejected, self._blind_from = 0, match.pose
        tracker.correct(scan.odometry, match.pose)
        return LocalizationUpdate(match.pose, State.TRACKING, True, explained, None)

    def _give_up(self, scan: PreparedScan, prediction: Prediction, pose: Array) -> LocalizationUpdate:
        """Stop tracking; the map is searched, and where the scan fits best beside `pose` (3,) is one place of many.

        It is trusted only where the odometry may have led. Unrefined it would be judged worse by this scan than by the
        earlier ones, on which it is refined.
        """
        self._tracker = None
        self.lost += 1
        if len(scan.points) < self.config.min_points:
            return LocalizationUpdate(None, State.SEARCHING, False, None, None)
        beside = self._evidence.refine(scan.points, pose[None], coarse=True)
        self._search.propose(beside, self.config.trust if self._reaches(prediction, beside[0]) else 1.0)
        return self._concluded(self._search.search(), scan)

    def _reaches(self, prediction: Prediction, pose: Array) -> bool:
        """Return whether the odometry may have led to `pose` (3,): a search would not tell it from where it predicts.

        A scan of elsewhere fits badly at the prediction, and is matched where it looks alike, as far as that may be.
        """
        off, apart = between(prediction.pose, pose), self.config.search.separation
        reach = np.maximum((apart.linear, apart.angular), self.config.matcher.sigmas * prediction.sigma)
        return bool(np.hypot(off[0], off[1]) <= reach[0] and abs(off[2]) <= reach[1])
