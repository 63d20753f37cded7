"""One frame of an RGB-D camera, and the camera's geometry."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import FARTHEST_MOUNT_M, Within, check_mount, check_numbers, check_time
from ...slam.errors import InputError, shown

Array = NDArray[np.float64]

_DEEPEST_M = 1e4  # no camera measures depths so far
_NO_METRES = 100.0  # a frame whose depths are more than this in the middle is not in metres: cameras see 20 m
_UNDISTORT_ROUNDS = 20
_COEFFICIENTS = 8
_Focal = Annotated[tuple[float, float], Within(1e-3, 1e6)]
_Centre = Annotated[tuple[float, float], Within(-1e5, 1e5)]
_Coefficients = Annotated[tuple[float, ...], Within(-1e3, 1e3)]
_GREY = 128


@dataclass(frozen=True, kw_only=True)
class Pinhole:
    """A camera's geometry; pixel (0, 0) is the upper left one, its centre at (0.5, 0.5).

    Attributes:
        width: Columns [pixels].
        height: Rows [pixels].
        horizontal_fov: Angle between the left and the right edge of a picture whose middle is on the axis [rad].
        vertical_fov: Angle between its upper and lower edge [rad].
        centre: Where the camera's axis meets the picture, column and row [pixels]; None: in the middle.
        distortion: Coefficients k1, k2, p1, p2, k3 of Brown's model ("plumb_bob" of ROS), then k4, k5, k6 of the
            rational one ("rational_polynomial"); or the first few of them.
    """

    width: Annotated[int, Within(0, 8192)]
    height: Annotated[int, Within(0, 8192)]
    horizontal_fov: float
    vertical_fov: float
    centre: _Centre | None = None
    distortion: _Coefficients = ()

    def __post_init__(self) -> None:
        check_numbers(self)
        if min(self.width, self.height) < 2:
            raise InputError(f"a camera needs at least 2 x 2 pixels, got {self.width} x {self.height}")
        for name in ("horizontal_fov", "vertical_fov"):
            if not 0.0 < getattr(self, name) < np.pi:
                raise InputError(f"`{name}` must be in (0, pi) [rad], got {getattr(self, name)}")
        if len(self.distortion) > _COEFFICIENTS:
            raise InputError(f"`distortion` must be at most {_COEFFICIENTS} numbers, got {shown(self.distortion)}")

    @classmethod
    def from_intrinsics(
        cls, size: tuple[int, int], focal: _Focal, centre: _Centre, distortion: _Coefficients = ()
    ) -> "Pinhole":
        """Return the camera with what a `camera_info` or a calibration says.

        Args:
            size: Columns and rows [pixels].
            focal: fx and fy [pixels].
            centre: cx and cy [pixels]; as in OpenCV and ROS the centre of pixel (0, 0) is at (0, 0).
            distortion: k1, k2, p1, p2, k3, k4, k5, k6, or the first few of them.
        """
        for name, value in (("fx", focal[0]), ("fy", focal[1])):
            if not value > 0.0:
                raise InputError(f"`{name}` must be positive [pixels], got {shown(value)}")
        (width, height), (cx, cy) = size, centre
        return cls(
            width=width,
            height=height,
            horizontal_fov=float(2.0 * np.arctan2(width / 2.0, focal[0])),
            vertical_fov=float(2.0 * np.arctan2(height / 2.0, focal[1])),
            centre=(cx + 0.5, cy + 0.5),
            distortion=tuple(distortion),
        )

    @property
    def focal(self) -> tuple[float, float]:
        """Focal lengths along a row and along a column [pixels]."""
        return (
            self.width / 2.0 / float(np.tan(self.horizontal_fov / 2.0)),
            self.height / 2.0 / float(np.tan(self.vertical_fov / 2.0)),
        )

    @property
    def axis(self) -> tuple[float, float]:
        """Column and row where the camera's axis meets the picture [pixels]."""
        return self.centre or (self.width / 2.0, self.height / 2.0)

    @cached_property
    def rays(self) -> Array:
        """(height, width, 3) directions of the pixels' centres: x forward, y left, z up; the forward part is 1."""
        (across, down), (column, row) = self.focal, self.axis
        left = (column - 0.5 - np.arange(self.width)) / across
        up = (row - 0.5 - np.arange(self.height)) / down
        rays = np.ones((self.height, self.width, 3))
        rays[..., 1], rays[..., 2] = left[None, :], up[:, None]
        if any(self.distortion):
            right, below = _undistorted(-rays[..., 1], -rays[..., 2], self.distortion)
            rays[..., 1], rays[..., 2] = -right, -below
        return rays

    def reduced(self, step: int) -> "Pinhole":
        """Return the camera of a picture in which each pixel stands for `step` x `step` of this one's."""
        across, down = self.focal
        columns, rows = self.width // step, self.height // step
        column, row = self.axis
        return Pinhole.from_intrinsics(
            (columns, rows),
            (across / step, down / step),
            (column / step - 0.5, row / step - 0.5),
            self.distortion,
        )


