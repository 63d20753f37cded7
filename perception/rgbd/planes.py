"""The planes of a frame: floor, ceiling, walls, table tops, faces (Zhang et al. 2019, section 4)."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from .cloud import cloud, surface_normals
from .frame import RgbdFrame
from .growing import grow_regions, settle

Array = NDArray[np.float64]

_FEWEST = 14
_REACH = 4


class Surface(IntEnum):
    """What a pixel belongs to."""

    NOTHING = -1
    OTHER = 0
    FLOOR = 1
    CEILING = 2
    WALL = 3
    TOP = 4
    FACE = 5


@dataclass(frozen=True, kw_only=True)
class PlaneConfig:
    """Parameters of `PlaneFinder`.

    Attributes:
        least_pixels: Smallest region, as a share of the picture.
        turn: Largest angle between the normal of a pixel and of its plane [rad].
        flat: Seeds are no less flat than this, as a relative error of depth.
        ceiling_above: The ceiling is the highest horizontal plane above this [m].
        floor_within: The floor is no farther than this from the height 0 of the wheels [m].
        level: Largest angle between a horizontal plane's normal and the vertical, before the tilt is known [rad].
        upright: The same after that; and of a vertical plane's normal from the horizontal [rad].
        connected: A vertical plane that comes this near to the ceiling is a wall [m].
        tall: So is one that the picture's upper edge cuts, and that reaches this height [m].
        coplanar: Pieces of walls lie this near to each other's planes [m].
    """

    least_pixels: float = 0.0012
    turn: float = float(np.radians(22.0))
    flat: float = 0.05
    ceiling_above: float = 2.0
    floor_within: float = 0.1
    level: float = float(np.radians(12.0))
    upright: float = float(np.radians(10.0))
    connected: float = 0.2
    tall: float = 1.5
    coplanar: float = 0.08

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in self.__dataclass_fields__:
            if not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` of the plane finder must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Planes:
    """The planes of one frame.

    The level frame: origin on the floor below the camera, x forward, y left, z up, without the camera's tilt.

    Attributes:
        points: (h, w, 3) in the level frame [m]; NaN where nothing was measured.
        surface: (h, w) int8 `Surface` of each pixel.
        region: (h, w) int32 number of the plane that each pixel belongs to, -1 for none.
        normals: (k, 3) of the planes, towards the camera, level frame.
        offsets: (k,) n p = d [m].
        kinds: (k,) int8 `Surface` of each plane.
        likelihood: (k,) how sure the kind is, in [0, 1].
        tilt: Pitch (nose down positive) and roll (left side up positive) of the camera [rad].
        tilt_known: Whether ceiling or floor told the tilt; else it is zero.
    """

    points: Array
    surface: NDArray[np.int8]
    region: NDArray[np.int32]
    normals: Array
    offsets: Array
    kinds: NDArray[np.int8]
    likelihood: Array
    tilt: tuple[float, float]
    tilt_known: bool


class PlaneFinder:
    """Finds the planes of frames.

    Args:
        config: Parameters.
    """

    def __init__(self, config: PlaneConfig | None = None) -> None:
        self.config = config or PlaneConfig()

    def find(self, frame: RgbdFrame) -> Planes:
        """Return the planes of `frame`."""
        points = cloud(frame)
        region, planes = self._regions(frame, points)
        up, known = self._vertical(points, region, planes, frame.camera_height)
        R_level_camera = _levelling(up)
        level = points @ R_level_camera.T
        level[..., 2] += frame.camera_height
        normals = planes[:, :3] @ R_level_camera.T
        offsets = planes[:, 3] + frame.camera_height * normals[:, 2]
        kinds, likelihood = self._kinds(level, region, normals, offsets)
        surface = np.where(np.isfinite(points[..., 0]), int(Surface.OTHER), int(Surface.NOTHING)).astype(np.int8)
        surface = np.where(region >= 0, np.append(kinds, np.int8(0))[region], surface)
        tilt = (float(-np.arcsin(np.clip(up[0], -1.0, 1.0))), float(np.arctan2(up[1], up[2])))
        return Planes(level, surface, region, normals, offsets, kinds, likelihood, tilt, known)

    def _regions(self, frame: RgbdFrame, points: Array) -> tuple[NDArray[np.int32], Array]:
        """Return (h, w) regions and (k, 4) their planes, camera frame."""
        height, width = points.shape[:2]
        across, down = frame.camera.focal
        normals, flatness = np.empty_like(points), np.empty((height, width))
        surface_normals(points, np.array([1.0 / across, 1.0 / down]), normals, flatness)
        order = np.argsort(flatness, axis=None)
        seeds = order[: int((flatness < self.config.flat).sum())]
        region = np.full((height, width), -1, dtype=np.int32)
        planes = np.empty((256, 4))
        least = max(_FEWEST, round(self.config.least_pixels * height * width))
        found = grow_regions(points, normals, seeds, least, np.cos(self.config.turn), region, planes)
        settled = np.empty_like(region)
        for _ in range(2):
            settle(points, planes[:found], region, _REACH, settled)
            region, settled = settled, region
        return region, planes[:found].copy()

    def _vertical(
        self, points: Array, region: NDArray[np.int32], planes: Array, camera_height: float
    ) -> tuple[Array, bool]:
        """Return (3,) the vertical, camera frame, by the ceiling or else by the floor, and whether it is known."""
        count, mean = _sizes(points, region, len(planes))
        height = mean[:, 2] + camera_height
        ceiling = (planes[:, 2] < -np.cos(self.config.level)) & (height > self.config.ceiling_above)
        floor = (planes[:, 2] > np.cos(self.config.level)) & (np.abs(height) < 0.4)
        for found, sign in ((ceiling, -1.0), (floor, 1.0)):
            if found.any() and count[found].max() > 0.02 * region.size:
                largest = int(np.argmax(np.where(found, count, -1)))
                return sign * planes[largest, :3], True
        return np.array([0.0, 0.0, 1.0]), False

    def _kinds(
        self, level: Array, region: NDArray[np.int32], normals: Array, offsets: Array
    ) -> tuple[NDArray[np.int8], Array]:
        """Return (k,) the kind of each plane, and how sure it is."""
        config = self.config
        kinds = np.zeros(len(normals), dtype=np.int8)
        likelihood = np.ones(len(normals))
        if not len(normals):
            return kinds, likelihood
        _, mean = _sizes(level, region, len(normals))
        down, up = normals[:, 2] < -np.cos(config.upright), normals[:, 2] > np.cos(config.upright)
        upright = np.abs(normals[:, 2]) < np.sin(config.upright)
        kinds[up] = Surface.TOP
        kinds[up & (np.abs(mean[:, 2]) < config.floor_within)] = Surface.FLOOR
        kinds[upright] = Surface.FACE
        above = down & (mean[:, 2] > config.ceiling_above)
        ceiling = float(mean[above, 2].max()) if above.any() else None
        if ceiling is not None:
            kinds[above & (mean[:, 2] > ceiling - config.connected)] = Surface.CEILING
        top, cut = _tops(level, region, len(normals))
        connected = upright & (top > ceiling - config.connected) if ceiling is not None else np.zeros_like(upright)
        tall = upright & cut & ~connected & (top > config.tall)
        pieces = _coplanar(level, region, normals, offsets, connected | tall, upright, config)
        kinds[connected | tall | pieces] = Surface.WALL
        likelihood[(tall | pieces) & ~connected] = 0.7
        return kinds, likelihood


def _levelling(up: Array) -> Array:
    """Return (3, 3) R_level_camera: the smallest turn that brings `up` (3,), camera frame, to the z axis."""
    axis = np.array([up[1], -up[0], 0.0])
    sine, cosine = float(np.hypot(up[0], up[1])), float(up[2])
    if sine < 1e-12:
        return np.eye(3)
    x, y, _ = axis / sine
    cross = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + sine * cross + (1.0 - cosine) * cross @ cross


def _sizes(points: Array, region: NDArray[np.int32], count: int) -> tuple[NDArray[np.int64], Array]:
    """Return (k,) how many pixels each region has, and (k, 3) their mean."""
    inside = region >= 0
    number = np.bincount(region[inside], minlength=count)
    total = np.stack([np.bincount(region[inside], points[inside, axis], count) for axis in range(3)], axis=-1)
    return number, total / np.maximum(number, 1)[:, None]


def _tops(level: Array, region: NDArray[np.int32], count: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return (k,) the height that each region reaches [m], and whether the picture's upper edge cuts it."""
    top, cut = np.full(count, -np.inf), np.zeros(count, dtype=bool)
    inside = region >= 0
    np.maximum.at(top, region[inside], level[inside, 2])
    edge = region[:2]
    cut[np.unique(edge[edge >= 0])] = True
    return top, cut


def _coplanar(
    level: Array,
    region: NDArray[np.int32],
    normals: Array,
    offsets: Array,
    walls: NDArray[np.bool_],
    upright: NDArray[np.bool_],
    config: PlaneConfig,
) -> NDArray[np.bool_]:
    """Return (k,) the upright planes that are pieces of a wall: its plane goes on behind what stands before it."""
    _, mean = _sizes(level, region, len(normals))
    found = np.zeros_like(walls)
    for wall in np.flatnonzero(walls):
        same = normals @ normals[wall] > np.cos(config.upright)
        near = np.abs(mean @ normals[wall] - offsets[wall]) < config.coplanar
        found |= upright & ~walls & same & near
    return found
