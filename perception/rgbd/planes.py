"""The planes of a frame: floor, ceiling, walls, table tops, faces (Zhang et al. 2019, section 4)."""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from .cloud import cloud, surface_normals
from .floor import Regions, find_floor, floor_tolerance, with_ceiling
from .frame import RgbdFrame
from .growing import grow_regions, settle
from .margins import margins
from .mount import Mount, MountConfig, believed, by_ceiling
from .noise import DepthNoise, measured_noise
from .reduction import reduced_frame

Array = NDArray[np.float64]

_FEWEST = 14
_REACH = 4
_LEAST_CEILING = 0.02  # of the picture
_STEEP = float(np.cos(np.radians(45.0)))


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
        mount: What mounts there are.
        noise: Of the depths: how far from its plane a point may lie.
        blurred: Where the standard deviation of the depths, as the frame itself shows it, is larger than this, things
            the size of a body are no more told apart [m]: a quarter of its thickness.
        least_pixels: Smallest region, as a share of the picture.
        turn: Largest angle between the normal of a pixel and of its plane [rad].
        flat: Seeds are no less flat than this, as a relative error of depth.
        ceiling_above: The ceiling is the highest horizontal plane above this [m].
        floor_within: Where the floor was not seen, it is a plane no farther than this from the height 0 [m].
        level: Largest angle between the ceiling's normal and the vertical, before the tilt is known [rad].
        upright: The same of any horizontal plane after that; and of an upright plane's from the horizontal [rad].
        connected: A vertical plane that comes this near to the ceiling is a wall [m].
        tall: So is one that the picture's upper edge cuts and that reaches this height [m].
        coplanar: Pieces of walls lie this near to each other's planes [m].
    """

    mount: MountConfig = field(default_factory=MountConfig)
    noise: DepthNoise = field(default_factory=DepthNoise)
    blurred: float = 0.06
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
            if name not in ("mount", "noise") and not getattr(self, name) > 0.0:
                raise InputError(f"`{name}` of the plane finder must be positive, got {getattr(self, name)}")


@dataclass(frozen=True, eq=False)
class Planes:
    """The planes of one frame.

    Pictures (h, w) are those of `frame`, which has fewer pixels than the one that was given if that had many.
    The level frame: origin on the floor below the camera, x forward, y left, z up, without the camera's tilt.

    Attributes:
        frame: The frame as it was worked at, about 140 columns.
        step: Each of its pixels stands for `step` x `step` of the frame that was given.
        points: (h, w, 3) in the level frame [m]; NaN where nothing was measured.
        surface: (h, w) int8 `Surface` of each pixel.
        region: (h, w) int32 number of the plane that each pixel belongs to, -1 for none.
        normals: (k, 3) of the planes, towards the camera, level frame.
        offsets: (k,) n p = d [m].
        kinds: (k,) int8 `Surface` of each plane.
        likelihood: (k,) how sure the kind is, in [0, 1].
        mount: How the camera is held: by this frame's floor, or what was known before.
        reach: Depth up to which the camera's noise lets things the size of a body be told apart [m].
    """

    frame: RgbdFrame
    step: int
    points: Array
    surface: NDArray[np.int8]
    region: NDArray[np.int32]
    normals: Array
    offsets: Array
    kinds: NDArray[np.int8]
    likelihood: Array
    mount: Mount
    reach: float

    @property
    def tilt(self) -> tuple[float, float]:
        """Pitch (nose down positive) and roll (left side up positive) of the camera [rad]."""
        return self.mount.pitch, self.mount.roll

    @property
    def tilt_known(self) -> bool:
        """Whether ceiling or floor of this frame told the tilt."""
        return self.mount.floor_seen or self.mount.ceiling_seen


class PlaneFinder:
    """Finds the planes of frames.

    Args:
        config: Parameters.
    """

    def __init__(self, config: PlaneConfig | None = None) -> None:
        self.config = config or PlaneConfig()

    def find(self, frame: RgbdFrame, before: Mount | None = None) -> Planes:
        """Return the planes of `frame`.

        Args:
            frame: The frame.
            before: The mount as the same camera's frame before it told (`Planes.mount`); it holds where this one shows
                no floor, and is doubted the more the longer ago that was.
        """
        small, step = reduced_frame(frame)
        scene = self._regions(small)
        mount = self._mount(small, scene, before)
        R_level_camera = mount.R_level_camera
        level = scene.points @ R_level_camera.T
        level[..., 2] += mount.height
        normals = scene.planes[:, :3] @ R_level_camera.T
        offsets = scene.planes[:, 3] + mount.height * normals[:, 2]
        on_floor = self._on_floor(scene, level, normals, offsets, mount)
        kinds, likelihood = self._kinds(level, scene.region, normals, offsets, on_floor, margins(small.depth).edge)
        measured = np.isfinite(level[..., 0])
        surface = np.where(measured, int(Surface.OTHER), int(Surface.NOTHING)).astype(np.int8)
        surface = np.where(scene.region >= 0, np.append(kinds, np.int8(0))[scene.region], surface)
        surface[on_floor] = Surface.FLOOR
        shown = measured_noise(small.depth, scene.flatness, self.config.noise)
        reach = shown.depth_of(self.config.blurred)
        return Planes(small, step, level, surface, scene.region, normals, offsets, kinds, likelihood, mount, reach)

    def _regions(self, frame: RgbdFrame) -> Regions:
        """Return the planar regions, camera frame."""
        points = cloud(frame)
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
        count, mean = _sizes(points, region, found)
        return Regions(points, normals, flatness, region, planes[:found].copy(), count, mean)

    def _mount(self, frame: RgbdFrame, scene: Regions, before: Mount | None) -> Mount:
        """Return the mount by the floor, or the tilt by the ceiling, or what is known without them."""
        config = self.config
        prior = believed(frame, config.mount, before)
        told = frame.camera_height is not None or before is not None
        floor = find_floor(scene, prior, config.mount, config.noise, told)
        level = floor or prior
        height = scene.mean @ level.up + level.height
        ceiling = (scene.planes[:, :3] @ level.up < -np.cos(config.level)) & (height > config.ceiling_above)
        ceiling &= scene.count > _LEAST_CEILING * scene.region.size
        if not ceiling.any():
            return level
        largest = int(np.argmax(np.where(ceiling, scene.count, -1)))
        if floor is not None:
            return with_ceiling(floor, scene, largest, config.noise)
        return by_ceiling(-scene.planes[largest, :3], prior)

    def _on_floor(
        self, scene: Regions, level: Array, normals: Array, offsets: Array, mount: Mount
    ) -> NDArray[np.bool_]:
        """Return (h, w) the points of the floor, if it is seen: near it, and nearer to no plane that is upright."""
        if not mount.floor_seen:
            return np.zeros(level.shape[:2], dtype=bool)
        over = np.abs(np.nan_to_num(level[..., 2], nan=np.inf))
        near = over < floor_tolerance(np.nan_to_num(scene.points[..., 0]), self.config.noise)
        upright = np.append(np.abs(normals[:, 2]) < _STEEP, False)[scene.region]
        rows, columns = np.nonzero(near & upright)
        mine = scene.region[rows, columns]
        away = np.abs((level[rows, columns] * normals[mine]).sum(axis=1) - offsets[mine])
        near[rows, columns] = away > over[rows, columns]
        return near

    def _kinds(
        self,
        level: Array,
        region: NDArray[np.int32],
        normals: Array,
        offsets: Array,
        on_floor: NDArray[np.bool_],
        edge: int,
    ) -> tuple[NDArray[np.int8], Array]:
        """Return (k,) the kind of each plane, and how sure it is; the picture's upper edge is the first `edge` rows."""
        config = self.config
        kinds = np.zeros(len(normals), dtype=np.int8)
        likelihood = np.ones(len(normals))
        if not len(normals):
            return kinds, likelihood
        count, mean = _sizes(level, region, len(normals))
        down, up = normals[:, 2] < -np.cos(config.upright), normals[:, 2] > np.cos(config.upright)
        upright = np.abs(normals[:, 2]) < np.sin(config.upright)
        kinds[up] = Surface.TOP
        if on_floor.any():
            shared = np.bincount(region[on_floor & (region >= 0)], minlength=len(normals))
            kinds[(normals[:, 2] > _STEEP) & (shared > 0.5 * count)] = Surface.FLOOR
        else:
            kinds[up & (np.abs(mean[:, 2]) < config.floor_within)] = Surface.FLOOR
        kinds[upright] = Surface.FACE
        above = down & (mean[:, 2] > config.ceiling_above)
        ceiling = float(mean[above, 2].max()) if above.any() else None
        if ceiling is not None:
            kinds[above & (mean[:, 2] > ceiling - config.connected)] = Surface.CEILING
        top, cut = _tops(level, region, len(normals), edge)
        connected = upright & (top > ceiling - config.connected) if ceiling is not None else np.zeros_like(upright)
        tall = upright & cut & ~connected & (top > config.tall)
        pieces = _coplanar(level, region, normals, offsets, connected | tall, upright, config)
        kinds[connected | tall | pieces] = Surface.WALL
        likelihood[(tall | pieces) & ~connected] = 0.7
        return kinds, likelihood


def _sizes(points: Array, region: NDArray[np.int32], count: int) -> tuple[NDArray[np.int64], Array]:
    """Return (k,) how many pixels each region has, and (k, 3) their mean."""
    inside = region >= 0
    number = np.bincount(region[inside], minlength=count)
    total = np.stack([np.bincount(region[inside], points[inside, axis], count) for axis in range(3)], axis=-1)
    return number, total / np.maximum(number, 1)[:, None]


def _tops(level: Array, region: NDArray[np.int32], count: int, edge: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return (k,) the height that each region reaches [m], and whether the picture's upper edge cuts it."""
    top, cut = np.full(count, -np.inf), np.zeros(count, dtype=bool)
    inside = region >= 0
    np.maximum.at(top, region[inside], level[inside, 2])
    highest = region[:edge]
    cut[np.unique(highest[highest >= 0])] = True
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
