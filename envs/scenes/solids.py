"""What a building is made of: upright boxes and cylinders."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Solid:
    """An upright box or cylinder that stands, lies or hangs at a fixed place.

    Attributes:
        kind: What it is, e.g. "wall", "chair leg"; the top view and the colours go by it.
        x: Centre [m].
        y: Centre [m].
        yaw: Direction of the box's first side [rad].
        half_length: Half of the first side [m]; 0 for a cylinder.
        half_width: Half of the second side [m]; 0 for a cylinder.
        radius: Radius of a cylinder [m]; 0 for a box.
        bottom: Height of the lower face above the floor [m].
        top: Height of the upper face above the floor [m].
        blocks_people: Whether people walk around it (a chair blocks by its seat, not by each leg).
    """

    kind: str
    x: float
    y: float
    yaw: float = 0.0
    half_length: float = 0.0
    half_width: float = 0.0
    radius: float = 0.0
    bottom: float = 0.0
    top: float = 2.5
    blocks_people: bool = True

    @property
    def is_round(self) -> bool:
        """Whether it is a cylinder."""
        return self.radius > 0.0

    def at_height(self, height: float) -> bool:
        """Return whether a horizontal plane at `height` [m] cuts it."""
        return self.bottom < height < self.top

    def distance(self, points: ArrayLike) -> Array:
        """Return (...,) distances [m] of `points` (..., 2) in the plane to its outline, negative inside."""
        offset = np.asarray(points, dtype=np.float64) - (self.x, self.y)
        if self.is_round:
            return np.hypot(offset[..., 0], offset[..., 1]) - self.radius
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        along = np.abs(cos * offset[..., 0] + sin * offset[..., 1]) - self.half_length
        across = np.abs(cos * offset[..., 1] - sin * offset[..., 0]) - self.half_width
        outside = np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0))
        return outside + np.minimum(np.maximum(along, across), 0.0)

    def outline(self, segments: int = 16) -> Array:
        """Return its outline seen from above as a polygon (k, 2) [m], counter-clockwise; circles get `segments`."""
        if self.is_round:
            angles = np.arange(segments) * (2.0 * np.pi / segments)
            return np.stack((self.x + self.radius * np.cos(angles), self.y + self.radius * np.sin(angles)), axis=-1)
        corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (self.half_length, self.half_width)
        cos, sin = np.cos(self.yaw), np.sin(self.yaw)
        return corners @ np.array([[cos, sin], [-sin, cos]]) + (self.x, self.y)


def box(kind: str, low: tuple[float, float], high: tuple[float, float], top: float = 2.5, bottom: float = 0.0) -> Solid:
    """Return an axis-aligned box between the corners `low` and `high` (x, y) [m]."""
    return Solid(
        kind=kind,
        x=(low[0] + high[0]) / 2.0,
        y=(low[1] + high[1]) / 2.0,
        half_length=abs(high[0] - low[0]) / 2.0,
        half_width=abs(high[1] - low[1]) / 2.0,
        bottom=bottom,
        top=top,
    )


def post(kind: str, x: float, y: float, radius: float, top: float, *, blocks_people: bool = True) -> Solid:
    """Return a cylinder that stands on the floor."""
    return Solid(kind=kind, x=x, y=y, radius=radius, top=top, blocks_people=blocks_people)


def room(low: tuple[float, float], high: tuple[float, float], thickness: float = 0.2) -> tuple[Solid, ...]:
    """Return four walls around the free rectangle between the corners `low` and `high` (x, y) [m]."""
    (x0, y0), (x1, y1), t = low, high, thickness
    return (
        box("wall", (x0 - t, y0 - t), (x1 + t, y0)),
        box("wall", (x0 - t, y1), (x1 + t, y1 + t)),
        box("wall", (x0 - t, y0), (x0, y1)),
        box("wall", (x1, y0), (x1 + t, y1)),
    )
