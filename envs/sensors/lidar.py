"""A planar laser scanner like the Hokuyo UTM-30LX, by MuJoCo's rays or a faster kernel of the same bytes."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import FARTHEST_MOUNT_M, LEAST_SPACING, LONGEST_RANGE_M, Share, Within, check_numbers
from ...slam.errors import InputError
from ...slam.scan import LaserScan
from ..limits.field_checks import Beams, Opening, Rate
from ..physics.groups import GROUP_SEEN
from ..physics.mj import MjData, MjModel, mujoco
from .ray_kernel import BOX, CYLINDER, ELLIPSOID, add_noise, cast_beams

Array = NDArray[np.float64]
LaserRange = Annotated[float, Within(0.0, LONGEST_RANGE_M)]
"""Range of a laser [m]."""
_Mount = Annotated[tuple[float, float, float], Within(-FARTHEST_MOUNT_M, FARTHEST_MOUNT_M)]


@dataclass(frozen=True, kw_only=True)
class LidarConfig:
    """The scanner. Defaults follow the Hokuyo UTM-30LX data sheet, at 10 Hz instead of its 40.

    Noise is its "repeated accuracy" (sigma 10 mm up to 10 m, 30 mm beyond); its "accuracy" (30 and 50 mm) is a bound
    that includes surface and temperature. A sweep is taken at one instant.

    Attributes:
        beams: Number of beams of a sweep.
        field_of_view: Angle between the first and the last beam [rad].
        rate_hz: Sweeps per second [Hz].
        range_min: Shortest range [m].
        range_max: Longest range [m]; nothing within it gives `inf`.
        sigma_near: Standard deviation of ranges up to `near` [m].
        sigma_far: Standard deviation of ranges beyond `near` [m].
        near: Where the noise changes [m].
        dropout: Probability that a beam fails and gives NaN.
        mount: Pose (x, y, theta) of the laser in the robot frame [m, m, rad].
        height: Height of its plane above the floor [m].
    """

    beams: Beams = 1081
    field_of_view: Opening = float(np.radians(270.0))
    rate_hz: Rate = 10.0
    range_min: LaserRange = 0.1
    range_max: LaserRange = 30.0
    sigma_near: LaserRange = 0.01
    sigma_far: LaserRange = 0.03
    near: LaserRange = 10.0
    dropout: Share = 0.002
    mount: _Mount = (0.1, 0.0, 0.0)
    height: float = 0.2

    def __post_init__(self) -> None:
        check_numbers(self)
        if self.field_of_view < LEAST_SPACING * (self.beams - 1):
            rule = f"at least {LEAST_SPACING:g} rad a beam"
            raise InputError(f"`field_of_view` must be {rule}, got {self.field_of_view} for {self.beams} beams")
        if not 0.0 <= self.range_min < self.range_max:
            raise InputError(f"need 0 <= `range_min` < `range_max` [m], got {self.range_min} and {self.range_max}")
        if not 0.0 <= self.dropout < 1.0:
            raise InputError(f"`dropout` must be in [0, 1), got {self.dropout}")
        if not 0.11 < self.height < 0.4:
            raise InputError(f"`height` of the lidar must be in (0.11, 0.4) [m]: over the chassis, got {self.height}")

    @cached_property
    def bearings(self) -> Array:
        """(beams,) directions in the laser frame [rad], ascending."""
        return np.linspace(-self.field_of_view / 2.0, self.field_of_view / 2.0, self.beams)


class Lidar:
    """Casts the beams of one sweep.

    Args:
        config: The scanner.
        model: The compiled world.
        labels: (geoms,) what each geom is to `scan_labels`: -1 static, else the index of a person.
    """

    def __init__(self, config: LidarConfig, model: MjModel, labels: NDArray[np.int32]) -> None:
        self.config = config
        self._model = model
        self._labels = np.append(labels, np.int32(-1))
        self._groups = np.zeros(6, dtype=np.uint8)
        self._groups[GROUP_SEEN] = 1
        self._directions = np.zeros((config.beams, 3))
        self._distance = np.empty(config.beams)
        self._geom = np.empty(config.beams, dtype=np.int32)
        seen = (model.geom_group == GROUP_SEEN) & ((model.geom_rgba[:, 3] > 0.0) | (model.geom_matid >= 0))
        self._seen = np.flatnonzero(seen).astype(np.int32)
        self._plain = bool(np.isin(model.geom_type[self._seen], (BOX, CYLINDER, ELLIPSOID)).all())
        self._shapes, self._sizes = model.geom_type.copy(), model.geom_size.copy()
        bearings = config.bearings + config.mount[2]
        self._cos, self._sin = np.cos(bearings), np.sin(bearings)

    def cast(self, data: MjData, T_world_robot: Array) -> tuple[Array, NDArray[np.int32]]:
        """Return the exact ranges (beams,) [m], `inf` where nothing is met, and the label (beams,) of what was met."""
        x, y, theta = T_world_robot
        cos, sin = np.cos(theta), np.sin(theta)
        mount = self.config.mount
        origin = np.array(
            [x + cos * mount[0] - sin * mount[1], y + sin * mount[0] + cos * mount[1], self.config.height]
        )
        np.subtract(cos * self._cos, sin * self._sin, out=self._directions[:, 0])
        np.add(sin * self._cos, cos * self._sin, out=self._directions[:, 1])
        if self._plain:
            self._cast_plain(data, origin, theta)
        else:
            self._cast_any(data, origin)
        missed = (self._distance < 0.0) | (self._distance > self.config.range_max)
        return np.where(missed, np.inf, self._distance), self._labels[np.where(missed, -1, self._geom)]

    def _cast_plain(self, data: MjData, origin: Array, heading: float) -> None:
        bearings = self.config.bearings
        cast_beams(
            origin,
            heading + self.config.mount[2],
            bearings[0],
            bearings[1] - bearings[0],
            self._directions,
            self._seen,
            self._shapes,
            self._sizes,
            data.geom_xpos,
            data.geom_xmat,
            self._distance,
            self._geom,
        )

    def _cast_any(self, data: MjData, origin: Array) -> None:
        """Cast by MuJoCo, which knows every shape: the slower reference of `_cast_plain`."""
        mujoco.mj_multiRay(
            self._model,
            data,
            origin,
            self._directions.reshape(-1),
            self._groups,
            True,
            -1,
            self._geom,
            self._distance,
            None,
            self.config.beams,
            self.config.range_max,
        )

    def measure(self, exact: Array, rng: np.random.Generator, time_s: float) -> LaserScan:
        """Return the sweep that a real scanner makes of the `exact` ranges (beams,)."""
        config = self.config
        noise, chance = rng.standard_normal(config.beams), rng.random(config.beams)
        sigmas = config.near, config.sigma_near, config.sigma_far
        ranges = np.empty(config.beams)
        add_noise(exact, noise, chance, *sigmas, config.range_max, config.dropout, ranges)
        return LaserScan(
            ranges,
            config.bearings,
            config.range_min,
            config.range_max,
            time_s,
            config.mount,
        )
