"""One frame of an RGB-D camera, and the camera's geometry."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import FARTHEST_MOUNT_M, Within, check_mount, check_numbers, check_time
from ...slam.errors import InputError

Array = NDArray[np.float64]

_DEEPEST_M = 1e4  # no camera measures depths so far


@dataclass(frozen=True, kw_only=True)
class Pinhole:
    """A camera without distortion; pixel (0, 0) is the upper left one, its centre at (0.5, 0.5).

    Attributes:
        width: Columns [pixels].
        height: Rows [pixels].
        horizontal_fov: Angle between the left and the right edge of the picture [rad].
        vertical_fov: Angle between its upper and lower edge [rad].
    """

    width: Annotated[int, Within(0, 8192)]
    height: Annotated[int, Within(0, 8192)]
    horizontal_fov: float
    vertical_fov: float

    def __post_init__(self) -> None:
        check_numbers(self)
        if min(self.width, self.height) < 2:
            raise InputError(f"a camera needs at least 2 x 2 pixels, got {self.width} x {self.height}")
        for name in ("horizontal_fov", "vertical_fov"):
            if not 0.0 < getattr(self, name) < np.pi:
                raise InputError(f"`{name}` must be in (0, pi) [rad], got {getattr(self, name)}")

    @property
    def focal(self) -> tuple[float, float]:
        """Focal lengths along a row and along a column [pixels]."""
        return (
            self.width / 2.0 / float(np.tan(self.horizontal_fov / 2.0)),
            self.height / 2.0 / float(np.tan(self.vertical_fov / 2.0)),
        )

    @cached_property
    def rays(self) -> Array:
        """(height, width, 3) directions of the pixels' centres: x forward, y left, z up; the forward part is 1."""
        across, down = self.focal
        left = (self.width / 2.0 - 0.5 - np.arange(self.width)) / across
        up = (self.height / 2.0 - 0.5 - np.arange(self.height)) / down
        rays = np.ones((self.height, self.width, 3))
        rays[..., 1], rays[..., 2] = left[None, :], up[:, None]
        return rays


@dataclass(frozen=True, eq=False)
class RgbdFrame:
    """What the camera delivers at one time.

    The camera frame: x forward along its axis, y left, z up; it is believed to be level.

    Attributes:
        depth: (height, width) float32, distance along the camera's axis [m]; NaN where nothing was measured, which is
            what 0, less than 0 and more than a camera can see become: they write 0 or `inf` there.
        colour: (height, width, 3) uint8, red, green, blue.
        camera: The camera's geometry.
        time_s: Time of the exposure [s].
        T_robot_camera: Pose (x, y, theta) of the camera in the robot frame [m, m, rad].
        camera_height: Height of the camera above the floor [m].
    """

    depth: NDArray[np.float32]
    colour: NDArray[np.uint8]
    camera: Pinhole
    time_s: float
    T_robot_camera: tuple[float, float, float] = (0.0, 0.0, 0.0)
    camera_height: float = 1.0

    def __post_init__(self) -> None:
        size = (self.camera.height, self.camera.width)
        if self.depth.shape != size or self.colour.shape != (*size, 3):
            raise InputError(
                f"depth and colour of a camera of {size[0]} rows and {size[1]} columns must have shapes {size} and "
                f"{(*size, 3)}, got {self.depth.shape} and {self.colour.shape}"
            )
        check_time(self.time_s)
        check_mount(self.T_robot_camera, "T_robot_camera")
        if not abs(self.camera_height) <= FARTHEST_MOUNT_M:
            raise InputError(f"`camera_height` must be within {FARTHEST_MOUNT_M:g} m, got {self.camera_height}")
        unmeasured = (self.depth <= 0.0) | (self.depth > _DEEPEST_M)
        if unmeasured.any():
            object.__setattr__(self, "depth", np.where(unmeasured, np.float32(np.nan), self.depth))
