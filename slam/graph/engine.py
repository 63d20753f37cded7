"""The engine "cartographer": local SLAM, loop closure and graph optimisation behind the one protocol of all engines."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Cell, check_numbers, checked_pose
from ..engine import SlamUpdate
from ..geometry import between, turning
from ..grid import GridConfig, render_map
from ..growing_map import GrowingMap
from ..local.held_scans import Due
from ..local.learned_odometry import LearnedOdometry
from ..local.local_slam import LocalResult, LocalSlam, LocalSlamConfig
from ..occupancy_map import OccupancyMap
from ..pose_log import PoseLog
from ..scan import LaserScan
from ..scan_to_grid.extrapolator import ExtrapolatorConfig, Prediction
from ..settings import with_settings
from .loops.constraints import Constraint
from .loops.drive_mapping import DriveMapping
from .loops.global_config import GlobalSlamConfig
from .loops.global_slam import GlobalSlam
from .recovery.kidnap_recovery import KidnapRecovery

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CartographerConfig:
    """Settings of `Cartographer`.

    Attributes:
        local: Settings of local SLAM.
        global_: Settings of global SLAM; None: no loop is closed.
        recovery: Whether a robot that was carried is noticed and found again; without `global_` it never is.
        resolution: Side of a cell of the map that `map` returns [m].
    """

    local: LocalSlamConfig = field(default_factory=LocalSlamConfig)
    global_: GlobalSlamConfig | None = field(default_factory=GlobalSlamConfig)
    recovery: bool = True
    resolution: Cell = 0.05

    def __post_init__(self) -> None:
        check_numbers(self)


class Cartographer:
    """Graph SLAM of Cartographer's kind (Hess, Kohler, Rapp, Andor 2016); a `SlamEngine`.

    A scan that contradicts what was mapped, or odometry that is not believed, tells that the robot may have been
    carried, or slipped far. Mapping goes on, and once the robot has been found and followed elsewhere on the map of
    before, that loop is closed, or all that was mapped since is taken back and mapped again there. What wheels of the
    wrong size do to the odometry is learned from the matches.

    `SlamUpdate.diagnostics`: `score` (mean occupancy of the submap under the scan's points, 0 .. 1), `odometry_fault`
    (1: the robot moved otherwise than its odometry says).

    Args:
        config: Settings.

    Attributes:
        config: As given.
        calibration: What was learned of the wheels.
        clock: What was learned of how late the odometry is.
    """

    def __init__(self, config: CartographerConfig | None = None) -> None:
        self.config = config = config or CartographerConfig()
        self._learned = LearnedOdometry(config.local.extrapolator)
        self.calibration, self.clock = self._learned.calibration, self._learned.clock
        local = LocalSlam(config.local, self.calibration)
        self._global = GlobalSlam(config.global_, local.submaps, local.sweep) if config.global_ else None
        self._mapping = DriveMapping(local, self._global)
        self._record = self._mapping.record
        self._recovery = KidnapRecovery(self._mapping) if config.recovery and config.global_ else None
        self._odometry: Array | None = None
        self._online = PoseLog()
        self._live: GrowingMap | None = None  # only once `live_map` has been asked for

    @classmethod
    def from_options(cls, seed: int = 0, **options: Any) -> Self:
        """Return an engine with fields of `CartographerConfig` as keywords; nothing is random, so `seed` says nothing.

        Raises:
            InputError: If a field is unknown, or a value out of its range.
        """
        return cls(with_settings(CartographerConfig(), options))

    def update(self, odometry: ArrayLike, scan: LaserScan) -> SlamUpdate:
        """Take one scan and the robot's odometry pose T_odom_robot (3,) at that time."""
        self._odometry = checked_pose(odometry, before=self._odometry)
        odometry = self._learned.apply(self._odometry, scan)
        nodes = len(self._record.nodes)
        waits = self._mapping.wait(odometry, scan)
        result = waits or self._take(self._mapping.due(odometry, scan))
        assert result
        self._learned.learn(result, waits is not None)
        elsewhere = self._recovery.pose if self._recovery else None
        self._online.append(self._mapping.pose if elsewhere is None else elsewhere)
        self._trim()
        if self._live and (result.insertion or len(self._record.nodes) != nodes):
            self._live.follow(self.node_poses, self._record.nodes, self._record.scans)
        diagnostics = {"odometry_fault": float(result.odometry_fault or self._learned.has_stopped)}
        diagnostics |= {"score": result.match.score} if result.match else {}
        sure = not result.jumped and not (waits and waits.contradicts)
        located = elsewhere is not None or (sure and _is_on_the_map(self._global, self._recovery))
        covariance = None
        if self._global and elsewhere is None:
            covariance = _covariance(self._global, result, self.config.local.extrapolator, self.pose.item(2))
        return SlamUpdate(self.pose, result.insertion is not None, diagnostics, located, covariance)

    def _take(self, scans: Iterable[Due]) -> LocalResult | None:
        """Map scans, one after the other; return what became of the last one."""
        result = None
        for due in scans:
            result = self._mapping.match(due)  # predict, match, insert
            if self._learned.is_lost:
                result = replace(result, odometry_fault=True)
            if self._recovery:
                result = self._recovery.review(result, due.odometry, due.scan)
            self._mapping.add(due.odometry, result)  # add node, close loops
        return result

    def _trim(self) -> None:
        """Let what was seen again often enough leave the graph, unless some of it is being looked at."""
        if not self._global or (self._recovery and self._recovery.holds_nodes):
            return
        stay = self._global.trim()
        if stay is not None:
            self._mapping.trim(stay)
            if self._recovery:
                self._recovery.trimmed()

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot, the best estimate now."""
        return self._online[-1] if len(self._online) else np.zeros(3)

    def finish(self) -> None:
        """Match each node with all submaps around it, optimise the graph and straighten its submaps."""
        self._take(self._mapping.rest())
        if self._recovery:
            self._recovery.finish()
        if self._global:
            self._global.finish()

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan so far, as the graph has them now; after a drive, `finish` first."""
        if not self._global or not self._record.nodes:
            return self.local_trajectory()
        return self._record.trajectory(self._global.node_poses, self._global.trimmed_poses)

    def local_trajectory(self) -> Array:
        """Return (n, 3) T_local_robot of every scan, continuous and without loop closure."""
        return self._record.local_trajectory()

    def online_trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them, each the best knowledge of its time."""
        return self._online.array()

    @property
    def losses(self) -> int:
        """How often the robot was lost."""
        return self._recovery.losses if self._recovery else 0

    @property
    def relocalizations(self) -> int:
        """How often it was found again."""
        return self._recovery.relocalizations if self._recovery else 0

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """All constraints of the graph in force; those with `searched` are loop closures."""
        return tuple(self._global.graph.constraints) if self._global else ()

    @property
    def submap_nodes(self) -> list[dict[int, Array]]:
        """Of each submap, its nodes and where they stand in its drawing: (3,) T_submap_node."""
        return self._global.graph.drawn if self._global else []

    @property
    def rejected(self) -> int:
        """How many constraints were dropped because the optimised graph contradicts them."""
        return self._global.rejected if self._global else 0

    @property
    def node_poses(self) -> Array:
        """(k, 3) T_map_robot of the scans in the graph by what is known now."""
        if self._global:
            return self._global.node_poses
        return self.local_trajectory()[self._record.nodes]

    @property
    def node_scans(self) -> list[int]:
        """The scan that each node of the graph is, in order."""
        return list(self._record.nodes)

    def map(self) -> OccupancyMap:
        """Return the map that the inserted scans draw, with cells of `resolution`."""
        return self.map_at(self.config.resolution)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map with cells of `resolution` [m], drawn anew from scans whose place is known, if by odometry."""
        poses = self.trajectory()[self._record.nodes]
        known = self._global.graph.segments.placed_nodes if self._global else np.ones(len(poses), dtype=np.bool_)
        placed = np.flatnonzero(known).tolist()
        scans = [self._record.scans[k] for k in placed]
        return render_map(poses[placed], scans, GridConfig(resolution=resolution))

    def live_map(self) -> OccupancyMap:
        """Return the map to which each node is added at once, with cells of 5 cm; not to be written to."""
        if self._live is None:
            self._live = GrowingMap()
            self._live.follow(self.node_poses, self._record.nodes, self._record.scans)
        return self._live.map


def _is_on_the_map(graph: GlobalSlam | None, recovery: KidnapRecovery | None) -> bool:
    """Return whether nothing says that the robot was carried, or that only odometry too far off ties it to the map."""
    return (recovery is None or recovery.located) and (graph is None or graph.is_tied)


def _covariance(graph: GlobalSlam, result: LocalResult, odometry: ExtrapolatorConfig, heading: float) -> Array:
    """Return (3, 3) how far off the pose of a scan may be, map frame, where the robot has a `heading` [rad]."""
    nodes, turn = graph.graph.nodes, turning(heading)
    way = between(nodes[-1].pose_local, result.pose) if nodes else np.zeros(3)
    return turn @ graph.uncertainty.of(result, Prediction(way, odometry.sigma(way))) @ turn.T
