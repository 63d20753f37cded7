"""People on chairs: where the chairs stand, and how a seated body is posed."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...envs.people.body import ANKLE, HIP_HALF_WIDTH, PARTS, Physique
from ...envs.physics.mj import MjData
from ...envs.scenes.scene import Scene
from ...envs.scenes.solids import Solid
from .rgbd_props import REACH_M, before

Array = NDArray[np.float64]

_SEAT = 0.21
_ABOVE_SEAT = 0.09  # of the hips' axis
_NECK = 0.75  # of the head's middle above the hips


def draw_chairs(
    rng: Generator, scene: Scene, spots: Array, share: float, reach: float = REACH_M
) -> tuple[list[Solid], dict[int, Array]]:
    """Return chairs before a `share` of the robot's `spots` (k, 3), up to `reach` away [m], and spot -> (x, y, heading)
    of who sits there.
    """
    solids: list[Solid] = []
    seats: dict[int, Array] = {}
    for number, spot in enumerate(spots):
        if rng.random() >= share:
            continue
        place = before(rng, scene, spot, 0.3, reach)
        if place is None:
            continue
        heading = float(rng.uniform(-np.pi, np.pi))
        seats[number] = np.array([*place, heading])
        seat, back = float(rng.uniform(0.38, 0.5)), float(rng.uniform(0.75, 1.0))
        solids += _chair(float(place[0]), float(place[1]), heading, seat, back)
    return solids, seats


def _chair(x: float, y: float, heading: float, seat: float, back: float) -> list[Solid]:
    behind = np.array([x, y]) - 0.2 * np.array([np.cos(heading), np.sin(heading)])
    flat = Solid(kind="prop", x=x, y=y, yaw=heading, half_length=_SEAT, half_width=_SEAT, bottom=seat - 0.05, top=seat)
    upright = Solid(
        kind="prop",
        x=float(behind[0]),
        y=float(behind[1]),
        yaw=heading,
        half_length=0.02,
        half_width=0.2,
        bottom=seat,
        top=back,
    )
    return [flat, upright]


def seat_person(data: MjData, person: int, seat: Array, physique: Physique) -> None:
    """Pose a body on a chair at `seat` (x, y, heading): thighs level, shins upright, the trunk as when it stands."""
    x, y, heading = seat
    ahead, left = np.array([np.cos(heading), np.sin(heading)]), np.array([-np.sin(heading), np.cos(heading)])
    knee = ANKLE + physique.shin
    hips = knee + _ABOVE_SEAT / 2.0
    turned = np.array([np.cos(heading / 2.0), 0.0, 0.0, np.sin(heading / 2.0)])
    # a turn of 90 degrees about the body's y axis brings the thigh's z axis to the heading
    half = np.sqrt(0.5)
    forward = half * np.array([turned[0], -turned[3], turned[0], turned[3]])
    first = person * len(PARTS)
    parts = [((x, y), hips, turned), ((x, y), hips + _NECK, turned)]
    for side in (HIP_HALF_WIDTH, -HIP_HALF_WIDTH):
        hip = np.array([x, y]) + side * left
        parts.append((tuple(hip + 0.5 * physique.thigh * ahead), hips, forward))
        parts.append((tuple(hip + physique.thigh * ahead), ANKLE + physique.shin / 2.0, turned))
    for number, (place, height, quaternion) in enumerate(parts):
        data.mocap_pos[first + number] = (*place, height)
        data.mocap_quat[first + number] = quaternion
