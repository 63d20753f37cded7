"""What recordings for viewers have in common: a file that appears when it is whole, and numbers that are checked."""

import os
from abc import ABC, abstractmethod
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import FARTHEST_M
from ..errors import InputError, shown
from ..scan import LaserScan

MAP, ODOM, ROBOT, LASER, CAMERA = "map", "odom", "base_link", "laser", "camera"
"""Frames, as REP 105 names them; the camera's looks along x, as RViz and Foxglove draw bodies, not along z."""


class ViewerRecording(ABC):
    """One file of scans, poses, people; it appears whole when it is closed, or not at all.

    Used in a `with` block, it is closed at its end, and does not appear if an error ends it.

    Args:
        path: Of the file.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.file = Path(path)
        self._closed, self._mounted = False, False

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close(keep=kind is None)

    def close(self, *, keep: bool = True) -> None:
        """Finish the file; a second call does nothing.

        Args:
            keep: Whether it is to appear; if not, nothing is left of it.
        """
        if not self._closed:
            self._closed = True
            self._finish(keep)

    def scan(self, scan: LaserScan, topic: str = "/scan", time_s: float | None = None) -> None:
        """Write a scan; where its laser stands on the robot is written with the first one.

        Raises:
            InputError: If the recording cannot say it: it has no beams, or its time is negative.
        """
        time_s = scan.time_s if time_s is None else time_s
        if not self._mounted:
            self._mounted = True
            self.transform(time_s, scan.T_robot_lidar, ROBOT, LASER, fixed=True)
        self._write_scan(time_s, scan, topic)

    def people(
        self,
        time_s: float,
        positions: ArrayLike,
        ids: Sequence[int] | None = None,
        leader: int = -1,
        topic: str = "/people",
        frame: str = ODOM,
    ) -> None:
        """Write people at (n, 2); `ids` (n,) their numbers, `leader` the number of the one who leads.

        Raises:
            InputError: If a position is none, or the numbers are not as many.
        """
        places = np.asarray(positions, dtype=np.float64).reshape(-1, 2)
        if not (np.abs(places) <= FARTHEST_M).all():  # no NaN is
            raise InputError(f"positions of people must be within {FARTHEST_M:g} m, got {shown(places.tolist())}")
        numbers = list(range(len(places))) if ids is None else [int(number) for number in ids]
        if len(numbers) != len(places):
            raise InputError(f"needs a number for each of the {len(places)} people, got {len(numbers)}")
        self._write_people(time_s, places, numbers, leader, topic, frame)

    def _require_open(self) -> None:
        if self._closed:
            raise InputError(f"{self.file}: the recording is closed")

    @abstractmethod
    def transform(self, time_s: float, pose: ArrayLike, parent: str, child: str, *, fixed: bool = False) -> None:
        """Write where a frame is in its parent, (3,); `fixed` for good."""

    @abstractmethod
    def _write_scan(self, time_s: float, scan: LaserScan, topic: str) -> None: ...

    @abstractmethod
    def _write_people(
        self, time_s: float, places: NDArray[np.float64], numbers: Sequence[int], leader: int, topic: str, frame: str
    ) -> None: ...

    @abstractmethod
    def _finish(self, keep: bool) -> None: ...
