"""The RGB-D camera of a world."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ....perception.rgbd.frame import RgbdFrame
from ...appearance.looks import Looks
from ...physics.mj import MjData, MjModel
from .config import RgbdConfig
from .noise import measure_depth
from .opengl import OpenGlCamera
from .rays import Exact, RayCamera

Array = NDArray[np.float64]


class Caster(Protocol):
    """Makes exact pictures."""

    def cast(self, data: MjData, origin: Array, rotation: Array) -> Exact:
        """Return the picture seen from `origin` (3,) [m] with the camera's axes as columns of `rotation` (3, 3)."""
        ...


class RgbdCamera:
    """Takes frames.

    Args:
        config: The camera.
        model: The compiled world.
        looks: What its geoms look like.
    """

    def __init__(self, config: RgbdConfig, model: MjModel, looks: Looks) -> None:
        self.config = config
        self._pinhole = config.pinhole
        self._caster: Caster = (
            RayCamera(self._pinhole, model, looks) if config.backend == "rays" else OpenGlCamera(self._pinhole, model)
        )

    def take(
        self, data: MjData, T_world_robot: Array, rng: np.random.Generator, time_s: float
    ) -> tuple[RgbdFrame, NDArray[np.int32]]:
        """Return the frame, and the geom (height, width) that each pixel really met, -1 for none."""
        config = self.config
        pitch, roll = config.vibration * rng.standard_normal(2)
        x, y, theta = T_world_robot
        cos, sin = np.cos(theta), np.sin(theta)
        ahead, left, turn = config.mount
        origin = np.array([x + cos * ahead - sin * left, y + sin * ahead + cos * left, config.camera_height])
        exact = self._caster.cast(data, origin, camera_axes(theta + turn, config.pitch + pitch, config.roll + roll))
        depth = measure_depth(exact.depth, exact.incidence, config, rng)
        tilt = (config.pitch, config.roll)
        frame = RgbdFrame(depth, exact.colour, self._pinhole, time_s, config.mount, config.camera_height, tilt)
        return frame, exact.geom


def camera_axes(yaw: float, pitch: float, roll: float) -> Array:
    """Return (3, 3) the camera's axes as columns: turned by roll about x, pitch about y, yaw about z, in this order."""
    cy, sy, cp, sp, cr, sr = *_cs(yaw), *_cs(pitch), *_cs(roll)
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    return about_z @ about_y @ about_x


def _cs(angle: float) -> tuple[float, float]:
    return float(np.cos(angle)), float(np.sin(angle))
