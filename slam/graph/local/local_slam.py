"""Local SLAM: a continuous, slowly drifting trajectory from odometry and scans, without loop closure."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...bounds import Cell, check_numbers
from ...errors import InputError
from ...geometry import between
from ...scan import LaserScan
from ...scan_to_grid.degenerate_direction import degenerate_direction
from ...scan_to_grid.extrapolator import ExtrapolatorConfig, Prediction
from ...scan_to_grid.scan_matcher import GridMatch, GridScanMatcher, GridScanMatcherConfig
from ...scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from .active_submaps import ActiveSubmaps, ActiveSubmapsConfig
from .match_monitor import MatchMonitor
from .motion_filter import MotionFilter, MotionFilterConfig
from .submap import Submap
from .sweep import Sweep
from .switching_motion import MotionHypothesis, SwitchingMotion

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LocalSlamConfig:
    """Settings of `LocalSlam`, one of each of its parts.

    Attributes:
        extrapolator: Error model of the odometry.
        motion_filter: Which scans are inserted.
        voxel_filter: Which points are matched.
        submaps: How submaps are made.
        matcher: How scans are matched.
        insertion_voxel: Returns within a voxel of this side are inserted as one [m].
    """

    extrapolator: ExtrapolatorConfig = field(default_factory=ExtrapolatorConfig)
    motion_filter: MotionFilterConfig = field(default_factory=MotionFilterConfig)
    voxel_filter: AdaptiveVoxelConfig = field(default_factory=AdaptiveVoxelConfig)
    submaps: ActiveSubmapsConfig = field(default_factory=ActiveSubmapsConfig)
    matcher: GridScanMatcherConfig = field(default_factory=GridScanMatcherConfig)
    insertion_voxel: Cell = 0.05

    def __post_init__(self) -> None:
        check_numbers(self)
        if not self.insertion_voxel > 0.0:
            raise InputError(f"`insertion_voxel` must be positive [m], got {self.insertion_voxel}")


@dataclass(frozen=True, eq=False)
class Insertion:
    """A scan that was inserted: what the pose graph makes a node of.

    Attributes:
        submaps: Indices of the submaps that it stands in.
        points: (N, 2) thinned returns for matching, robot frame [m].
        match: How it was matched; None: not at all (the first scan, or too few points).
        motion: By the odometry since the last inserted scan, in its frame; zero for the first.
        scan: The scan itself.
    """

    submaps: tuple[int, ...]
    points: Array
    match: GridMatch | None
    motion: Prediction
    scan: LaserScan


@dataclass(frozen=True, eq=False)
class LocalResult:
    """What local SLAM made of one scan.

    Attributes:
        pose: (3,) T_local_robot [m, m, rad].
        match: How the scan fits on the submap; None: it was not matched, the pose is that of the odometry.
        insertion: What was inserted; None: the motion filter dropped the scan, or it is inconsistent.
        inconsistent: Whether the scan contradicts the submap: then the pose is that of the odometry.
        sigma: (2,) standard deviations of that pose where the scan is inconsistent [m, rad]; else None.
        doubtful: Whether the robot was found far from where it was thought to be, and nothing has confirmed that yet.
        no_overlap: Whether the scan sees nothing of what the submap knows, as the first one after a gap in a log.
        odometry_fault: Whether the robot moved otherwise than its odometry says.
    """

    pose: Array
    match: GridMatch | None
    insertion: Insertion | None
    inconsistent: bool = False
    sigma: Array | None = None
    no_overlap: bool = False
    doubtful: bool = False
    odometry_fault: bool = False

    @property
    def matched_pose(self) -> Array:
        """(3,) T_local_robot where the scan fits best, believed or not; by the odometry where it was not matched."""
        return self.match.pose if self.match else self.pose


class LocalSlam:
    """Wires the parts of local SLAM up.

    Args:
        config: Settings.
        monitor: Notices that matching has failed; None: every match is believed.
    """

    def __init__(self, config: LocalSlamConfig, monitor: MatchMonitor | None = None) -> None:
        self._config = config
        self._monitor = monitor
        self._motion = SwitchingMotion(config.extrapolator)
        self._inserted_at: Array | None = None
        self._motion_filter = MotionFilter(config.motion_filter)
        self._voxel_filter = AdaptiveVoxelFilter(config.voxel_filter)
        self._active = ActiveSubmaps(config.submaps)
        self._matcher = GridScanMatcher(config.matcher)

    @property
    def submaps(self) -> list[Submap]:
        """Every submap so far; the last two are still growing."""
        return self._active.submaps

    def restart(self, known: int | None = None) -> None:
        """Begin a new drive segment: submaps anew, from where the odometry says the robot is.

        Args:
            known: So many submaps stay, as the last scan, which may have begun one, is taken anew; None: all.
        """
        self._active.restart(known)
        self._motion_filter = MotionFilter(self._config.motion_filter)
        self._matcher = GridScanMatcher(self._config.matcher)
        if self._monitor:
            self._monitor.restart()

    def trim(self, stay: NDArray[np.bool_]) -> None:
        """Drop the finished submaps where `stay` (one for each submap) is false."""
        self._active.trim(stay)

    def update(self, odometry: Array, scan: LaserScan) -> LocalResult:
        """Take one scan and the odometry pose T_odom_robot (3,) at that time: predict, match, insert."""
        hypotheses = self._motion.predict(odometry, scan.time_s)
        points = self._voxel_filter.apply(scan.points_robot)
        motion, match = self._match(scan, points, hypotheses)
        prediction = motion.prediction
        if match and self._monitor:
            submap, sensor = self._active.front, np.array(scan.T_robot_lidar[:2], dtype=np.float64)
            no_overlap = self._monitor.has_no_overlap(submap, points, prediction.pose, match.pose, match.score)
            if no_overlap or self._monitor.rejects(submap, points, sensor, match.pose, match.score):
                if match.retried:  # what contradicts the submap does not tell where the robot went, either
                    motion, prediction = hypotheses[0], hypotheses[0].prediction
                self._motion.take(hypotheses, motion, prediction.pose, False)
                return LocalResult(
                    prediction.pose, match, None, True, prediction.sigma, no_overlap, odometry_fault=not motion.sound
                )
        pose = match.pose if match else prediction.pose
        self._motion.take(
            hypotheses, motion, pose, match is not None or not self._active.begun, bool(match and match.retried)
        )
        insertion = self._insert(motion.odometry, scan, points, pose, match)
        return LocalResult(pose, match, insertion, doubtful=self._motion.jumped, odometry_fault=not motion.sound)

    def _match(
        self, scan: LaserScan, points: Array, hypotheses: list[MotionHypothesis]
    ) -> tuple[MotionHypothesis, GridMatch | None]:
        """Return the hypothesis that explains the scan best, and its match on the submap; None: there is none."""
        if not self._active.begun:
            return hypotheses[0], None
        degenerate = degenerate_direction(scan, points)
        believed_anyhow = self._monitor is not None and self._monitor.accepts_next
        front, anywhere = self._active.front, None if believed_anyhow else self._motion.anywhere
        matches = [self._matcher.match(front, points, h.prediction, degenerate, anywhere) for h in hypotheses]
        costs = [
            self._matcher.cost(match, len(points)) + motion.cost_at(match.pose) if match else motion.cost
            for motion, match in zip(hypotheses, matches, strict=True)
        ]
        best = int(np.argmin(costs))
        match = matches[best]
        if match and anywhere and match.retried:
            hypotheses[1:] = [self._motion.found(match.pose, anywhere.sigma)]
            return min(hypotheses, key=lambda motion: motion.cost_at(match.pose)), match
        return hypotheses[best], match

    def _insert(
        self, odometry: Array, scan: LaserScan, points: Array, pose: Array, match: GridMatch | None
    ) -> Insertion | None:
        """Insert a scan at `pose` (3,) if it has enough points, and the robot has moved since the last one."""
        if len(points) < self._config.matcher.min_points or not self._motion_filter.passes(pose):
            return None
        since = between(odometry if self._inserted_at is None else self._inserted_at, odometry)
        motion = Prediction(since, self._config.extrapolator.sigma(since))
        self._inserted_at = odometry
        return Insertion(self._active.insert(pose, self.sweep(scan)), points, match, motion, replace(scan))

    def sweep(self, scan: LaserScan) -> Sweep:
        """Return what a scan draws into a submap, robot frame."""
        return Sweep.of(scan, self._config.insertion_voxel, self._config.submaps.submap.free_ray_length)
