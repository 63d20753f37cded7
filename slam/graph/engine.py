"""The engine "cartographer": local SLAM, loop closure and pose adjustment behind the one protocol of all engines."""

from array import array
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import Cell, check_numbers, checked_pose
from ..engine import SlamUpdate
from ..geometry import between, compose, wrap_angle
from ..grid import GridConfig, ScanRays, draw, render_map
from ..growing_map import GrowingMap
from ..localization.place_map import PlaceMap
from ..occupancy_map import OccupancyMap
from ..pose_log import PoseLog
from ..scan import LaserScan
from ..settings import with_settings
from .local.local_slam import LocalResult, LocalSlam, LocalSlamConfig
from .local.match_monitor import MatchMonitor, MatchMonitorConfig
from .loops.constraints import Constraint
from .loops.global_config import GlobalSlamConfig
from .loops.global_slam import GlobalSlam
from .recovery.kidnap_hypothesis import KidnapHypothesis, Verdict, verdict
from .recovery.relocalization import Relocalization, SearchRegion, searchable
from .recovery.scan_consistency import ScanConsistency, ScanConsistencyConfig

Array = NDArray[np.float64]

_SEARCHED = GridConfig(resolution=0.05)  # of the map on which a lost robot is searched for
_NEW_NODES = 10  # a map without so many of the last nodes still serves for that
_DRIFT = 2.0  # standard deviations of the odometry by which local SLAM may be led astray


@dataclass(frozen=True, kw_only=True)
class CartographerConfig:
    """Settings of `Cartographer`.

    Attributes:
        local: Settings of local SLAM.
        global_: Settings of global SLAM; None: no loop is closed.
        watch: When the robot counts as lost; None, or without `global_`: never.
        resolution: Side of a cell of the map that `map` returns [m].
    """

    local: LocalSlamConfig = field(default_factory=LocalSlamConfig)
    global_: GlobalSlamConfig | None = field(default_factory=GlobalSlamConfig)
    watch: MatchMonitorConfig | None = field(default_factory=MatchMonitorConfig)
    continuity: ScanConsistencyConfig = field(default_factory=ScanConsistencyConfig)
    resolution: Cell = 0.05

    def __post_init__(self) -> None:
        check_numbers(self)


