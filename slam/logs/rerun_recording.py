"""Writes drives, maps and people as a recording of rerun (.rrd), drawn: points, lines, ways, pictures, curves."""

import os
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..bounds import checked_pose
from ..errors import InputError, MissingExtraError, shown
from ..files.foreign_writer import ForeignWriter
from ..files.output import replacing, require_writable
from ..occupancy_map import OccupancyMap
from ..scan import LaserScan
from .ros_messages import LEADER_COLOUR, PERSON_COLOUR, PERSON_HEIGHT_M, PERSON_WIDTH_M
from .viewer_recording import LASER, MAP, ODOM, ROBOT, ViewerRecording

_PLACES = {
    MAP: "map",
    ODOM: "map/odom",
    ROBOT: "map/odom/base_link",
    LASER: "map/odom/base_link/laser",
}
"""Frame -> entity; an entity moves with those above it. Other frames are entities of their own."""
_POINT_M = 0.02
_INK, _FAINT, _BLUE = (40, 44, 52), (120, 130, 150), (31, 87, 214)


class RerunRecording(ViewerRecording):
    """One .rrd file with the verbs of `RosRecording`; it appears whole when it is closed, or not at all.

    Args:
        path: Of the file, ending in .rrd.

    Raises:
        InputError: If the name ends otherwise, or nothing can be written there.
        MissingExtraError: If `rerun-sdk` is not installed.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._rerun = check_rerun_recording(path)
        super().__init__(path)
        self._replacing = ExitStack()
        self._temporary = self._replacing.enter_context(replacing(self.file))
        self._writer = ForeignWriter(self._temporary)  # rerun waits for ever for a disk that is full
        self._stream: Any = self._rerun.RecordingStream("tagalong")
        self._stream.save(str(self._writer.name))
        self._writer.begun()

    def _finish(self, keep: bool) -> None:
        self._stream.flush()
        self._stream.disconnect()
        if keep:
            with self._replacing:
                self._writer.close()
        else:
            with suppress(OSError):
                self._writer.close()
            self._temporary.unlink(missing_ok=True)

    def _write_scan(self, time_s: float, scan: LaserScan, topic: str) -> None:
        self._log(time_s, f"{_PLACES[LASER]}{topic}", self._points(scan.points, _INK))

    def odometry(self, time_s: float, pose: ArrayLike, velocity: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """Write odometry, T_odom_robot (3,)."""
        self.transform(time_s, pose, ODOM, ROBOT)
        self._numbers(time_s, "odom", velocity)

    def transform(self, time_s: float, pose: ArrayLike, parent: str, child: str, *, fixed: bool = False) -> None:
        """Write where a frame is in its parent, (3,); `fixed` for good."""
        rr, (x, y, theta) = self._rerun, checked_pose(pose, "pose").tolist()
        turn = rr.RotationAxisAngle(axis=(0.0, 0.0, 1.0), angle=rr.Angle(rad=theta))
        placed = rr.Transform3D(translation=(x, y, 0.0), rotation=turn)
        self._log(time_s, _place(child), placed, static=fixed)

    def pose(self, time_s: float, pose: ArrayLike, topic: str, frame: str = MAP) -> None:
        """Write a pose (3,) in a frame, as an arrow."""
        x, y, theta = checked_pose(pose, "pose").tolist()
        arrow = self._rerun.Arrows3D(
            origins=[(x, y, 0.0)], vectors=[(0.4 * np.cos(theta), 0.4 * np.sin(theta), 0.0)], colors=[_BLUE]
        )
        self._log(time_s, f"{_place(frame)}{topic}", arrow)

    def way(self, time_s: float, poses: NDArray[np.float64], topic: str = "/path", frame: str = MAP) -> None:
        """Write a way, (n, 3) poses in a frame."""
        line = np.column_stack((poses[:, :2], np.zeros(len(poses))))
        self._log(time_s, f"{_place(frame)}{topic}", self._rerun.LineStrips3D([line], colors=[_BLUE]))

    def map(self, time_s: float, grid: OccupancyMap, topic: str = "/map") -> None:
        """Write the occupied cells of a map."""
        self._log(time_s, f"{_PLACES[MAP]}{topic}", self._points(grid.occupied_points, _FAINT, grid.resolution / 2.0))

    def _write_people(
        self, time_s: float, places: NDArray[np.float64], numbers: Sequence[int], leader: int, topic: str, frame: str
    ) -> None:
        colours = [LEADER_COLOUR if number == leader else PERSON_COLOUR for number in numbers]
        half = (PERSON_WIDTH_M / 2.0, PERSON_WIDTH_M / 2.0, PERSON_HEIGHT_M / 2.0)
        bodies = self._rerun.Ellipsoids3D(
            centers=np.column_stack((places, np.full(len(places), half[2]))),
            half_sizes=[half] * len(places),
            colors=(255 * np.array(colours).reshape(-1, 3)).astype(np.uint8),
            labels=[str(number) for number in numbers],
        )
        self._log(time_s, f"{_place(frame)}{topic}", bodies)

    def picture(self, time_s: float, pixels: NDArray[Any], topic: str) -> None:
        """Write a picture: (h, w, 3) uint8 in colour, or (h, w) depths [m]."""
        rr = self._rerun
        kept = rr.Image(pixels) if pixels.ndim == 3 else rr.DepthImage(np.nan_to_num(pixels), meter=1.0)
        self._log(time_s, topic.strip("/"), kept)

    def command(self, time_s: float, velocity: ArrayLike) -> None:
        """Write a commanded velocity (forward, left, turn) as curves."""
        self._numbers(time_s, "cmd_vel", velocity)

    def number(self, time_s: float, value: float, topic: str) -> None:
        """Write one number, such as a reward, as a curve."""
        self._log(time_s, topic.strip("/"), self._rerun.Scalars(float(value)))

    def _numbers(self, time_s: float, name: str, velocity: ArrayLike) -> None:
        for part, value in zip(("forward", "left", "turn"), np.asarray(velocity, dtype=float).tolist(), strict=True):
            self._log(time_s, f"{name}/{part}", self._rerun.Scalars(value))

    def _points(self, points: NDArray[np.float64], colour: tuple[int, int, int], radius: float = _POINT_M) -> Any:
        flat = np.column_stack((points, np.zeros(len(points))))
        return self._rerun.Points3D(flat, colors=[colour], radii=[radius])

    def _log(self, time_s: float, entity: str, what: Any, *, static: bool = False) -> None:
        self._require_open()
        self._stream.set_time("time", duration=time_s)
        self._stream.log(entity, what, static=static)


def check_rerun_recording(path: str | os.PathLike[str]) -> Any:
    """Return rerun's library, if a recording could be written to `path`.

    Raises:
        InputError: If the name does not end in .rrd, or nothing can be written there.
        MissingExtraError: If `rerun-sdk` is not installed.
    """
    if Path(path).suffix != ".rrd":
        raise InputError(f"{shown(Path(path))}: a recording of rerun is called FILE.rrd")
    require_writable(path)
    try:
        import rerun  # pyright: ignore[reportMissingImports]
    except ImportError:
        raise MissingExtraError("recordings of rerun", "rerun") from None
    return rerun


def _place(frame: str) -> str:
    return _PLACES.get(frame, frame)