def distorted(right: Array, below: Array, coefficients: tuple[float, ...]) -> tuple[Array, Array]:
    """Return where rays meet a picture with distortion: what the model says (OpenCV, `projectPoints`).

    Args:
        right: (...,) slopes of the rays to the right [1].
        below: (...,) and downwards [1].
        coefficients: As of `Pinhole.distortion`.
    """
    radial, across, down = _bent(right, below, coefficients)
    return right * radial + across, below * radial + down


def _bent(x: Array, y: Array, coefficients: tuple[float, ...]) -> tuple[Array, Array, Array]:
    """Return the factor by which rays are moved outwards, and by how much they are moved across and down."""
    k1, k2, p1, p2, k3, k4, k5, k6 = (*coefficients, *([0.0] * (_COEFFICIENTS - len(coefficients))))
    r2 = x * x + y * y
    under = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))
    radial = (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / np.where(np.abs(under) > 0.1, under, 0.1)
    return radial, 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x), p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y


def _undistorted(right: Array, below: Array, coefficients: tuple[float, ...]) -> tuple[Array, Array]:
    """Return where rays would meet a picture without distortion, by iteration as in OpenCV's `undistortPoints`."""
    x, y = right.copy(), below.copy()
    for _ in range(_UNDISTORT_ROUNDS):
        radial, across, down = _bent(x, y, coefficients)
        radial = np.where(np.abs(radial) > 0.1, radial, 0.1)
        x, y = (right - across) / radial, (below - down) / radial
    return x, y


@dataclass(frozen=True, eq=False)
class RgbdFrame:
    """What the camera delivers at one time.

    The camera frame: x forward along its axis, y left, z up.

    Attributes:
        depth: (height, width) float32, distance along the camera's axis [m]; NaN where nothing was measured, which is
            what 0, less than 0 and more than a camera can see become: they write 0 or `inf` there. Whole numbers are
            taken for millimetres, as cameras write them, and become metres.
        colour: (height, width, 3) uint8, red, green, blue; `grey(camera)` where there is only depth.
        camera: The camera's geometry.
        time_s: Time of the exposure [s].
        T_robot_camera: Pose (x, y, theta) of the camera in the robot frame [m, m, rad].
        camera_height: Height of the camera above the floor, about [m]; None if it is not known.
        tilt: Pitch (nose down positive) and roll (left side up positive) of the mount, about [rad]; None if they are
            not known. Where the floor is in sight, it tells them better.
    """

    depth: NDArray[np.float32]
    colour: NDArray[np.uint8]
    camera: Pinhole
    time_s: float = 0.0
    T_robot_camera: tuple[float, float, float] = (0.0, 0.0, 0.0)
    camera_height: float | None = 1.0
    tilt: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        size = (self.camera.height, self.camera.width)
        if self.depth.shape != size or self.colour.shape != (*size, 3):
            raise InputError(
                f"depth and colour of a camera of {size[0]} rows and {size[1]} columns must have shapes {size} and "
                f"{(*size, 3)}, got {self.depth.shape} and {self.colour.shape}"
            )
        check_time(self.time_s)
        check_mount(self.T_robot_camera, "T_robot_camera")
        if self.camera_height is not None and not abs(self.camera_height) <= FARTHEST_MOUNT_M:
            raise InputError(
                f"`camera_height` must be within {FARTHEST_MOUNT_M:g} m, or None, got {shown(self.camera_height)}"
            )
        if self.tilt is not None and not np.all(np.abs(self.tilt) <= np.pi):
            raise InputError(f"`tilt` must be two angles within pi [rad], or None, got {shown(self.tilt)}")
        object.__setattr__(self, "depth", _metres(self.depth))


def grey(camera: Pinhole) -> NDArray[np.uint8]:
    """Return the colour of a frame whose depth alone is known: what finds people goes by depth then."""
    return np.full((camera.height, camera.width, 3), _GREY, dtype=np.uint8)


def _metres(depth: NDArray[np.generic]) -> NDArray[np.float32]:
    """Return (h, w) depths in metres, NaN where nothing was measured; those of whole numbers are millimetres.

    Raises:
        InputError: If they are floats, and such as only millimetres can be.
    """
    if depth.dtype.kind in "iu":
        metres = depth.astype(np.float32) * np.float32(1e-3)
    elif depth.dtype.kind == "f":
        metres = depth.astype(np.float32, copy=False)
    else:
        raise InputError(f"depths must be millimetres as whole numbers or metres as floats, got {depth.dtype}")
    unmeasured = ~((metres > 0.0) & (metres <= _DEEPEST_M))
    if unmeasured.any():
        metres = np.where(unmeasured, np.float32(np.nan), metres)
    seen = metres[::4, ::4]
    seen = seen[np.isfinite(seen)]
    if len(seen) and np.median(seen) > _NO_METRES:
        raise InputError(
            f"depths given as floats must be metres, got {np.median(seen):g} in the middle: divide millimetres by "
            "1000, or give them as uint16"
        )
    return metres
