"""What the figures show of a drive: its most telling frame, and where the camera saw walls and other things."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ....perception.immobile.view import CameraView
from ....perception.rgbd.frame import RgbdFrame
from ....perception.rgbd.planes import Surface
from ....slam.geometry import compose, transform_points
from ....slam.scan import LaserScan
from .measures import cell_numbers, centres_of

Array = NDArray[np.float64]

_ENOUGH = 500
_CUT = 0.3
_CLASSES = (Surface.FLOOR, Surface.CEILING, Surface.WALL, Surface.TOP)


@dataclass(frozen=True, eq=False)
class Exhibit:
    """One moment of a drive.

    Attributes:
        colour: (h, w, 3) uint8 picture.
        depth: (h, w) [m], NaN for none.
        surface: (h, w) `Surface` of each pixel.
        person: (h, w) whether a pixel belongs to somebody.
        points: (h, w, 3) level frame of the camera, heights above the floor [m].
        scan: (m, 2) the laser's returns, robot frame [m].
        camera: (3,) pose of the camera in the robot frame.
        pose: (3,) T_map_robot.
        time_s: When [s].
    """

    colour: NDArray[np.uint8]
    depth: Array
    surface: NDArray[np.int8]
    person: NDArray[np.bool_]
    points: Array
    scan: Array
    camera: Array
    pose: Array
    time_s: Array


class Exhibits:
    """Collects them during a drive.

    Args:
        resolution: Side of a cell [m].
    """

    def __init__(self, resolution: float) -> None:
        self._resolution = resolution
        self._score, self._best = -1.0, None
        self._cells: dict[str, set[int]] = {"wall": set(), "thing": set()}

    def add_frame(self, frame: RgbdFrame, view: CameraView, scan: LaserScan, pose: Array, people: int) -> None:
        """Keep `frame` if it shows more kinds of surfaces, and more of `people` (pixels), than those before.

        People who are cut by the picture's sides or its upper edge count less.
        """
        planes, person = view.planes, view.people.label >= 0
        cut = person[0].any() or person[:, [0, -1]].any()
        counts = [*((planes.surface == surface).sum() for surface in _CLASSES), people]
        score = (_CUT if cut else 1.0) * float(np.prod([20 + min(int(count), _ENOUGH) for count in counts]))
        if score > self._score:
            self._score = score
            self._best = Exhibit(
                frame.colour,
                frame.depth.astype(np.float64),
                planes.surface,
                person,
                planes.points,
                scan.points_robot,
                np.array(frame.T_robot_camera),
                pose,
                np.array(frame.time_s),
            )

    def add_view(self, view: CameraView, pose: Array) -> None:
        """Note in which cells the camera saw walls, and in which other things."""
        T_map_camera = compose(pose, view.T_robot_camera)
        thing = np.isin(view.surface, (Surface.TOP, Surface.FACE, Surface.OTHER)) & (view.person < 0)
        for name, mine in (("wall", view.surface == Surface.WALL), ("thing", thing)):
            points = transform_points(T_map_camera, view.points[mine, :2])
            self._cells[name] |= cell_numbers(points, self._resolution)

    def write(self, path: Path) -> None:
        """Write everything to `path` (.npz)."""
        cells = {name: centres_of(found, self._resolution) for name, found in self._cells.items()}
        best = {} if self._best is None else vars(self._best)
        np.savez_compressed(path, **cells, **best)


def load_exhibit(path: Path) -> tuple[Exhibit, Array, Array]:
    """Return the best moment, and (n, 2) centres of the cells of walls and of other things seen, map frame."""
    with np.load(path, allow_pickle=False) as data:
        return Exhibit(**{name: data[name] for name in Exhibit.__dataclass_fields__}), data["wall"], data["thing"]
