"""The camera's picture by casting a ray through each pixel: exact depth, what was met, and its colour."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....perception.rgbd.frame import Pinhole
from ...appearance.looks import Looks, colours
from ...physics.groups import GROUP_ABOVE, GROUP_CEILING, GROUP_SEEN
from ...physics.mj import MjData, MjModel, mujoco

Array = NDArray[np.float64]

FARTHEST = 30.0
"""How far the rays look [m]."""


@dataclass(frozen=True, eq=False)
class Exact:
    """A picture without noise.

    Attributes:
        depth: (h, w) along the camera's axis [m]; `inf` where nothing is met.
        incidence: (h, w) angle between the ray and the surface's normal, in [0, pi / 2] [rad].
        geom: (h, w) the geom that was met, -1 for none.
        colour: (h, w, 3) uint8.
    """

    depth: Array
    incidence: Array
    geom: NDArray[np.int32]
    colour: NDArray[np.uint8]


class RayCamera:
    """Casts pictures of one world.

    Args:
        camera: Geometry of the camera.
        model: The compiled world.
        looks: What its geoms look like.
    """

    def __init__(self, camera: Pinhole, model: MjModel, looks: Looks) -> None:
        self._camera, self._model, self._looks = camera, model, looks
        self._rays = camera.rays.reshape(-1, 3)
        self._length = np.linalg.norm(self._rays, axis=1)
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[[GROUP_SEEN, GROUP_ABOVE, GROUP_CEILING]] = 1
        count = len(self._rays)
        self._depth, self._normal = np.empty(count), np.empty((count, 3))
        self._geom = np.empty(count, dtype=np.int32)

    def cast(self, data: MjData, origin: Array, rotation: Array) -> Exact:
        """Return the picture seen from `origin` (3,) [m] with the camera's axes as columns of `rotation` (3, 3)."""
        rays = self._rays @ rotation.T
        mujoco.mj_multiRay(
            self._model,
            data,
            origin,
            rays.reshape(-1),
            self._groups,
            True,
            -1,
            self._geom,
            self._depth,
            self._normal.reshape(-1),
            len(rays),
            FARTHEST,
        )
        met = self._depth >= 0.0
        depth = np.where(met, self._depth, np.inf)
        geom = np.where(met, self._geom, -1).astype(np.int32)
        facing = np.abs((self._normal * rays).sum(axis=1)) / self._length
        incidence = np.where(met, np.arccos(np.clip(facing, 0.0, 1.0)), 0.0)
        colour = np.zeros((len(rays), 3), dtype=np.uint8)
        points = origin + depth[met, None] * rays[met]
        colour[met] = self._shade(data, geom[met], points, self._normal[met], rotation[:, 0])
        shape = (self._camera.height, self._camera.width)
        return Exact(depth.reshape(shape), incidence.reshape(shape), geom.reshape(shape), colour.reshape(*shape, 3))

    def _shade(self, data: MjData, geom: NDArray[np.int32], points: Array, normal: Array, ahead: Array) -> Array:
        """Return (k, 3) colours, 0 to 255, of `points` (k, 3) as OpenGL's fixed lighting would show them."""
        model = self._model
        turned = data.geom_xmat[geom].reshape(-1, 3, 3)
        local = np.matmul((points - data.geom_xpos[geom])[:, None, :], turned)[:, 0]
        headlight = model.vis.headlight
        light = headlight.ambient + headlight.diffuse * np.maximum(-normal @ ahead, 0.0)[:, None]
        for direction, diffuse in zip(data.light_xdir, model.light_diffuse, strict=True):
            light = light + diffuse * np.maximum(-normal @ direction, 0.0)[:, None]
        return np.clip(colours(self._looks, geom, local) * light, 0.0, 1.0) * 255.0
