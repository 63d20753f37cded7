"""Local SLAM, the graph and the record of a drive, which take each scan together and can take scans back."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry import compose
from ...local.held_scans import Due
from ...local.local_slam import LocalResult, LocalSlam
from ...scan import LaserScan
from .drive_record import DriveRecord
from .global_slam import GlobalSlam
from .submap_graph import GraphMark
from .trimming import Renumbering

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DriveMark:
    """A drive as it was before a scan.

    Attributes:
        scans: So many scans there were.
        odometry: (3,) T_odom_robot at the last of them ...
        pose_local: ... and (3,) T_local_robot.
        graph: The graph.
    """

    scans: int
    odometry: Array
    pose_local: Array
    graph: GraphMark


class DriveMapping:
    """Maps a drive.

    Args:
        local: Local SLAM.
        graph: Global SLAM; None: no loop is closed.

    Attributes:
        local: As given.
        graph: As given.
        record: The drive so far.
    """

    def __init__(self, local: LocalSlam, graph: GlobalSlam | None) -> None:
        self.local, self.graph = local, graph
        self.record = DriveRecord()
        self._odometry = np.zeros(3)  # of the last scan
        self._waiting = 0  # scans at the end of the record that wait

    @property
    def T_global_local(self) -> Array:
        """(3,) by what is known now."""
        return self.graph.local_to_global if self.graph else np.zeros(3)

    @property
    def pose(self) -> Array:
        """(3,) T_global_robot at the last scan, by what is known now."""
        return compose(self.T_global_local, self.record.last_pose)

    def wait(self, odometry: Array, scan: LaserScan) -> LocalResult | None:
        """Return where a scan seems to be that has to wait until its odometry moves again; None: it need not."""
        result = self.local.wait(odometry, scan)
        if result:
            self.record.append(result.pose)
            self._waiting += 1
        return result

    def due(self, odometry: Array, scan: LaserScan) -> Iterator[Due]:
        """Yield what `match` and `add` are to take now, in order: the scans that have waited, and this one."""
        self._no_longer_wait()
        return self.local.due(odometry, scan)

    def rest(self) -> Iterator[Due]:
        """Yield the scans that still wait at the end of the drive."""
        self._no_longer_wait()
        return self.local.rest()

    def _no_longer_wait(self) -> None:
        self.record.take_back(self._waiting)
        self._waiting = 0

    def match(self, due: Due) -> LocalResult:
        """Predict, match and insert: return what local SLAM makes of a scan; `add` comes next."""
        return self.local.take(due)

    def add(self, odometry: Array, result: LocalResult) -> None:
        """Add the scan of a `result` to the graph if it was inserted, and close loops."""
        if result.insertion:
            self.record.add_node(result.insertion.scan)
            if self.graph:
                self.graph.add_node(result.pose, result.insertion)
                self.graph.close_loops()
        self.record.append(result.pose)
        self._odometry = odometry

    def trim(self, stay: Renumbering) -> None:
        """Take note that only these nodes and submaps have stayed in the graph."""
        self.local.trim(stay.submaps)
        self.record.trim(stay)

    def mark(self) -> DriveMark:
        """Return what `rewind` needs to take back all scans since the last that was added."""
        assert self.graph
        return DriveMark(len(self.record), self._odometry, self.record.last_pose, self.graph.mark())

    def rewind(self, mark: DriveMark, known: Sequence[tuple[Array, Array]] = ()) -> None:
        """Take back all scans since `mark`; those to come are a drive segment of their own, tied to nothing.

        Args:
            mark: What to go back to.
            known: (3,) T_odom_robot and T_local_robot of the first scans since: they stay there, but on no map.
        """
        assert self.graph
        self.graph.rewind(mark.graph)
        self.record.rewind(mark.scans, [pose for _, pose in known])
        self.local.restart(*(known[-1] if known else (mark.odometry, mark.pose_local)))
