"""What graph SLAM does about a robot that was kidnapped or slipped far: notice it, relocalize, join the map again."""

import numpy as np
from numpy.typing import NDArray

from ...geometry import between, compose
from ...scan import LaserScan
from ..local.local_slam import LocalResult, LocalSlam
from ..local.match_monitor import MatchMonitor
from ..loops.drive_record import DriveRecord
from ..loops.global_slam import GlobalSlam
from ..loops.trimming import Renumbering
from .kidnap_hypothesis import KidnapHypothesis, Verdict
from .node_map import NodeMap
from .place_comparison import compare_places
from .relocalization import Relocalization
from .scan_consistency import ScanConsistency
from .search_region import SearchRegion
from .verdict import BLOCKED, verdict

Array = NDArray[np.float64]

_PROBATION = 3.0, 10  # [m, scans] for which the robot must be followed on the map before it is believed to be there
_SAME = 0.5  # [m] within which the place that was found goes on as the robot does
_GIVE_UP = 20.0  # [m] after which a place that was not found is not sought any longer
_DRIFT = 2.0  # standard deviations of the odometry by which local SLAM may be led astray


class KidnapRecovery:
    """Weighs scans that contradict the map, and begins a new drive segment where the robot turns out to be elsewhere.

    Two things make it suspicious: a scan that is inconsistent with the one before, and scans in a row that contradict
    the submap they were matched on. From then on it collects scans and compares the place where the robot is thought to
    be with all others on the map. If another one wins, the robot is lost: a new drive segment begins, apart from the
    map, and is joined to it once relocalization has found the robot. After a gap in the log, where a scan has no
    overlap with its submap, new submaps begin; if the odometry over the gap is good, it ties them to the map at once.

    Args:
        monitor: Judges matches by the submap that they were made on.
        consistency: Compares each scan with the one before.
        local: Local SLAM.
        graph: Global SLAM.
        record: The drive.

    Attributes:
        losses: How often the robot was lost.
        relocalizations: How often it was found again.
    """

    def __init__(
        self,
        monitor: MatchMonitor,
        consistency: ScanConsistency,
        local: LocalSlam,
        graph: GlobalSlam,
        record: DriveRecord,
    ) -> None:
        self._monitor, self._consistency = monitor, consistency
        self._local, self._graph, self._record = local, graph, record
        self._map = NodeMap(graph, record)
        self._hypothesis = KidnapHypothesis()
        self._search: Relocalization | None = None
        self._lost_for = 0.0  # [m] driven since the robot was lost
        self._found_for: float | None = None  # [m] driven since it was found; None: it is not
        self._found_scans = 0
        self._patience = np.inf  # [m] for which it is sought; for good where it was carried, or crossed a gap
        self._carried = False  # whether walls of the map stop beams where the robot was thought to be
        self.losses = self.relocalizations = 0

    def review(self, result: LocalResult, odometry: Array, scan: LaserScan) -> LocalResult:
        """Return the result that counts: as given, or what local SLAM makes of the same scan in a new segment.

        Args:
            result: What local SLAM made of the scan.
            odometry: (3,) T_odom_robot.
            scan: The scan.
        """
        suspect = result.inconsistent and self._monitor.rejected == 1
        inconsistency = self._consistency.inconsistency(scan, odometry, result.matched_pose, suspect)
        beside = result.no_overlap and inconsistency > 0.0  # all that is known, and unlike what was seen just before
        if result.no_overlap and result.sigma is not None:
            if not self._hypothesis.inconsistency:
                self._hypothesis = KidnapHypothesis()
            self._cross_gap(result.pose, result.sigma, odometry, scan)
            result = self._local.update(odometry, scan)
            if self._search or not (inconsistency or self._hypothesis.inconsistency):
                return result
        self._collect(result, inconsistency, odometry, scan)
        self._hypothesis.unsure |= beside
        if not (self._monitor.alarmed or (self._hypothesis.due and not self._search)):
            return result
        return self._conclude(result, odometry, scan)

    def _collect(self, result: LocalResult, inconsistency: float, odometry: Array, scan: LaserScan) -> None:
        """Keep the scans since something began to be wrong."""
        hypothesis = self._hypothesis
        if inconsistency > hypothesis.inconsistency and not self._search:
            hypothesis.begin(inconsistency, len(self._record.scans))
        elif not hypothesis.inconsistency and (not result.inconsistent or self._monitor.rejected == 1):
            hypothesis.restart()
        if result.inconsistent or hypothesis.inconsistency:
            hypothesis.add(odometry, scan)
        else:
            hypothesis.unsure = False

    def _conclude(self, result: LocalResult, odometry: Array, scan: LaserScan) -> LocalResult:
        """Weigh the hypothesis and act on the verdict; return what local SLAM makes of the scan then."""
        alarmed = self._monitor.alarmed
        outcome = self._verdict(result)
        if outcome is Verdict.KIDNAPPED:
            self._lose()
            return self._local.update(odometry, scan)
        self._hypothesis.conclude(outcome)
        if not alarmed:
            return result
        matched = result.match.pose if result.match else None
        if matched is not None and result.sigma is not None and self._monitor.far_off(result.pose, matched):
            # The match leads where the odometry cannot have led, and no other place is known to be better.
            self._cross_gap(result.pose, result.sigma, odometry, scan)
        else:
            self._monitor.accept_next()
        return self._local.update(odometry, scan)

    def _verdict(self, result: LocalResult) -> Verdict:
        """Return what the hypothesis comes to; who is lost already can only be lost again, where nothing fits."""
        place, graph = self._map.up_to(self._hypothesis.trusted_nodes), self._graph
        if self._search and self._found_for is not None:
            return Verdict.HERE  # it is followed on the map; what its young submap does not know says nothing
        if self._search or not result.match:
            return Verdict.KIDNAPPED if self._monitor.clearly_lost else Verdict.UNSURE
        here, hypothesis = compose(graph.local_to_global, result.match.pose), self._hypothesis
        trust, drift = hypothesis.trust, _DRIFT * graph.drift
        comparison = place and compare_places(place, hypothesis.scans, here, trust=trust, drift=drift)
        self._carried = comparison is not None and comparison.blocked >= BLOCKED
        return verdict(hypothesis, self._monitor, comparison)

    def _cross_gap(self, pose: Array, sigma: Array, odometry: Array, scan: LaserScan) -> None:
        """Begin new submaps with the next update, tied to those before by the odometry alone, as after a gap in a log.

        Where the odometry does not know the place so well that a loop search would find it, the robot is lost.

        Args:
            pose: (3,) T_local_robot by the odometry.
            sigma: (2,) its standard deviations [m, rad].
            odometry: (3,) T_odom_robot at this scan.
            scan: The scan.
        """
        if (sigma <= self._graph.search_sigma).all():
            self._record.begin_segment(len(self._record))
            self._local.restart(self._graph.submaps)
            return
        distance = float(np.hypot(*(pose - self._record.last_pose)[:2]))
        region: SearchRegion | None = SearchRegion.across(distance, sigma, compose(self._graph.local_to_global, pose))
        if self._search:
            region = self._search.region.widened(region) if self._search.region and region else None
        self._hypothesis.add(odometry, scan)
        self._lose(region)

    def _lose(self, region: SearchRegion | None = None) -> None:
        """Begin a new drive segment with the next update, and the search on the map without it.

        Args:
            region: Where the robot should be if nobody has kidnapped it; None: it may be anywhere.
        """
        hypothesis, record = self._hypothesis, self._record
        self.losses += 1
        self._search = Relocalization(self._map.up_to(hypothesis.trusted_nodes), hypothesis.scans, region)
        self._lost_for, self._found_for = 0.0, None
        self._patience = np.inf if self._carried or region else _GIVE_UP
        first = len(record) + 1 - len(hypothesis.scans)
        self._graph.begin_segment(record.nodes_since(first), kidnapped=region is None)
        record.begin_segment(first)
        self._local.restart(self._graph.submaps)
        self._hypothesis = KidnapHypothesis()

    def relocalize(self, odometry: Array, scan: LaserScan, pose_local: Array) -> None:
        """Go on with the search, if there is one; when it succeeds, place the newest drive segment on the map.

        A place that was found is on probation first: the graph is tied to it only when the robot has been followed on
        the map for a while. Where none stands the test, the drive goes on by the odometry: loop closure decides.

        Args:
            odometry: (3,) T_odom_robot.
            scan: The scan.
            pose_local: (3,) T_local_robot of the scan, after review.
        """
        if not self._search:
            return
        step = float(np.hypot(*between(self._record.last_pose, pose_local)[:2]))
        self._lost_for += step
        expected = compose(self._graph.local_to_global, pose_local)
        found = self._search.update(odometry, scan, expected)
        if found is None:
            self._found_for = None if self._search.searching else self._found_for
        elif self._found_for is None or float(np.hypot(*between(expected, found)[:2])) > _SAME:
            self._found_for, self._found_scans = 0.0, 0
            self._graph.suppose_segment(found, pose_local)
        else:
            self._found_for, self._found_scans = self._found_for + step, self._found_scans + 1
            if self._found_for >= _PROBATION[0] and self._found_scans >= _PROBATION[1]:
                self._place(found, pose_local)
        if self._search and self._found_for is None and self._lost_for >= self._patience:
            self._graph.go_on_by_odometry()
            self._search = None

    def _place(self, pose: Array, pose_local: Array) -> None:
        self._graph.place_segment(pose, pose_local)
        self._search = None
        self.relocalizations += 1

    def finish(self) -> None:
        """Take note that the drive has ended: a place on probation is believed if enough scans stand for it."""
        if self._search and self._found_for is not None and self._found_scans >= _PROBATION[1]:
            self._place(compose(self._graph.local_to_global, self._record.last_pose), self._record.last_pose)

    def located(self, result: LocalResult) -> bool:
        """Return whether it is known where on the map the robot is, after a scan of which this came."""
        if self._search:  # the whole map vouches for it, whatever its young submap does not know
            return self._found_for is not None and not self._search.searching
        return not (result.inconsistent or result.doubtful or self._hypothesis.unsure)

    @property
    def holds_nodes(self) -> bool:
        """Whether a search goes on, or a hypothesis is about a map of certain nodes: none may leave the graph now."""
        return self._search is not None or self._hypothesis.trusted_nodes is not None

    def trim(self, stay: Renumbering) -> None:
        """Take the new numbers of the nodes that stay in the graph."""
        self._map.trim(stay)
