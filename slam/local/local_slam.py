"""Local SLAM: a continuous, slowly drifting trajectory from odometry and scans, without loop closure."""

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..bounds import Cell, check_numbers
from ..errors import InputError
from ..geometry import between
from ..scan import LaserScan
from ..scan_to_grid.extrapolator import ExtrapolatorConfig, Prediction
from ..scan_to_grid.scan_matcher import GridMatch, GridScanMatcher, GridScanMatcherConfig
from ..scan_to_grid.voxel_filter import AdaptiveVoxelConfig, AdaptiveVoxelFilter
from .active_submaps import ActiveSubmaps, ActiveSubmapsConfig
from .held_scans import Due, HeldScans
from .hypothesis_matching import HypothesisMatching, Look
from .match_monitor import MatchMonitor, MatchMonitorConfig
from .motion_filter import MotionFilter, MotionFilterConfig
from .odometry_calibration import OdometryCalibration
from .second_place import SecondPlace
from .submap import Submap
from .sweep import Sweep
from .switching_motion import MotionHypothesis, SwitchingMotion, likeliest

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
        monitor: When a scan contradicts its submap.
        insertion_voxel: Returns within a voxel of this side are inserted as one [m].
    """

    extrapolator: ExtrapolatorConfig = field(default_factory=ExtrapolatorConfig)
    motion_filter: MotionFilterConfig = field(default_factory=MotionFilterConfig)
    voxel_filter: AdaptiveVoxelConfig = field(default_factory=AdaptiveVoxelConfig)
    submaps: ActiveSubmapsConfig = field(default_factory=ActiveSubmapsConfig)
    matcher: GridScanMatcherConfig = field(default_factory=GridScanMatcherConfig)
    monitor: MatchMonitorConfig = field(default_factory=MatchMonitorConfig)
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
        drift: (2,) how far off that is likely to be by what was learned of the odometry [m, rad].
        scan: The scan itself.
    """

    submaps: tuple[int, ...]
    points: Array
    match: GridMatch | None
    motion: Prediction
    drift: Array
    scan: LaserScan


@dataclass(frozen=True, eq=False)
class LocalResult:
    """What local SLAM made of one scan.

    Attributes:
        pose: (3,) T_local_robot [m, m, rad].
        match: How the scan fits on the submap; None: it was not matched, the pose is that of the odometry.
        insertion: What was inserted; None: the motion filter dropped the scan.
        contradicts: Whether the scan contradicts the submap that it was matched on, as people around the laser do.
        odometry_fault: Whether the robot moved otherwise than its odometry says.
        jumped: Whether it was found far from where it was thought to be, and nothing has confirmed that yet.
    """

    pose: Array
    match: GridMatch | None
    insertion: Insertion | None
    contradicts: bool = False
    odometry_fault: bool = False
    jumped: bool = False


