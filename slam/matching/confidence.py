"""How sure a matcher may be of a pose: agreement of the points and the covariance, blind directions included."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from .nearest import nearest_point
from .surfaces import Surfaces


@dataclass(frozen=True, kw_only=True)
class ConfidenceConfig:
    """What it takes for a pose to be believed.

    Attributes:
        near: A point within this distance of the reference's surface agrees with it [m].
        least_points: Fewest agreeing points of a pose that is believed.
        least_share: Least share of agreeing points, of those that fall where the reference could see.
        noise: Least standard deviation of a point from a line [m].
        blind_sigma: Standard deviation of what nothing is known about [m, rad].
    """

    near: float = 0.1
    least_points: int = 10
    least_share: float = 0.4
    noise: float = 0.01
    blind_sigma: float = 3.0

    def __post_init__(self) -> None:
        if not min(self.near, self.least_points, self.noise, self.blind_sigma) > 0.0:
            raise InputError(f"all fields of ConfidenceConfig must be positive, got {self}")


@dataclass(frozen=True, eq=False)
class Confidence:
    """Agreement of a scan with a reference at a pose.

    Attributes:
        score: Share of the new scan's points that lie on the reference's surface.
        agreeing: How many do.
        covariance: (3, 3) of the pose.
        believed: Whether enough points agree.
    """

    score: float
    agreeing: int
    covariance: NDArray[np.float64]
    believed: bool


def assess(
    points: NDArray[np.float64], pose: NDArray[np.float64], reference: Surfaces, config: ConfidenceConfig
) -> Confidence:
    """Return how well `points` (N, 2) of the new scan agree with the reference at `pose` (3,).

    The information is that of point-to-line residuals, whatever the matcher minimised, less what the noise of the
    normals feigns: along a corridor a normal that is off by a feigns sin^2(a) of knowledge.
    """
    information, agreeing, squares = line_information(
        points, pose, reference.points, reference.rays, reference.feet, reference.normals,
        reference.tilt_variance, reference.first, config.near, config.noise,
    )  # fmt: skip
    variance = max(squares / max(agreeing - 3, 1), config.noise**2)
    prior = np.eye(3) / config.blind_sigma**2
    values, vectors = np.linalg.eigh(information / variance)
    posterior = (vectors * np.maximum(values, 0.0)) @ vectors.T + prior
    covariance = np.linalg.inv(posterior)
    score = agreeing / max(len(points), 1)
    believed = agreeing >= config.least_points and score >= config.least_share
    return Confidence(score, int(agreeing), 0.5 * (covariance + covariance.T), believed)


@numba.njit(cache=True, nogil=True)
def line_information(
    points, pose, reference, rays, feet, normals, tilt_variance, first, near, noise
):  # pragma: no cover
    """Return (H (3, 3) for a unit noise, agreeing points, sum of their squared distances from the lines)."""
    information = np.zeros((3, 3))
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    agreeing, squares = 0, 0.0
    for n in range(len(points)):
        rx, ry = cos * points[n, 0] - sin * points[n, 1], sin * points[n, 0] + cos * points[n, 1]
        x, y = rx + pose[0], ry + pose[1]
        # Along the surface the next point may be far: the distance that counts is that from the line.
        j, _ = nearest_point(x, y, 1.0, reference, rays, first, 9.0 * near * near)
        if j < 0:
            continue
        nx, ny = normals[j, 0], normals[j, 1]
        error = nx * (feet[j, 0] - x) + ny * (feet[j, 1] - y)
        if nx == 0.0 and ny == 0.0:
            error = np.sqrt((reference[j, 0] - x) ** 2 + (reference[j, 1] - y) ** 2)
        if abs(error) > near:
            continue
        agreeing += 1
        squares += error * error
        feigned = min(tilt_variance[j] * noise * noise, 1.0)
        across, along = ny * rx - nx * ry, nx * rx + ny * ry
        for sign in range(2):
            ax, ay, at, w = nx, ny, across, 1.0
            if sign == 1:
                ax, ay, at, w = -ny, nx, along, -feigned
            information[0, 0] += w * ax * ax
            information[0, 1] += w * ax * ay
            information[1, 1] += w * ay * ay
            information[0, 2] += w * ax * at
            information[1, 2] += w * ay * at
            information[2, 2] += w * at * at
    information[1, 0], information[2, 0], information[2, 1] = information[0, 1], information[0, 2], information[1, 2]
    return information, agreeing, squares