class Cartographer:
    """Graph SLAM of Cartographer's kind (Hess, Kohler, Rapp, Andor 2016); a `SlamEngine`.

    A scan that does not go on from the one before tells that the robot may have been carried away (or slipped far).
    Where the map then shows that it is elsewhere, a new piece of the drive begins, apart from the map, and is joined to
    it once the robot has been found on the map again. Until that is settled it is not located.

    `SlamUpdate.diagnostics`: `score` (mean occupancy of the submap under the scan's points, 0 .. 1).

    Args:
        config: Settings.

    Attributes:
        losses: How often the robot was lost.
        relocalizations: How often it was found again.
    """

    def __init__(self, config: CartographerConfig | None = None) -> None:
        self.config = config or CartographerConfig()
        watched = self.config.watch if self.config.global_ else None
        self._watch = MatchMonitor(watched) if watched else None
        self._local = LocalSlam(self.config.local, self._watch)
        local, graph = self._local, self.config.global_
        self._global = GlobalSlam(graph, local.submaps, local.sweep) if graph else None
        self._odometry: Array | None = None
        self._online, self._poses_local = PoseLog(), PoseLog()
        self._inserted: list[int] = []
        self._trimmed = array("q")  # scans that were nodes and have left the graph
        self._doubted: list[tuple[int, Array]] = []
        self._scans: list[LaserScan] = []
        self._rays: list[ScanRays] = []
        self._continuity = ScanConsistency(self.config.continuity, self.config.local.extrapolator)
        self._doubt = KidnapHypothesis()
        self._breaks: list[int] = []
        self._search: Relocalization | None = None
        self._place: tuple[int, PlaceMap | None] = (-_NEW_NODES, None)
        self.losses = self.relocalizations = 0
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
        odometry = self._odometry = checked_pose(odometry, before=self._odometry)
        result = self._local.update(odometry, scan)
        if self._watch and self._global:
            result = self._weighed(self._watch, self._global, result, odometry, scan)
        if result.insertion:
            self._inserted.append(len(self._poses_local))
            self._scans.append(result.insertion.scan)
            if self._global:
                self._global.add_node(result.pose, result.insertion)
        self._find(odometry, scan, result.pose)
        self._settle(result)
        self._poses_local.append(result.pose)
        bridge = self._global.local_to_global if self._global else np.zeros(3)
        self._online.append(compose(bridge, result.pose))
        self._trim()
        if self._live and result.insertion:
            self._live.follow(self.node_poses, self._inserted, self._scans)
        diagnostics = {"score": result.match.score} if result.match else {}
        located = self._search is None and not (result.doubtful or self._doubt.unsure)
        return SlamUpdate(self.pose, result.insertion is not None, diagnostics, located)

    def _trim(self) -> None:
        """Let what was seen again often enough leave the map, unless some of it is being looked at."""
        if not self._global or self._search or self._doubt.nodes is not None:
            return
        stay = self._global.trim()
        if stay is None:
            return
        kept, gone = np.flatnonzero(stay.nodes).tolist(), np.flatnonzero(~stay.nodes).tolist()
        self._local.trim(stay.submaps)
        self._trimmed.extend(self._inserted[k] for k in gone)
        self._rays = [self._rays[k] for k in kept if k < len(self._rays)]
        self._inserted, self._scans = [self._inserted[k] for k in kept], [self._scans[k] for k in kept]
        self._place = (stay.node(self._place[0]), self._place[1]) if self._place[1] else self._place

    def _settle(self, result: LocalResult) -> None:
        """Keep where doubtful scans fit best; once a doubt is over and the robot was not lost, they have been there."""
        if result.doubtful and result.match:
            self._doubted.append((len(self._poses_local), result.match.pose))
            return
        for k, pose in self._doubted:
            self._poses_local[k] = pose
        self._doubted = []

    def _weighed(
        self, watch: MatchMonitor, graph: GlobalSlam, result: LocalResult, odometry: Array, scan: LaserScan
    ) -> LocalResult:
        """Weigh doubtful scans against the whole map where it is due; return what local SLAM makes of this one then."""
        pose = result.match.pose if result.match else result.pose
        torn = self._continuity.tears(scan, odometry, pose, result.doubtful and watch.in_doubt == 1)
        if result.apart and result.sigma is not None:
            if not self._doubt.torn:
                self._doubt = KidnapHypothesis()
            self._leap(graph, result.pose, result.sigma, odometry, scan)
            result = self._local.update(odometry, scan)
            if self._search or not (torn or self._doubt.torn):
                return result
        self._suspect(watch, result.doubtful, torn, odometry, scan)
        if not (watch.alarmed or (self._doubt.due and not self._search)):
            return result
        here = compose(graph.local_to_global, result.match.pose if result.match else result.pose)
        alarmed, search = watch.alarmed, self._relocalization(graph)
        match self._verdict(watch, graph, search, here, result):
            case Verdict.KIDNAPPED:
                self._lose(graph, search)
            case outcome:
                self._doubt.conclude(outcome)
                if not alarmed:
                    return result
                if result.match and result.sigma is not None and watch.far_off(result.pose, result.match.pose):
                    self._leap(graph, result.pose, result.sigma, odometry, scan)
                else:
                    watch.pardon()
        return self._local.update(odometry, scan)

    def _verdict(
        self, watch: MatchMonitor, graph: GlobalSlam, search: Relocalization, here: Array, result: LocalResult
    ) -> Verdict:
        """Return what the doubt comes to; who is lost already can only be lost again, where nothing fits."""
        if self._search or not result.match:
            return Verdict.KIDNAPPED if watch.plainly_lost else Verdict.UNSURE
        return verdict(self._doubt, watch, search.compare_places(here, self._doubt.trust, _DRIFT * graph.drift))

    def _suspect(self, watch: MatchMonitor, doubtful: bool, torn: float, odometry: Array, scan: LaserScan) -> None:
        """Keep the scans since something began to be wrong."""
        doubt = self._doubt
        if torn > doubt.torn and not self._search:
            doubt.tear(torn, len(self._scans))
        elif not doubt.torn and (not doubtful or watch.in_doubt == 1):
            doubt.begin()
        if doubtful or doubt.torn:
            doubt.add(odometry, scan)
        else:
            doubt.unsure = False

    def _relocalization(self, graph: GlobalSlam) -> Relocalization:
        """Return what looks for the doubtful scans on the map of all scans whose place is known."""
        known = len(self._scans) if self._doubt.nodes is None else self._doubt.nodes
        if known >= self._place[0] + _NEW_NODES:
            placed = np.flatnonzero(graph.placed[:known])
            self._rays += [ScanRays.of(scan, _SEARCHED) for scan in self._scans[len(self._rays) :]]
            grid = draw(graph.node_poses[placed], [self._rays[k] for k in placed], _SEARCHED)
            self._place = known, searchable(grid)
        return Relocalization(self._place[1], self._doubt.scans)

    def _leap(self, graph: GlobalSlam, pose: Array, sigma: Array, odometry: Array, scan: LaserScan) -> None:
        """Begin new submaps with the next update, tied to those before by the odometry alone, as after a gap in a log.

        Where the odometry does not know the place so well that a loop search would find it, the robot is lost.

        Args:
            graph: Global SLAM.
            pose: (3,) T_local_robot by the odometry.
            sigma: (2,) its standard deviations [m, rad].
            odometry: (3,) T_odom_robot at this scan.
            scan: The scan.
        """
        if not (sigma <= graph.reach).all():
            way = float(np.hypot(*(pose - self._poses_local[-1])[:2]))
            reach = SearchRegion.across(way, sigma, compose(graph.local_to_global, pose))
            if self._search:
                reach = self._search.reach.widened(reach) if self._search.reach else None
            self._doubt.add(odometry, scan)
            self._lose(graph, self._relocalization(graph), reach)
            return
        self._breaks.append(len(self._poses_local))
        self._begin_anew(graph)

    def _lose(self, graph: GlobalSlam, search: Relocalization, reach: SearchRegion | None = None) -> None:
        """Begin a new piece of the drive with the next update, and the search on the map without it.

        Args:
            graph: Global SLAM.
            search: The search, with the scans since the robot may have been lost.
            reach: Where the robot should be if nobody has carried it; None: it may have been carried.
        """
        self.losses += 1
        self._search = search
        search.begin(reach)
        since = len(self._doubt.scans)
        first = len(self._poses_local) + 1 - since
        self._breaks.append(first)
        graph.begin_piece(sum(k >= first for k in self._inserted[-since:]), reach is None)
        self._begin_anew(graph)
        self._doubt = KidnapHypothesis()

    def _begin_anew(self, graph: GlobalSlam) -> None:
        self._local.restart(graph.submaps)
        self._doubted = []

    def _find(self, odometry: Array, scan: LaserScan, pose_local: Array) -> None:
        """Go on with the search, if there is one; when it succeeds, join the new piece of the drive to the map."""
        if not self._search or not self._global:
            return
        found = self._search.update(odometry, scan, compose(self._global.local_to_global, pose_local))
        if found is not None:
            self._global.place_piece(found, pose_local)
            self._search = None
            self.relocalizations += 1

    @property
    def pose(self) -> Array:
        """(3,) T_map_robot, the best estimate now."""
        return self._online[-1] if len(self._online) else np.zeros(3)

    def finish(self) -> None:
        """Match each node with all submaps around it, optimise the graph and straighten its submaps."""
        if self._global:
            self._global.finish()

    def trajectory(self) -> Array:
        """Return (n, 3) T_map_robot for every scan so far, as the graph has them now; after a drive, `finish` first."""
        if not self._global or not self._inserted:
            return self.local_trajectory()
        nodes = np.concatenate((np.array(self._trimmed, dtype=np.int64), self._inserted)).astype(np.int64)
        poses = np.concatenate((self._global.trimmed_poses, self._global.node_poses))
        order = np.argsort(nodes)
        return _between_nodes(self.local_trajectory(), nodes[order], poses[order], self._breaks)

    def local_trajectory(self) -> Array:
        """Return (n, 3) T_local_robot of every scan, continuous and without loop closure."""
        return self._poses_local.array()

    def online_trajectory(self) -> Array:
        """Return (n, 3) T_map_robot as `update` returned them, each the best knowledge of its time."""
        return self._online.array()

    @property
    def constraints(self) -> tuple[Constraint, ...]:
        """All constraints of the graph in force; those with `searched` are loop closures."""
        return tuple(self._global.constraints) if self._global else ()

    @property
    def submap_nodes(self) -> list[dict[int, Array]]:
        """Of each submap, its nodes and where they stand in its drawing: (3,) T_submap_node."""
        return self._global.drawn if self._global else []

    @property
    def rejected(self) -> int:
        """How many constraints were dropped because the adjusted graph contradicts them."""
        return self._global.rejected if self._global else 0

    @property
    def node_poses(self) -> Array:
        """(k, 3) T_map_robot of the scans in the graph by what is known now; nothing is optimised for it."""
        if self._global:
            return self._global.node_poses.reshape(-1, 3)
        return self.local_trajectory()[self._inserted]

    @property
    def node_scans(self) -> list[int]:
        """The scan that each node of the graph is, in order."""
        return list(self._inserted)

    def map(self) -> OccupancyMap:
        """Return the map that the inserted scans draw, with cells of `resolution`."""
        return self.map_at(self.config.resolution)

    def map_at(self, resolution: float) -> OccupancyMap:
        """Return the map with cells of `resolution` [m], drawn anew from scans whose place is known, if by odometry."""
        poses = self.trajectory()[self._inserted]
        placed = np.flatnonzero(self._global.mappable) if self._global else range(len(poses))
        scans = [self._scans[k] for k in placed]
        return render_map(poses[placed], scans, GridConfig(resolution=resolution))

    def live_map(self) -> OccupancyMap:
        """Return the map to which each node is added at once, with cells of 5 cm; not to be written to."""
        if self._live is None:
            self._live = GrowingMap()
            self._live.follow(self.node_poses, self._inserted, self._scans)
        return self._live.map