class LocalSlam:
    """Wires the parts of local SLAM up.

    Args:
        config: Settings.
        calibration: What is learned of the odometry.
    """

    def __init__(self, config: LocalSlamConfig, calibration: OdometryCalibration | None = None) -> None:
        self._config = config
        self._monitor = MatchMonitor(config.monitor)
        self._motion = SwitchingMotion(config.extrapolator)
        self._calibration = calibration or OdometryCalibration()
        self._inserted_at: Array | None = None
        self._driven = 0.0  # by then [m]
        self._motion_filter = MotionFilter(config.motion_filter)
        self._voxel_filter = AdaptiveVoxelFilter(config.voxel_filter)
        self._active = ActiveSubmaps(config.submaps)
        self._matcher = GridScanMatcher(config.matcher)
        self._matching = HypothesisMatching(self._matcher, self._active)
        self._ranges = np.empty(0)  # of the last scan
        self._held = HeldScans()
        self._second: SecondPlace | None = None

    @property
    def submaps(self) -> list[Submap]:
        """Every submap so far; the last two are still growing."""
        return self._active.submaps

    def restart(self, odometry: Array, pose: Array) -> None:
        """Begin anew: the next scan begins submaps apart from those before.

        Args:
            odometry: (3,) T_odom_robot of the scan before ...
            pose: ... and (3,) T_local_robot.
        """
        self._leave_map()
        self._motion, self._held = self._motion.restarted(odometry, pose), HeldScans()
        self._matcher = GridScanMatcher(self._config.matcher)
        self._matching = HypothesisMatching(self._matcher, self._active)
        self._monitor.restart()

    def _leave_map(self) -> None:
        """Begin submaps apart from those before with the next scan, wherever it is."""
        self._active.restart()
        self._motion_filter = MotionFilter(self._config.motion_filter)
        self._second = None

    def trim(self, stay: NDArray[np.bool_]) -> None:
        """Drop the finished submaps where `stay` (one for each submap) is false."""
        self._active.trim(stay)

    def wait(self, odometry: Array, scan: LaserScan) -> LocalResult | None:
        """Return where a scan seems to be that has to wait until its odometry moves again; None: it need not.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
        """
        if not self._held.wait(self._motion, odometry, scan):
            return None
        look = self._looked(scan, self._motion, self._motion.predict(odometry, scan.time_s))
        motion, match = look.motion, look.match
        if look.in_question:
            motion, match = likeliest(self._motion, look.hypotheses), None
        pose = match.pose if match else motion.prediction.pose
        self._held.looked(look, pose)
        contradicts = look.in_question or self._contradicts(scan, look, copy(self._monitor))
        self._motion.take(look.hypotheses, motion, pose, look.lead if match else None, match)
        return LocalResult(pose, match, None, contradicts, not motion.sound, self._motion.jumped)

    def _looked(self, scan: LaserScan, motion: SwitchingMotion, hypotheses: list[MotionHypothesis]) -> Look:
        """Match a scan; `hypotheses` are those of `SwitchingMotion.predict`."""
        points = self._voxel_filter.apply(scan.points_robot)
        return self._matching.match(motion, scan, points, hypotheses)

    def due(self, odometry: Array, scan: LaserScan) -> Iterator[Due]:
        """Yield what `update` is to take now, in order: the scans that have waited, and a scan that need not."""
        yield from self.rest(odometry)
        yield Due(odometry, scan)

    def rest(self, odometry: Array | None = None) -> Iterator[Due]:
        """Yield the scans that have waited; the next is at `odometry` (3,), or there is none.

        Each is to be taken before the next is asked for.
        """
        stands = odometry is not None and self._motion.stands_still(odometry)
        held, self._held = self._held, HeldScans(released=stands)
        if held.motion is None:
            return
        self._motion, left = held.motion, len(held.scans) + 1
        if odometry is None or stands or not self._motion.has_caught_up(odometry, left):
            yield from held.scans
            return
        steps = held.steps
        for k, due in enumerate(held.scans):
            at, bridge = self._motion.bridge(odometry, steps[k:])
            yield Due(at, due.scan, bridge)
        self._motion.leave_open(self._motion.config.sigma(between(held.scans[0].odometry, odometry)))

    def update(self, odometry: Array, scan: LaserScan) -> LocalResult:
        """Take one scan and the odometry pose T_odom_robot (3,) at that time: predict, match, insert."""
        return self.take(Due(odometry, scan))

    def take(self, due: Due) -> LocalResult:
        """Take one scan that is due: predict, match, insert."""
        scan = due.scan
        hypotheses = self._motion.predict(due.odometry, scan.time_s, due.bridge)
        repeated, self._ranges = np.array_equal(scan.ranges, self._ranges, equal_nan=True), scan.ranges
        if repeated:  # a driver has sent a scan once more: it tells nothing new
            return self._by_odometry(hypotheses[0], None, False)
        look = due.known(self._active.drawn) or self._looked(scan, self._motion, hypotheses)
        overtaken = self._second_thought(due, look)
        result = self._settled(scan, overtaken or look)
        return replace(result, odometry_fault=True) if overtaken else result

    def _second_thought(self, due: Due, look: Look) -> Look | None:
        """Follow the second place to a scan; return what was found there if by now the robot is rather there.

        Args:
            due: The scan.
            look: What was found of it at the first place.
        """
        second, self._second = self._second, None
        if due.bridge is not None:
            return None
        if second is None:
            self._second = SecondPlace(self._motion.copy(), look) if look.rival else None
            return None
        hypotheses = second.motion.predict(due.odometry, due.scan.time_s)
        there = self._looked(due.scan, second.motion, hypotheses)
        second.weigh(look, there)
        if second.is_likelier:
            self._motion = second.motion
            return there
        if not second.is_over:
            second.follow(there)
            self._second = second
        return None

    def _settled(self, scan: LaserScan, look: Look) -> LocalResult:
        """Take a scan for where it was found to be, or for what its odometry says, where that is doubtful."""
        ambiguous, hypotheses = not look.hypotheses[-1].sound, look.hypotheses
        points, motion, match, lead = look.points, look.motion, look.match, look.lead
        if look.in_question:
            self._monitor.doubt()
            return self._by_odometry(likeliest(self._motion, hypotheses), match, True)
        contradicts = self._contradicts(scan, look, self._monitor)
        if match and contradicts and (look.far or not self._matcher.explains(match)):
            if ambiguous or (self._matcher.is_beside(match) and not self._monitor.alarmed):
                return self._by_odometry(likeliest(self._motion, hypotheses), match, True)
            motion, match = hypotheses[0], None if look.far else match
        if match and self._matcher.is_beside(match):  # the robot has left the submap behind, as after a gap in a log
            self._leave_map()
            self._monitor.alarm()
            motion, match, contradicts = hypotheses[0], None, True
        return self._taken(hypotheses, motion, match, lead, scan, points, contradicts)

    def _contradicts(self, scan: LaserScan, look: Look, monitor: MatchMonitor) -> bool:
        if look.match is None:
            return False
        sensor = np.array(scan.T_robot_lidar[:2], dtype=np.float64)
        place = self._active.front, look.points, sensor, look.match.pose
        return monitor.rejects(*place, look.match.score)

    def _taken(
        self,
        hypotheses: list[MotionHypothesis],
        motion: MotionHypothesis,
        match: GridMatch | None,
        lead: float,
        scan: LaserScan,
        points: Array,
        contradicts: bool,
    ) -> LocalResult:
        """Take a scan for where it was matched, or where `motion` has it, and insert it."""
        if match is None and self._motion.anywhere is None:  # a gap in the log, and nothing that was seen before it
            self._leave_map()
        if match:
            self._matcher.believe(match)
        pose = match.pose if match else motion.prediction.pose
        told = match is not None or not self._active.begun
        self._motion.take(hypotheses, motion, pose, lead if told else None, match)
        insertion = self._insert(motion.odometry, scan, points, pose, match)
        return LocalResult(pose, match, insertion, contradicts, not motion.sound, self._motion.jumped)

    def _by_odometry(self, motion: MotionHypothesis, match: GridMatch | None, contradicts: bool) -> LocalResult:
        """Take a scan that does not tell where the robot went: its odometry alone does, and it is not inserted.

        Where too many scans in a row contradict the submap, that can hardly be right, and is given up.
        """
        pose = motion.prediction.pose
        self._motion.take([motion], motion, pose, None)
        if self._monitor.worn_out:
            self._leave_map()
            self._monitor.restart()
        return LocalResult(pose, match, None, contradicts, False, self._motion.jumped)

    def _insert(
        self, odometry: Array, scan: LaserScan, points: Array, pose: Array, match: GridMatch | None
    ) -> Insertion | None:
        """Insert a scan at `pose` (3,) if it has enough points, and the robot has moved since the last one."""
        if len(points) < self._config.matcher.min_points or not self._motion_filter.passes(pose):
            return None
        if match:
            self._motion.leave_open(np.zeros(2))
        since = between(odometry if self._inserted_at is None else self._inserted_at, odometry)
        motion = Prediction(since, self._config.extrapolator.sigma(since))
        drift = self._calibration.drift(self._motion.driven - self._driven)
        if self._motion.soundness.probability < 0.5:
            drift = np.hypot(drift, motion.sigma)
        self._inserted_at, self._driven = odometry, self._motion.driven
        return Insertion(self._active.insert(pose, self.sweep(scan)), points, match, motion, drift, replace(scan))

    def sweep(self, scan: LaserScan) -> Sweep:
        """Return what a scan draws into a submap, robot frame."""
        return Sweep.of(scan, self._config.insertion_voxel, self._config.submaps.submap.free_ray_length)
