"""Compiles a scene, the robot and the people into one MuJoCo model."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..appearance.outfit import add_outfit
from ..appearance.wardrobe import Outfit
from ..people.body import PARTS, Physique, add_person
from ..physics.groups import GROUP_ABOVE, GROUP_CEILING, GROUP_HIDDEN, GROUP_SEEN
from ..physics.mj import MjModel, MjSpec, mujoco
from ..robot.robot import RobotConfig, add_robot
from ..scenes.scene import Scene
from ..scenes.solids import Solid
from ..sensors.lidar import LidarConfig
from .doors import add_door

ARENA_BYTES = 1 << 20
"""Room for contacts and their equations [bytes]; the most that an episode was seen to use is 18 kB. MuJoCo's own choice
is 13 MB: freed and made again with each episode, they left the heap of a long run in pieces."""

_COLOURS = {
    "wall": (0.82, 0.82, 0.8),
    "pillar": (0.7, 0.7, 0.7),
    "door": (0.55, 0.35, 0.2),
    "platform": (0.6, 0.55, 0.5),
    "table": (0.7, 0.5, 0.3),
    "cabinet": (0.5, 0.45, 0.4),
    "chair": (0.25, 0.28, 0.33),
    "screen": (0.35, 0.45, 0.6),
    "carton": (0.66, 0.52, 0.34),
}


@dataclass(frozen=True, eq=False)
class Building:
    """A compiled world.

    Attributes:
        model: MuJoCo's model; the robot owns qpos[:3], people own the mocap bodies in order, doors those behind them.
        labels: (geoms,) index of the person whose leg a geom is, -1 for everything else.
        contact_of: (geoms,) index of the person whose body a geom is in contacts, -1 for everything else.
    """

    model: MjModel
    labels: NDArray[np.int32]
    contact_of: NDArray[np.int32]


def build(
    scene: Scene,
    physiques: tuple[Physique, ...],
    robot: RobotConfig,
    lidar: LidarConfig,
    timestep: float,
    outfits: tuple[Outfit, ...] = (),
) -> Building:
    """Return the model of `scene` with the robot and people at the origin; `timestep` of the physics in seconds.

    `outfits` are worn by the first people, one each; without, bodies are bare of what only a camera would see.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = timestep
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.gravity = [0.0, 0.0, 0.0]
    spec.memory = ARENA_BYTES
    spec.visual.global_.offwidth, spec.visual.global_.offheight = 1280, 960
    _add_light_and_floor(spec, scene)
    _add_ceiling(spec, scene)
    for solid in scene.solids:
        _add_solid(spec, solid, lidar.height)
    add_robot(spec, robot, lidar.height, lidar.mount[:2])
    for index, physique in enumerate(physiques):
        add_person(spec, index, physique)
    for index, outfit in enumerate(outfits):
        add_outfit(spec, index, outfit)
    for index, door in enumerate(scene.doors):
        add_door(spec, index, door)
    model = spec.compile()
    labels = np.full(model.ngeom, -1, dtype=np.int32)
    contact_of = np.full(model.ngeom, -1, dtype=np.int32)
    for geom in range(model.ngeom):
        mocap = int(model.body_mocapid[model.geom_bodyid[geom]])
        if 0 <= mocap < len(PARTS) * len(physiques):
            hidden = model.geom_group[geom] == GROUP_HIDDEN
            (contact_of if hidden else labels)[geom] = mocap // len(PARTS)
    return Building(model, labels, contact_of)


def _add_light_and_floor(spec: MjSpec, scene: Scene) -> None:
    x0, y0, x1, y1 = scene.bounds
    middle = [(x0 + x1) / 2.0, (y0 + y1) / 2.0]
    spec.worldbody.add_light(
        pos=[*middle, 20.0], dir=[0, 0, -1], type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, diffuse=[0.7] * 3
    )
    spec.visual.headlight.ambient = [0.4, 0.4, 0.4]
    spec.worldbody.add_geom(
        name="floor",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[(x1 - x0) / 2.0, (y1 - y0) / 2.0, 1.0],
        pos=[*middle, 0.0],
        rgba=[0.45, 0.48, 0.5, 1.0],
        contype=0,
        conaffinity=0,
        group=GROUP_ABOVE,
    )
    spec.worldbody.add_camera(
        name="top", pos=[*middle, 1.3 * max(x1 - x0, y1 - y0)], fovy=45.0, quat=[1.0, 0.0, 0.0, 0.0]
    )


def _add_ceiling(spec: MjSpec, scene: Scene) -> None:
    if scene.ceiling is None:
        return
    x0, y0, x1, y1 = scene.bounds
    spec.worldbody.add_geom(
        name="ceiling",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[(x1 - x0) / 2.0, (y1 - y0) / 2.0, 0.05],
        pos=[(x0 + x1) / 2.0, (y0 + y1) / 2.0, scene.ceiling + 0.05],
        rgba=[0.85, 0.85, 0.83, 1.0],
        contype=0,
        conaffinity=0,
        group=GROUP_CEILING,
    )


def _add_solid(spec: MjSpec, solid: Solid, laser_height: float) -> None:
    half_height = (solid.top - solid.bottom) / 2.0
    size = [solid.radius, half_height, 0.0] if solid.is_round else [solid.half_length, solid.half_width, half_height]
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CYLINDER if solid.is_round else mujoco.mjtGeom.mjGEOM_BOX,
        size=size,
        pos=[solid.x, solid.y, (solid.top + solid.bottom) / 2.0],
        quat=[np.cos(solid.yaw / 2.0), 0.0, 0.0, np.sin(solid.yaw / 2.0)],
        rgba=[*_COLOURS.get(solid.kind, (0.35, 0.4, 0.55)), 1.0],
        contype=0,
        conaffinity=1 if solid.bottom < 0.3 else 0,
        friction=[0.3, 0.005, 0.0001],
        group=GROUP_SEEN if solid.at_height(laser_height) else GROUP_ABOVE,
    )
