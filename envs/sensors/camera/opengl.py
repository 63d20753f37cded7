"""The same picture by MuJoCo's renderer, where OpenGL is present."""

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....perception.rgbd.frame import Pinhole
from ....slam.errors import InputError
from ...physics.groups import GROUP_ABOVE, GROUP_CEILING, GROUP_SEEN
from ...physics.mj import MjData, MjModel, mujoco
from .rays import Exact

Array = NDArray[np.float64]


class OpenGlCamera:
    """Renders pictures of one world. Patterns of clothing and furniture are not in it, only their first colours.

    Args:
        camera: Geometry of the camera.
        model: The compiled world.

    Raises:
        InputError: If there is no OpenGL.
    """

    def __init__(self, camera: Pinhole, model: MjModel) -> None:
        self._camera, self._model = camera, model
        self._renderer: Any = open_renderer(model, camera.height, camera.width)
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 0
        self._option.geomgroup[[GROUP_SEEN, GROUP_ABOVE, GROUP_CEILING]] = 1

    def cast(self, data: MjData, origin: Array, rotation: Array) -> Exact:
        """Return the picture seen from `origin` (3,) [m] with the camera's axes as columns of `rotation` (3, 3)."""
        renderer = self._renderer
        renderer.update_scene(data, scene_option=self._option)
        self._place(origin, rotation)
        colour = renderer.render().copy()
        renderer.enable_depth_rendering()
        depth = renderer.render().astype(np.float64)
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        segments = renderer.render()
        renderer.disable_segmentation_rendering()
        geom = np.where(segments[..., 1] == int(mujoco.mjtObj.mjOBJ_GEOM), segments[..., 0], -1).astype(np.int32)
        depth = np.where(geom >= 0, depth, np.inf)
        return Exact(depth, self._incidence(depth), geom, colour)

    def close(self) -> None:
        """Free the OpenGL context."""
        self._renderer.close()

    def _place(self, origin: Array, rotation: Array) -> None:
        across, up = np.tan(self._camera.horizontal_fov / 2.0), np.tan(self._camera.vertical_fov / 2.0)
        scene = self._renderer.scene
        for eye in scene.camera:
            eye.pos[:], eye.forward[:], eye.up[:] = origin, rotation[:, 0], rotation[:, 2]
            eye.frustum_center = 0.0
            eye.frustum_width = eye.frustum_near * across
            eye.frustum_top, eye.frustum_bottom = eye.frustum_near * up, -eye.frustum_near * up
        for light in scene.lights[: scene.nlight]:
            if light.headlight:
                light.pos[:], light.dir[:] = origin, rotation[:, 0]

    def _incidence(self, depth: Array) -> Array:
        """Return (h, w) the angle between the ray and the surface, from the depth of neighbouring pixels [rad]."""
        rays = self._camera.rays
        points = rays * np.where(np.isfinite(depth), depth, 0.0)[..., None]
        normal = np.cross(np.gradient(points, axis=1), np.gradient(points, axis=0))
        size = np.linalg.norm(normal, axis=-1) * np.linalg.norm(rays, axis=-1)
        facing = np.abs((normal * rays).sum(axis=-1)) / np.maximum(size, 1e-12)
        return np.arccos(np.clip(facing, 0.0, 1.0))


def open_renderer(model: MjModel, height: int, width: int, instead: str = 'the camera back end "rays"') -> Any:
    """Return MuJoCo's renderer of pictures of `height` x `width` pixels.

    Args:
        model: What is drawn.
        height: Of the pictures.
        width: Of the pictures.
        instead: What needs no OpenGL, for the error.

    Raises:
        InputError: If there is no OpenGL, or the pictures are larger than the model's off-screen buffer.
    """
    most = model.vis.global_
    if width > most.offwidth or height > most.offheight:
        raise InputError(f"OpenGL draws at most {most.offwidth} x {most.offheight} pixels, got {width} x {height}")
    try:
        return mujoco.Renderer(model, height, width)
    except _missing() as error:
        raise InputError(
            f"OpenGL is not present ({error}); on a machine without a display, set MUJOCO_GL=egl before Python starts; "
            f"{instead} needs nothing of this"
        ) from error


def _missing() -> tuple[type[Exception], ...]:
    """Return what MuJoCo raises where there is no context, binding, device or display, or where a call to OpenGL fails.

    PyOpenGL's own errors are among them only where MuJoCo has loaded it: to load it is to choose one of its platforms.
    """
    loaded = sys.modules.get("OpenGL.error")
    return (mujoco.FatalError, ImportError, RuntimeError, *((loaded.Error,) if loaded else ()))
