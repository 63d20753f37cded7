"""The building as walkers see it: the path, what stands beside it, and how far one can turn out."""

import numpy as np
from numpy.typing import NDArray

from ...scenes.polyline import resample, tangents
from ...scenes.scene import Scene
from .ground import Ways, heading_at, length_of, narrows_before, passing, row_at, turn_out, within_free
from .walking import SPACING, free_sides

Array = NDArray[np.float64]

_CLEARANCE = 0.36
_FURTHEST = 1.6
_BERTH = 12


class Terrain:
    """What people need to know of a scene.

    Args:
        scene: The building.

    Attributes:
        ways: The route and the scene's walks.
        boxes: (b, 6) walls and furniture, see `nearest_of_box`.
        circles: (c, 3) x, y, radius of round furniture [m].
        lap: Length of one lap where the route is a closed lap, else 0 [m].
        length: Length of the route [m].
    """

    def __init__(self, scene: Scene) -> None:
        each = [resample(points, SPACING) for points in (scene.route, *(walk.points for walk in scene.walks))]
        paths, along = np.concatenate(each), np.concatenate([tangents(points) for points in each])
        count = np.array([len(points) for points in each])
        first = np.cumsum(count) - count
        speed = np.concatenate([np.full(count[0], np.nan), *(walk.speeds(SPACING) for walk in scene.walks)])
        self.lap, self.length = scene.lap, (count[0] - 1) * SPACING
        solids = [solid for solid in scene.solids if solid.blocks_people]
        self.boxes = np.array(
            [(s.x, s.y, np.cos(s.yaw), np.sin(s.yaw), s.half_length, s.half_width) for s in solids if not s.is_round]
        ).reshape(-1, 6)
        self.circles = np.array([(s.x, s.y, s.radius) for s in solids if s.is_round]).reshape(-1, 3)
        free = free_sides(paths, along, self.boxes, self.circles, _CLEARANCE, _FURTHEST)
        free = np.concatenate([_narrowest(part) for part in np.split(free, first[1:])])
        bends = _bends(along[: count[0]])
        sizes = np.array((scene.lap, scene.half_width))
        wide = ~bends & (free[: count[0], 0] > scene.half_width - 0.15 - 0.1)
        self.ways = Ways(paths, along, free, speed, first, count, bends, wide, sizes)

    def within_free(self, arc: float, lateral: float, path: int = 0) -> float:
        """Return the offset nearest to `lateral` [m] at which nothing stands beside a path at `arc` [m]."""
        return float(within_free(self.ways, path, arc, lateral))

    def length_of(self, path: int) -> float:
        """Return the length of a path [m]."""
        return float(length_of(self.ways, path))

    def ahead(self, arc: float, path: int = 0) -> float:
        """Return the direction of a path at `arc` [m], in radians."""
        return float(heading_at(self.ways, path, arc))

    @property
    def passing(self) -> float:
        """Offset from the path at which somebody passes the group [m]."""
        return float(passing(self.ways))

    @property
    def turn_out(self) -> float:
        """Offset from the path to which the group turns out for whom it meets [m]."""
        return float(turn_out(self.ways))

    def in_bend(self, arc: float) -> bool:
        """Return whether the path turns between 2 m before and 2.5 m behind `arc` [m]."""
        return bool(self.ways.bends[row_at(self.ways, 0, arc)])

    def narrows_before(self, arc: float, front: float) -> bool:
        """Return whether two can pass at `arc` [m], but not on all of the next 2.5 m against the path's direction.

        No further than `front` [m]; two can pass where there is no bend and nothing stands on the path's left.
        """
        return bool(narrows_before(self.ways, arc, front))

    def place(self, arc: float, lateral: float, path: int = 0) -> Array:
        """Return the point (2,) at `arc` along a path and `lateral` to its left [m]."""
        row = row_at(self.ways, path, arc)
        tangent = self.ways.tangents[row]
        return self.ways.points[row] + lateral * np.array([-tangent[1], tangent[0]])

    def recorded_speed(self, arc: float, path: int) -> float:
        """Return the speed [m/s] at which somebody walked at `arc` along a path; NaN where it is no recorded one."""
        return float(self.ways.speed[row_at(self.ways, path, arc)])


def _bends(along: Array) -> NDArray[np.bool_]:
    """Return (m,) whether a way with the unit vectors `along` (m, 2) turns from 2 m before to 2.5 m behind a point."""
    index = np.arange(len(along))
    before, after = np.maximum(index - int(2.0 / SPACING), 0), np.minimum(index + int(2.5 / SPACING), index[-1])
    return (along[before] * along[after]).sum(axis=1) < 0.9


def _narrowest(free: Array) -> Array:
    """Return the least of `free` (m, 2) among the neighbours of each point, so that people turn out in time."""
    padded = np.pad(free, ((_BERTH, _BERTH), (0, 0)), mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * _BERTH + 1, axis=0).min(axis=-1)
