"""Hinged doors: closed until somebody on foot comes near."""

import numpy as np
from numpy.typing import NDArray

from ..physics.groups import GROUP_SEEN
from ..physics.mj import MjSpec, mujoco
from ..scenes.scene import Door

Array = NDArray[np.float64]

THICKNESS = 0.05
"""Thickness of a leaf [m]."""
SPEED = 1.3
"""How fast a leaf turns [rad/s]."""
GAP = 0.01
"""Between a leaf and its frame, and the floor [m]."""


def add_door(spec: MjSpec, index: int, door: Door) -> None:
    """Add the leaf of a door to `spec`, as mocap body "door I" whose origin is the hinge and whose x runs along it."""
    body = spec.worldbody.add_body(name=f"door {index}", mocap=True, pos=[*door.hinge, 0.0])
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[door.width / 2.0 - GAP, THICKNESS / 2.0, (door.top - GAP) / 2.0],
        pos=[door.width / 2.0, 0.0, (door.top + GAP) / 2.0],
        rgba=[0.55, 0.35, 0.2, 1.0],
        contype=0,
        conaffinity=1,
        friction=[0.3, 0.005, 0.0001],
        group=GROUP_SEEN,
    )


class Doors:
    """Opens the doors of a building.

    Args:
        doors: The doors.

    Attributes:
        angle: (d,) how far each is open, from 0 to 1.
    """

    def __init__(self, doors: tuple[Door, ...]) -> None:
        self._doors = doors
        self.angle = np.zeros(len(doors))

    def advance(self, dt: float, people: Array) -> None:
        """Turn the leaves for `dt` seconds; `people` (n, 2) are where people are [m]."""
        for index, door in enumerate(self._doors):
            near = len(people) > 0 and np.hypot(*(people - door.middle).T).min() < door.opens_at
            if near or self.angle[index] > 0.0:
                self.angle[index] = min(1.0, self.angle[index] + SPEED * dt / abs(door.swing))

    def pose(self, quaternions: Array) -> None:
        """Write the turn of each leaf into its row of MuJoCo's `quaternions` (d, 4)."""
        for index, door in enumerate(self._doors):
            half = (door.yaw + self.angle[index] * door.swing) / 2.0
            quaternions[index] = (np.cos(half), 0.0, 0.0, np.sin(half))
