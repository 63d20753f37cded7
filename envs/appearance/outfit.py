"""The shapes that clothing, arms and hair add to a body, for cameras alone."""

from typing import Any

import numpy as np

from ..physics.groups import GROUP_ABOVE
from ..physics.mj import MjsBody, MjSpec, mujoco
from .wardrobe import ARMS, Outfit

SHOULDER = 0.53
"""Height of the shoulders above the hips [m]."""
_BOX, _BALL = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_ELLIPSOID
_ROUND = mujoco.mjtGeom.mjGEOM_CYLINDER

_EXTRAS: dict[str, tuple[tuple[str, str, Any, tuple[float, ...], tuple[float, ...]], ...]] = {
    "none": (),
    "backpack": (("torso", "extra", _BOX, (-0.2, 0.0, 0.38), (0.09, 0.14, 0.2)),),
    "bag": (("torso", "extra", _BOX, (0.0, -0.25, -0.08), (0.14, 0.05, 0.12)),),
    "hat": (
        ("head", "extra", _ROUND, (0.0, 0.0, 0.06), (0.16, 0.008, 0.0)),
        ("head", "extra", _ROUND, (0.0, 0.0, 0.11), (0.09, 0.05, 0.0)),
    ),
    "cap": (
        ("head", "extra", _BALL, (0.0, 0.0, 0.06), (0.105, 0.085, 0.075)),
        ("head", "extra", _BOX, (0.12, 0.0, 0.05), (0.05, 0.07, 0.008)),
    ),
    "bun": (("head", "hair", _BALL, (-0.08, 0.0, 0.1), (0.06, 0.06, 0.06)),),
    "long hair": (("head", "hair", _BALL, (-0.05, 0.0, -0.08), (0.07, 0.1, 0.17)),),
}
"""Extra -> (part, cloth, shape, centre, half sizes) of its shapes [m]."""
_GARMENTS: dict[str, tuple[tuple[str, tuple[float, ...], tuple[float, ...]], ...]] = {
    "trousers": (),
    "shorts": (),
    "skirt": (("trousers", (0.0, 0.0, -0.2), (0.18, 0.19, 0.3)),),
    "coat": (("shirt", (0.0, 0.0, -0.08), (0.16, 0.19, 0.42)),),
}
"""Garment -> (cloth, centre, half axes) of its shapes at the torso [m]."""


def add_outfit(spec: MjSpec, index: int, outfit: Outfit) -> None:
    """Give person `index` of `spec` shoulders, hips, neck, arms and clothing: geoms "person I CLOTH NUMBER".

    None of them is in the laser's plane, or touches anything.
    """
    bodies = {part: spec.body(f"person {index} {part}") for part in ("torso", "head")}
    shapes = [
        ("torso", "shirt", _BALL, (0.0, 0.0, 0.4), (outfit.depth, outfit.shoulders + 0.02, 0.22)),
        ("torso", "trousers", _BALL, (0.0, 0.0, -0.01), (0.9 * outfit.depth, 0.16, 0.14)),
        ("torso", "skin", _BALL, (0.0, 0.0, 0.64), (0.055, 0.055, 0.09)),
        *(("torso", cloth, _BALL, at, size) for cloth, at, size in _GARMENTS[outfit.garment]),
        *_EXTRAS[outfit.extra],
    ]
    if outfit.arms == "carries":
        shapes.append(("torso", "extra", _BOX, (0.36, 0.0, 0.26), (0.14, 0.19, 0.13)))
    for number, (part, cloth, shape, at, size) in enumerate(shapes):
        _add(bodies[part], f"person {index} {cloth} {number}", shape, pos=list(at), size=list(size))
    _add_arms(bodies["torso"], index, outfit)


def _add_arms(torso: MjsBody, index: int, outfit: Outfit) -> None:
    lower = "shirt" if outfit.long_sleeves else "skin"
    poses = ARMS[outfit.arms][::-1] if outfit.mirrored else ARMS[outfit.arms]
    for side, name, pose in ((1.0, "left", poses[0]), (-1.0, "right", poses[1])):
        outward = np.array([1.0, side, 1.0])
        shoulder = np.array([0.0, side * outfit.shoulders, SHOULDER])
        elbow, hand = shoulder + outward * pose[:3], shoulder + outward * pose[3:]
        capsule = mujoco.mjtGeom.mjGEOM_CAPSULE
        for cloth, radius, ends in (("shirt", 0.048, (shoulder, elbow)), (lower, 0.04, (elbow, hand))):
            radius = radius + (0.008 if cloth == "shirt" else 0.0)
            part = "upper" if ends[1] is elbow else "lower"
            _add(
                torso,
                f"person {index} {cloth} {name} {part}",
                capsule,
                fromto=np.concatenate(ends).tolist(),
                size=[radius, 0.0, 0.0],
            )
        _add(torso, f"person {index} skin {name} hand", _BALL, pos=hand.tolist(), size=[0.05, 0.045, 0.055])


def _add(body: MjsBody, name: str, shape: Any, **where: Any) -> None:
    body.add_geom(
        name=name, type=shape, contype=0, conaffinity=0, group=GROUP_ABOVE, rgba=[0.5, 0.5, 0.5, 1.0], **where
    )
