"""The configuration of the RGB-D camera."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ....perception.rgbd.frame import Pinhole
from ....slam.bounds import FARTHEST_MOUNT_M, Share, Within
from ....slam.errors import InputError, unknown_name
from ...appearance.wardrobe import wardrobe
from ...limits.field_checks import PIXELS, Rate, check_fields

BACKENDS = ("rays", "opengl")
_View = Annotated[float, Within(0.01, np.pi - 0.01)]
_Tilt = Annotated[float, Within(-0.5 * np.pi, 0.5 * np.pi)]
_Depth = Annotated[float, Within(0.0, 1000.0)]
_Mount = Annotated[tuple[float, float, float], Within(-FARTHEST_MOUNT_M, FARTHEST_MOUNT_M)]


@dataclass(frozen=True, kw_only=True)
class RgbdConfig:
    """An RGB-D camera. Defaults follow the Kinect V2 on the robot of Zhang et al. 2019 (section 3).

    It looks level and straight ahead if not told otherwise, on the vertical axis of the laser if their mounts are the
    same. A frame is taken at one instant; its pixels are samples of the sensor's, not means of several.

    Attributes:
        width: Columns [pixels]; 512 on the real one.
        height: Rows [pixels]; 424 on the real one.
        horizontal_fov: Angle of view along a row [rad].
        vertical_fov: Angle of view along a column [rad].
        range_min: Shortest depth [m].
        range_max: Longest depth [m].
        rate_hz: Frames a second [Hz].
        mount: Pose (x, y, theta) of the camera in the robot frame [m, m, rad].
        camera_height: Height above the floor [m].
        pitch: How far its nose points down [rad].
        roll: How far its left side is up [rad].
        noise: Scale of the noise of depth, 1 for that of the literature (see `noise.py`), 0 for none.
        edge_missing: Probability that a pixel whose neighbour is much farther or nearer measures nothing.
        missing: Probability that any other pixel measures nothing.
        vibration: Standard deviation of pitch and of roll, drawn anew for each frame [rad].
        wardrobe: What people wear, see `envs/appearance/wardrobe.py`: "everyday", or "training" for frames to train on.
        backend: "rays", or "opengl" for MuJoCo's renderer.
    """

    width: Annotated[int, PIXELS] = 128
    height: Annotated[int, PIXELS] = 106
    horizontal_fov: _View = float(np.radians(70.0))
    vertical_fov: _View = float(np.radians(60.0))
    range_min: _Depth = 0.5
    range_max: _Depth = 8.0
    rate_hz: Rate = 10.0
    mount: _Mount = (0.1, 0.0, 0.0)
    camera_height: Annotated[float, Within(0.01, FARTHEST_MOUNT_M)] = 1.0
    pitch: _Tilt = 0.0
    roll: _Tilt = 0.0
    noise: Annotated[float, Within(0.0, 1000.0)] = 1.0
    edge_missing: Share = 0.7
    missing: Share = 0.002
    vibration: Share = 0.0
    wardrobe: str = "everyday"
    backend: str = "rays"

    def __post_init__(self) -> None:
        check_fields(self)
        if self.backend not in BACKENDS:
            raise unknown_name("camera back end", self.backend, BACKENDS)
        wardrobe(self.wardrobe)
        if not 0.0 < self.range_min < self.range_max:
            raise InputError(f"need 0 < `range_min` < `range_max` [m], got {self.range_min} and {self.range_max}")
        for name in ("edge_missing", "missing"):
            if not 0.0 <= getattr(self, name) < 1.0:
                raise InputError(f"`{name}` must be in [0, 1), got {getattr(self, name)}")
        _ = self.pinhole  # its own checks

    @property
    def pinhole(self) -> Pinhole:
        """The camera's geometry."""
        return Pinhole(
            width=self.width,
            height=self.height,
            horizontal_fov=self.horizontal_fov,
            vertical_fov=self.vertical_fov,
        )
