"""Who is really in a frame, and how much of each."""

import numpy as np
from numpy.typing import NDArray

from ...envs.people.body import PARTS
from ...envs.physics.groups import GROUP_ABOVE, GROUP_SEEN
from ...envs.physics.mj import MjData, MjModel, mujoco
from ...envs.sensors.camera.config import RgbdConfig
from ...envs.sensors.camera.rays import FARTHEST
from ...envs.sensors.camera.rgbd import camera_axes

Array = NDArray[np.float64]
_HIDDEN = 5
_STEP = 2


def people_of(model: MjModel, geoms: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return, for geoms (...,), -1 for none, the person that each belongs to, -1 for none; doors count as nobody."""
    return _person_of_geom(model)[geoms] if geoms.size else geoms


class WholeBodies:
    """Counts how many pixels people would have if nothing stood before them.

    Args:
        config: The camera.
        model: The compiled world.
        people: How many people there are.
    """

    def __init__(self, config: RgbdConfig, model: MjModel, people: int) -> None:
        self._config, self._model, self._people = config, model, people
        self._rays = config.pinhole.rays[::_STEP, ::_STEP].reshape(-1, 3)
        self._person = _person_of_geom(model)[:-1]
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[[GROUP_SEEN, GROUP_ABOVE]] = 1

    def count(self, data: MjData, T_world_robot: Array) -> NDArray[np.int64]:
        """Return (people,) numbers of pixels, from every other pixel along rows and columns."""
        x, y, theta = T_world_robot
        ahead, left, turn = self._config.mount
        cos, sin = np.cos(theta), np.sin(theta)
        origin = np.array([x + cos * ahead - sin * left, y + sin * ahead + cos * left, self._config.camera_height])
        yaw = theta + turn
        turned = camera_axes(yaw, self._config.pitch, self._config.roll)
        groups = self._model.geom_group.copy()
        counts = np.zeros(self._people, dtype=np.int64)
        for person in range(self._people):
            offset = data.mocap_pos[person * len(PARTS)][:2] - origin[:2]
            away, across = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]]) @ offset
            if 0.0 < away < 9.0 and abs(across) < away + 0.5:
                self._model.geom_group[:] = np.where(self._person == person, groups, _HIDDEN)
                counts[person] = _STEP * _STEP * self._met(data, origin, turned)
        self._model.geom_group[:] = groups
        return counts

    def _met(self, data: MjData, origin: Array, rotation: Array) -> int:
        rays = self._rays @ rotation.T
        geom, depth = np.empty(len(rays), dtype=np.int32), np.empty(len(rays))
        flat = rays.reshape(-1)
        mujoco.mj_multiRay(
            self._model, data, origin, flat, self._groups, True, -1, geom, depth, None, len(rays), FARTHEST
        )
        return int((geom >= 0).sum())


def _person_of_geom(model: MjModel) -> NDArray[np.int32]:
    """Return (geoms + 1,) the person that each geom belongs to, -1 for none; the last entry stands for no geom."""
    names = [model.body(int(body)).name.split() for body in model.geom_bodyid]
    return np.array([int(name[1]) if name and name[0] == "person" else -1 for name in names] + [-1], dtype=np.int32)
