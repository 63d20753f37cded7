"""How far depths are off, by distance and kind of sensor."""

from dataclasses import dataclass
from typing import Annotated, TypeVar

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import Within, check_numbers
from ...slam.errors import unknown_name

_FAR_M = 2.0  # from here on the part that grows with depth is the larger one
_ENOUGH = 200
_FLATTEST = 0.25  # of the points: the others lie on things that are not flat
_LEAST = 1e-4
Depths = TypeVar("Depths", float, NDArray[np.float64])


@dataclass(frozen=True, kw_only=True)
class DepthNoise:
    """Standard deviation of depth z: `constant + quadratic z^2` [m].

    Attributes:
        constant: What is left at the shortest depths [m].
        quadratic: Growth with the square of depth [1/m]: a disparity's error is the same at any depth.
    """

    constant: Annotated[float, Within(0.0, 1.0)] = 0.002
    quadratic: Annotated[float, Within(0.0, 1.0)] = 0.0014

    def __post_init__(self) -> None:
        check_numbers(self)

    def sigma(self, depth: Depths) -> Depths:
        """Return the standard deviation [m] at `depth` [m]."""
        return self.constant + self.quadratic * depth * depth

    def depth_of(self, sigma: float) -> float:
        """Return the depth [m] from which on the standard deviation is larger than `sigma` [m]; infinity if never."""
        if sigma <= self.constant:
            return 0.0
        return float(np.sqrt((sigma - self.constant) / self.quadratic)) if self.quadratic else float("inf")


NOISE = {
    "structured-light": DepthNoise(),
    "time-of-flight": DepthNoise(constant=0.002, quadratic=0.0004),
    "stereo": DepthNoise(constant=0.002, quadratic=0.003),
}
"""Kinect V1 and Xtion (Khoshelham and Elberink 2012: 0.0014 z^2); Kinect V2 (Fankhauser et al. 2015: 1.5 mm at 1 m,
below 1 cm at 4 m); active stereo with a base of 5 cm (a tenth of a pixel of disparity at 640 columns)."""


def measured_noise(depth: NDArray[np.float32], flatness: NDArray[np.float64], usual: DepthNoise) -> DepthNoise:
    """Return the noise that a frame shows by itself: how uneven its flattest surfaces are.

    Of frames of Kinects it is 0.0011 to 0.0019 z^2, as in the literature; of a RealSense 0.003 to 0.007 z^2.

    Args:
        depth: (h, w) [m], NaN where nothing was measured.
        flatness: (h, w) root mean square of depth's relative error around a plane, see `surface_normals`.
        usual: What is returned where too little is far enough off to tell; and its constant part.
    """
    far = (depth > _FAR_M) & np.isfinite(flatness)
    if np.count_nonzero(far) < _ENOUGH:
        return usual
    quadratic = float(np.quantile(flatness[far] / depth[far], _FLATTEST))
    return DepthNoise(constant=usual.constant, quadratic=min(max(quadratic, _LEAST), 1.0))


def depth_noise(name: str) -> DepthNoise:
    """Return the noise of a kind of sensor.

    Raises:
        InputError: If there is none of this name.
    """
    if name not in NOISE:
        raise unknown_name("depth sensor", name, tuple(NOISE))
    return NOISE[name]
