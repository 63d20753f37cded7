"""What graph SLAM does about a robot that was carried: notice it, find it on the map, and go back to where it began."""

import numpy as np
from numpy.typing import NDArray

from ...local.held_scans import Due
from ...local.local_slam import LocalResult
from ...scan import LaserScan
from ..loops.drive_mapping import DriveMapping, DriveMark
from .doubt import Doubt
from .node_map import NodeMap

Array = NDArray[np.float64]

_GIVE_UP = 20.0  # [m] after which a doubt that nothing confirms is dropped
_MOST_SCANS = 5000  # that are kept to be taken again
_SETTLED = 2.0  # [m] for which it holds that a doubt was settled: people walk along
_KNOWN = 5  # of the last scans of before say how well scans usually fit the map


class KidnapRecovery:
    """Looks on while a drive is mapped, and changes nothing unless the robot is found elsewhere on its map.

    In words:

    - A scan that contradicts the submap raises a doubt, and so do one that is found far from where it was expected, and
      odometry that is not believed: the robot may have been carried to where it looks alike, for what is known of the
      last metres. Mapping goes on meanwhile.
    - The doubt ends where the scans fit the map of before where local SLAM has the robot.
    - It ends, too, after a while, unless that map rules out that it is there.
    - Where the map rules it out, and the robot has been followed on it elsewhere for a while, the map has drifted, or
      the robot was carried. It has drifted if local SLAM never left its submap and the graph agrees with a closure of
      that loop, for which there are some metres' time.
    - Else it was carried. When, is told by the scans: first they fit better where local SLAM had the robot, then along
      the way to where it was found. The latter are taken back and mapped again as a drive segment, at that place.
    - Where it is ruled out but the robot is never found, the drive ends with such a segment that has no place.

    So a drive on which no robot is found elsewhere is mapped as if nobody looked on; only nodes leave the graph later.

    Args:
        mapping: Maps the drive.

    Attributes:
        losses: How often the robot was carried.
        relocalizations: How often it was found again.
    """

    def __init__(self, mapping: DriveMapping) -> None:
        assert mapping.graph
        self._mapping, self._graph = mapping, mapping.graph
        self._record = mapping.record
        self._map = NodeMap(mapping.graph, mapping.record)
        self._mark: DriveMark | None = None  # before the first of the scans in a row that contradict the submap
        self._scans: list[tuple[Array, LaserScan, Array]] = []  # since then: odometry, scan and T_local_robot
        self._unweighed: list[tuple[Array, LaserScan, Array]] = []  # odometry, scan and T_local_robot
        self._doubt: Doubt | None = None
        self._apart = False  # whether the drive segment has no place
        self._settled_at = -np.inf  # way at which the last doubt ended [m]
        self.losses = self.relocalizations = 0

    def review(self, result: LocalResult, odometry: Array, scan: LaserScan) -> LocalResult:
        """Return the result that counts: as given, or what local SLAM makes of the same scan in a new segment.

        Args:
            result: What local SLAM made of the scan, which is in no graph yet.
            odometry: (3,) T_odom_robot.
            scan: The scan.
        """
        suspicious = result.contradicts or result.odometry_fault or result.jumped
        if not self._doubt and (not suspicious or len(self._scans) >= _MOST_SCANS):
            self._forget()
            return result
        if not self._apart:
            self._mark = self._mark or self._mapping.mark()
            self._scans.append((odometry, scan, result.pose))
        self._unweighed.append((odometry, scan, result.pose))
        if not self._doubt and self._record.way - self._settled_at >= _SETTLED:
            self._doubt = self._new_doubt()
        if not self._doubt:
            return result
        for at, seen, pose in self._unweighed:
            self._doubt.weigh(at, seen, pose, self._mapping.T_global_local)
        self._unweighed = []
        return self._concluded(self._doubt, result)

    def _new_doubt(self, lost: bool = False) -> Doubt:
        assert self._mark
        poses = self._mark.graph.node_poses
        known = [(self._record.scans[k], poses[k]) for k in range(len(poses))[-_KNOWN:]]
        around = self._map.of(poses) if lost else self._map.around(poses)
        return Doubt(around, lambda: self._map.of(poses), known, self._graph.closable, lost)

    def _concluded(self, doubt: Doubt, result: LocalResult) -> LocalResult:
        """End the doubt where there is reason to; return the result that counts."""
        carried = not doubt.settled and doubt.found and doubt.changed < doubt.scans
        if carried:
            result = self._found(doubt, result)
        elif doubt.settled or doubt.found or (not doubt.impossible and doubt.travelled >= _GIVE_UP):
            self._forget()
            self._settled_at = self._record.way
        elif not self._apart and doubt.scans >= _MOST_SCANS:
            lost = self._new_doubt(lost=True) if doubt.impossible else None
            result = self._set_apart() if lost else result
            self._doubt = lost
        return result

    def _found(self, doubt: Doubt, result: LocalResult) -> LocalResult:
        """Close the loop to where the robot was found, or map it there from when it was carried.

        That waits for some metres where local SLAM has followed the robot: a closure may tell yet that the map drifted.
        """
        assert doubt.elsewhere is not None
        followed = self._followed
        drifted = followed and self._graph.close_at(doubt.elsewhere, result.pose)
        if followed and not drifted and doubt.travelled < _GIVE_UP:
            return result
        if not drifted:
            result = result if self._apart else self._set_apart(doubt.changed)
            self._graph.place_segment(doubt.elsewhere, result.pose)
            self.relocalizations += 1
        self._forget()
        return result

    @property
    def _followed(self) -> bool:
        """Whether local SLAM has followed the robot since the doubt began, and never left its submap."""
        if self._mark is None:
            return False
        graph = self._graph.graph
        return graph.pieces.first_node(len(graph.nodes) - 1) < len(self._mark.graph.node_poses)

    def finish(self) -> None:
        """Take note that the drive has ended: what a doubt has come to by now counts."""
        doubt = self._doubt
        if doubt and (doubt.impossible or doubt.followed) and not self._apart:
            odometry, _, _ = self._scans[-1]
            first = min(doubt.changed, len(self._scans) - 1) if doubt.followed else 0
            self._mapping.add(odometry, self._set_apart(first))
        if doubt and doubt.followed and doubt.elsewhere is not None:
            self._graph.place_segment(doubt.elsewhere, self._record.last_pose)
            self.relocalizations += 1
            self._forget()

    @property
    def pose(self) -> Array | None:
        """(3,) T_map_robot at the last scan where the robot seems to be elsewhere than local SLAM has it; else None."""
        return self._doubt.elsewhere if self._doubt else None

    @property
    def located(self) -> bool:
        """Whether it is known where on the map the robot is."""
        if self._doubt:
            return self._doubt.possible or self._doubt.elsewhere is not None
        return self._mark is None

    @property
    def holds_nodes(self) -> bool:
        """Whether scans may have to be taken back, so that no node may leave the graph now."""
        return self._doubt is not None or self._mark is not None

    def trimmed(self) -> None:
        """Take note that nodes have left the graph."""
        self._map.forget()

    def _set_apart(self, first: int = 0) -> LocalResult:
        """Map the scans of the doubt from the `first` on anew as a segment; return what became of the last one."""
        assert self._mark
        before, (*scans, last) = self._scans[:first], self._scans[first:]
        self._mapping.rewind(self._mark, [(odometry, pose) for odometry, _, pose in before])
        for odometry, scan, _ in scans:
            self._mapping.add(odometry, self._mapping.match(Due(odometry, scan)))
        odometry, scan, _ = last
        result = self._mapping.match(Due(odometry, scan))
        self._apart, self._mark, self._scans = True, None, []
        self.losses += 1
        return result

    def _forget(self) -> None:
        """Take the robot for where local SLAM has it."""
        self._doubt, self._mark, self._scans, self._unweighed, self._apart = None, None, [], [], False
