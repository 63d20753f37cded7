"""How the camera is held: pitch, roll and height above the floor, with what is known of them."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import Angle, Within, check_numbers
from ...slam.errors import InputError
from .frame import RgbdFrame

Array = NDArray[np.float64]

_SYSTEMATIC = np.array([np.radians(0.3), np.radians(0.3), 0.01])
"""What no fit within one frame can show [rad, rad, m]: intrinsics that are a percent off bend the floor by so much."""
_CREEP = np.array([np.radians(2.0), np.radians(2.0), 0.02])
"""How much a mount moves in a second [rad, rad, m], as a random walk: what a robot nods where it brakes."""
_LONGEST_S = 10.0
_UNKNOWN = np.array([np.radians(20.0), np.radians(10.0), 0.5])
_KNOWN = np.array([np.radians(5.0), np.radians(5.0), 0.15])


@dataclass(frozen=True, kw_only=True)
class MountConfig:
    """What mounts there are.

    Attributes:
        lowest: Least height of a camera whose height is not told [m].
        highest: Greatest [m].
        nose_up: Largest pitch upwards [rad].
        nose_down: Largest pitch downwards [rad].
        roll: Largest roll to either side [rad].
        height_within: A height that is told is right within this [m]. Larger for one that is only rough.
        tilt_within: A tilt that is told is right within this [rad], as a standard deviation.
    """

    lowest: Annotated[float, Within(0.01, 100.0)] = 0.1
    highest: Annotated[float, Within(0.01, 100.0)] = 2.0
    nose_up: Angle = float(np.radians(10.0))
    nose_down: Angle = float(np.radians(60.0))
    roll: Angle = float(np.radians(22.5))
    height_within: Annotated[float, Within(0.001, 100.0)] = 0.15
    tilt_within: Angle = float(np.radians(2.0))

    def __post_init__(self) -> None:
        check_numbers(self)
        if not self.lowest < self.highest:
            raise InputError(f"`lowest` must be less than `highest` [m], got {self.lowest} and {self.highest}")


@dataclass(frozen=True, eq=False)
class Mount:
    """What is known of the camera's mount at one time.

    Attributes:
        pitch: Nose down positive [rad].
        roll: Left side up positive [rad].
        height: Of the camera above the floor [m].
        covariance: (3, 3) of pitch, roll and height.
        time_s: Of the frame [s].
        floor_seen: Whether this frame's floor told all three.
        ceiling_seen: Whether this frame's ceiling told pitch and roll, no floor being seen.
    """

    pitch: float
    roll: float
    height: float
    covariance: Array
    time_s: float
    floor_seen: bool = False
    ceiling_seen: bool = False

    @property
    def known(self) -> bool:
        """Whether it is good enough to tell heights of things by: 5 degrees and 0.15 m, as standard deviations."""
        return bool((np.sqrt(np.diag(self.covariance)) <= _KNOWN).all())

    @property
    def up(self) -> Array:
        """(3,) the vertical, camera frame."""
        sp, cp, sr, cr = np.sin(self.pitch), np.cos(self.pitch), np.sin(self.roll), np.cos(self.roll)
        return np.array([-sp, cp * sr, cp * cr])

    @property
    def R_level_camera(self) -> Array:
        """(3, 3) the smallest turn that brings the vertical to the z axis."""
        up = self.up
        axis, cosine = np.array([up[1], -up[0]]), float(up[2])
        sine = float(np.hypot(*axis))
        if sine < 1e-12:
            return np.eye(3)
        x, y = axis / sine
        cross = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])
        return np.eye(3) + sine * cross + (1.0 - cosine) * cross @ cross

    def at(self, time_s: float) -> "Mount":
        """Return what is known of it at a later time [s], if nothing has been seen since."""
        seconds = max(time_s - self.time_s, 0.0)
        covariance = self.covariance + seconds * np.diag(_CREEP**2)
        return replace(self, covariance=covariance, time_s=time_s, floor_seen=False, ceiling_seen=False)


def believed(frame: RgbdFrame, config: MountConfig, before: Mount | None) -> Mount:
    """Return what is known of the mount before `frame` is looked at: by the frame before, or by what was told.

    What was seen fades; what was told does not, and is believed again once it is the better of the two.
    """
    told = _told(frame, config)
    if before is None or not 0.0 <= frame.time_s - before.time_s <= _LONGEST_S:
        return told
    seen = before.at(frame.time_s)
    doubt = np.diag(seen.covariance) / np.diag(told.covariance)
    return seen if doubt.max() <= 1.0 or (seen.known and not told.known) else told


def _told(frame: RgbdFrame, config: MountConfig) -> Mount:
    height, pitch, roll, sd = 0.5 * (config.lowest + config.highest), 0.0, 0.0, _UNKNOWN.copy()
    if frame.camera_height is not None:
        height, sd[2] = frame.camera_height, 0.5 * config.height_within
    if frame.tilt is not None:
        (pitch, roll), sd[:2] = frame.tilt, config.tilt_within
    return Mount(pitch, roll, height, np.diag(sd**2), frame.time_s)


def mount_of(up: Array, height: float, covariance: Array, time_s: float) -> Mount:
    """Return the mount by a floor with normal `up` (3,), camera frame, `height` [m] below, fitted with `covariance`."""
    pitch, roll = float(-np.arcsin(np.clip(up[0], -1.0, 1.0))), float(np.arctan2(up[1], up[2]))
    return Mount(pitch, roll, height, covariance + np.diag(_SYSTEMATIC**2), time_s, floor_seen=True)


def by_ceiling(up: Array, prior: Mount) -> Mount:
    """Return the mount with its tilt by a ceiling with normal -`up` (3,), camera frame, and the prior's height."""
    tilt = mount_of(up, prior.height, np.zeros((3, 3)), prior.time_s)
    covariance = tilt.covariance.copy()
    covariance[2, 2] = prior.covariance[2, 2]
    return replace(tilt, covariance=covariance, floor_seen=False, ceiling_seen=True)
