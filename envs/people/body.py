"""The body of one person: sizes drawn per person, and its parts in MuJoCo."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..physics.groups import GROUP_ABOVE, GROUP_HIDDEN, GROUP_SEEN
from ..physics.mj import MjsBody, MjSpec, mujoco

PARTS = ("torso", "head", "left thigh", "left shin", "right thigh", "right shin")
"""Mocap bodies of a person, in this order."""
HIP_HALF_WIDTH = 0.085
"""Half of the distance between the hips [m]."""
WIDEST = 0.25
"""Largest radius of a body [m]."""
ANKLE = 0.08
"""Height of the ankle of a standing foot [m]."""
SHIN_SHAPE = (1.04, 0.96)
"""Half axes of the shin's ellipsoid, forward and sideways, over the leg's radius."""
SHIN_LENGTH = 0.72
"""Its half axis along the shin, over the shin's length."""


@dataclass(frozen=True, kw_only=True)
class Physique:
    """Sizes of one person.

    Attributes:
        thigh: Length from hip to knee [m].
        shin: Length from knee to ankle [m].
        leg_radius: Largest radius of the calf, with trousers [m].
        radius: Radius of the body, which keeps others off [m].
        stance_half_width: Half of the distance between the tracks of the two feet [m].
        walk_ratio: Step length over cadence [m s] (Sekiya and Nagasaki 1998: about 0.4 m s, at any speed).
        colour: Red, green, blue of the torso.
    """

    thigh: float
    shin: float
    leg_radius: float
    radius: float
    stance_half_width: float
    walk_ratio: float
    colour: tuple[float, float, float]


def draw_physique(rng: np.random.Generator) -> Physique:
    """Return the sizes of a person of 1.55 to 1.95 m."""
    stature = rng.uniform(1.55, 1.95)
    leg_radius = rng.uniform(0.045, 0.075)
    red, green, blue = (float(value) for value in rng.uniform(0.2, 0.9, 3))
    return Physique(
        thigh=0.245 * stature,
        shin=0.246 * stature,
        leg_radius=leg_radius,
        radius=rng.uniform(0.21, WIDEST),
        stance_half_width=leg_radius + rng.uniform(0.025, 0.06),
        walk_ratio=rng.uniform(0.36, 0.43),
        colour=(red, green, blue),
    )


def add_person(spec: MjSpec, index: int, physique: Physique) -> None:
    """Add a person to `spec`: mocap bodies "person I PART", each with its geoms.

    Shins are ellipsoids that taper to the ankle; only they can cut the laser's plane. A hidden upright cylinder meets
    the robot in contacts and no ray.
    """
    bodies = {
        part: spec.worldbody.add_body(name=f"person {index} {part}", mocap=True, pos=[0.0, 0.0, -10.0])
        for part in PARTS
    }
    skin, trousers = (0.85, 0.66, 0.53), tuple(0.4 * value for value in physique.colour)
    ellipsoid, capsule = mujoco.mjtGeom.mjGEOM_ELLIPSOID, mujoco.mjtGeom.mjGEOM_CAPSULE
    _add(bodies["torso"], capsule, (0.13, 0.2, 0.0), (0.0, 0.0, 0.3), physique.colour)
    _add(bodies["head"], ellipsoid, (0.095, 0.075, 0.12), (0.0, 0.0, 0.0), skin)
    for side in ("left", "right"):
        radius = physique.leg_radius
        _add(
            bodies[f"{side} thigh"],
            ellipsoid,
            (1.25 * radius, 1.2 * radius, 0.56 * physique.thigh),
            (0.0, 0.0, 0.0),
            trousers,
        )
        shin = bodies[f"{side} shin"]
        _add(shin, ellipsoid, shin_half_axes(physique), (0.0, 0.0, 0.0), trousers, seen=True)
        below = -physique.shin / 2.0
        _add(shin, mujoco.mjtGeom.mjGEOM_BOX, (0.12, 0.045, 0.03), (0.06, 0.0, below - 0.045), (0.1, 0.1, 0.1))
    bodies["torso"].add_geom(
        name=f"person {index} contact",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=[physique.radius, 1.0, 0.0],
        rgba=[0.0, 0.0, 0.0, 0.0],
        contype=0,
        conaffinity=1,
        friction=[0.3, 0.005, 0.0001],
        group=GROUP_HIDDEN,
    )


def shin_half_axes(physique: Physique) -> tuple[float, float, float]:
    """Return the half axes of the shin's ellipsoid [m]: forward, sideways, along."""
    forward, sideways = SHIN_SHAPE
    return (forward * physique.leg_radius, sideways * physique.leg_radius, SHIN_LENGTH * physique.shin)


def _add(
    body: MjsBody,
    shape: Any,
    size: tuple[float, float, float],
    at: tuple[float, float, float],
    colour: tuple[float, ...],
    *,
    seen: bool = False,
) -> None:
    body.add_geom(
        type=shape,
        size=list(size),
        pos=list(at),
        rgba=[*colour, 1.0],
        contype=0,
        conaffinity=0,
        group=GROUP_SEEN if seen else GROUP_ABOVE,
    )