def _between_nodes(local: Array, inserted: NDArray[np.int64], nodes: Array, breaks: list[int]) -> Array:
    """Return (n, 3) global poses of all scans: carried from the nodes before and after by the local trajectory, mixed.

    Args:
        local: (n, 3) T_local_robot of all scans.
        inserted: (k,) ascending, the scans that are nodes.
        nodes: (k, 3) T_global_robot of the nodes.
        breaks: First scans of pieces of the drive; across such a break nothing is mixed.
    """
    every = np.arange(len(local))
    after = np.minimum(np.searchsorted(inserted, every), len(inserted) - 1)
    before = np.maximum(np.searchsorted(inserted, every, side="right") - 1, 0)
    gap = np.maximum(inserted[after] - inserted[before], 1)
    share = np.clip((every - inserted[before]) / gap, 0.0, 1.0)[:, None]
    piece = np.searchsorted(breaks, every, side="right")
    apart = np.searchsorted(breaks, inserted[before], side="right") != np.searchsorted(
        breaks, inserted[after], side="right"
    )
    share[apart, 0] = piece[apart] == np.searchsorted(breaks, inserted[after[apart]], side="right")
    first = compose(nodes[before], between(local[inserted[before]], local))
    second = compose(nodes[after], between(local[inserted[after]], local))
    difference = second - first
    difference[:, 2] = wrap_angle(difference[:, 2])
    mixed = first + share * difference
    mixed[:, 2] = wrap_angle(mixed[:, 2])
    return mixed
