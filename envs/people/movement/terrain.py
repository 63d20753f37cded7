"""The building as walkers see it: the path, what stands beside it, and how far one can turn out."""

import numpy as np
from numpy.typing import NDArray

from ...scenes.polyline import resample, tangents
from ...scenes.scene import Scene
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
        path: (m, 2) the route, points `SPACING` apart [m].
        paths: (m + ..., 2) the route and, after it, the scene's walks, one after the other [m].
        tangents: As `paths`: unit vectors along them.
        first: (p,) row of `paths` at which each of them begins; path 0 is the route.
        count: (p,) how many rows each has.
        speed: As `paths`: recorded speed of whoever walked there [m/s]; NaN where nobody did.
        boxes: (b, 6) walls and furniture, see `nearest_of_box`.
        circles: (c, 3) x, y, radius of round furniture [m].
        lap: Length of one lap where the route is a closed lap, else 0 [m].
        half_width: Clear space to both sides of the route [m].
        length: Length of the route [m].
    """

    def __init__(self, scene: Scene) -> None:
        self.path = resample(scene.route, SPACING)
        each = [self.path, *(resample(walk.points, SPACING) for walk in scene.walks)]
        self.paths, self.tangents = np.concatenate(each), np.concatenate([tangents(points) for points in each])
        self.count = np.array([len(points) for points in each])
        self.first = np.cumsum(self.count) - self.count
        self.speed = np.concatenate([np.full(len(self.path), np.nan), *(walk.speeds(SPACING) for walk in scene.walks)])
        self.lap, self.half_width = scene.lap, scene.half_width
        self.length = (len(self.path) - 1) * SPACING
        solids = [solid for solid in scene.solids if solid.blocks_people]
        self.boxes = np.array(
            [(s.x, s.y, np.cos(s.yaw), np.sin(s.yaw), s.half_length, s.half_width) for s in solids if not s.is_round]
        ).reshape(-1, 6)
        self.circles = np.array([(s.x, s.y, s.radius) for s in solids if s.is_round]).reshape(-1, 3)
        free = free_sides(self.paths, self.tangents, self.boxes, self.circles, _CLEARANCE, _FURTHEST)
        self._free = np.concatenate([_narrowest(part) for part in np.split(free, self.first[1:])])
        index = np.arange(len(self.path))
        before, after = np.maximum(index - int(2.0 / SPACING), 0), np.minimum(index + int(2.5 / SPACING), index[-1])
        tangent = self.tangents[: len(self.path)]
        self._bend = (tangent[before] * tangent[after]).sum(axis=1) < 0.9
        self._wide = ~self._bend & (self._free[: len(self.path), 0] > self.passing - 0.1)

    def within_free(self, arc: float, lateral: float, path: int = 0) -> float:
        """Return the offset nearest to `lateral` [m] at which nothing stands beside a path at `arc` [m]."""
        left, right = self._free[self._row(arc, path)]
        return float(min(max(lateral, -right), left))

    def length_of(self, path: int) -> float:
        """Return the length of a path [m]."""
        return float(self.count[path] - 1) * SPACING

    def ahead(self, arc: float, path: int = 0) -> float:
        """Return the direction of a path at `arc` [m], in radians."""
        tangent = self.tangents[self._row(arc, path)]
        return float(np.arctan2(tangent[1], tangent[0]))

    @property
    def passing(self) -> float:
        """Offset from the path at which somebody passes the group [m]."""
        return self.half_width - 0.15

    @property
    def turn_out(self) -> float:
        """Offset from the path to which the group turns out for whom it meets [m]."""
        return min(0.35, max(0.0, self.half_width - 0.5))

    def in_bend(self, arc: float) -> bool:
        """Return whether the path turns between 2 m before and 2.5 m behind `arc` [m]."""
        return bool(self._bend[self._index(arc)])

    def narrows_before(self, arc: float, front: float) -> bool:
        """Return whether two can pass at `arc` [m], but not on all of the next 2.5 m against the path's direction.

        No further than `front` [m]; two can pass where there is no bend and nothing stands on the path's left.
        """
        here = self._index(arc)
        low = max(self._index(arc - 2.5), self._index(front), 0)
        return bool(self._wide[here]) and not self._wide[low:here].all()

    def place(self, arc: float, lateral: float, path: int = 0) -> Array:
        """Return the point (2,) at `arc` along a path and `lateral` to its left [m]."""
        row = self._row(arc, path)
        tangent = self.tangents[row]
        return self.paths[row] + lateral * np.array([-tangent[1], tangent[0]])

    def recorded_speed(self, arc: float, path: int) -> float:
        """Return the speed [m/s] at which somebody walked at `arc` along a path; NaN where it is no recorded one."""
        return float(self.speed[self._row(arc, path)])

    def _row(self, arc: float, path: int) -> int:
        return int(self.first[path]) + min(max(int(arc / SPACING), 0), int(self.count[path]) - 1)

    def _index(self, arc: float) -> int:
        return min(max(int(arc / SPACING), 0), len(self.path) - 1)


def _narrowest(free: Array) -> Array:
    """Return the least of `free` (m, 2) among the neighbours of each point, so that people turn out in time."""
    padded = np.pad(free, ((_BERTH, _BERTH), (0, 0)), mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * _BERTH + 1, axis=0).min(axis=-1)
