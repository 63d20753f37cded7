"""How sure a matcher may be of a pose: agreement of the points and the covariance, blind directions included."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..view_kernel import kernel
from .nearest import nearest_point
from .surfaces import SurfaceConfig, Surfaces

LONG_LINES = SurfaceConfig(neighbours=10, tolerance=0.06, even=True)


@dataclass(frozen=True, kw_only=True)
class ConfidenceConfig:
    """What it takes for a pose to be believed.

    Attributes:
        near: A point within this distance of the reference's surface agrees with it [m].
        least_points: Fewest agreeing points of a pose that is believed.
        least_share: Least share of agreeing points, of those that fall where the reference could see.
        noise: Least standard deviation of a point from a line [m].
        blind_sigma: Standard deviation of what nothing is known about [m, rad].
        caution: How many times the knowledge that noisy normals feign is taken off.
        surfaces: Lines of the reference that serve here, longer than those that the matchers use; which points are of
            one surface is the matcher's.
    """

    near: float = 0.1
    least_points: int = 10
    least_share: float = 0.4
    noise: float = 0.01
    blind_sigma: float = 3.0
    caution: float = 3.0
    surfaces: SurfaceConfig = LONG_LINES

    def __post_init__(self) -> None:
        check_numbers(self)
        if not min(self.near, self.least_points, self.noise, self.blind_sigma, self.caution) > 0.0:
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

    Args:
        points: Of the new scan, in its frame [m].
        pose: T_reference_new.
        reference: Its surfaces, with long lines (`ConfidenceConfig.surfaces`).
        config: What it takes.
    """
    index, errors = meet(
        points, pose, reference.points, reference.rays, reference.feet, reference.normals, reference.first, config.near
    )
    agreeing = int((index >= 0).sum())
    variance = max(float(errors @ errors) / max(agreeing - 3, 1), config.noise**2)
    information = line_information(
        points, pose, index, reference.normals, config.caution * variance * reference.tilt_variance
    )
    values, vectors = np.linalg.eigh(information / variance)
    posterior = (vectors * np.maximum(values, 0.0)) @ vectors.T + np.eye(3) / config.blind_sigma**2
    covariance = np.linalg.inv(posterior)
    score = agreeing / max(len(points), 1)
    believed = agreeing >= config.least_points and score >= config.least_share
    return Confidence(score, agreeing, 0.5 * (covariance + covariance.T), believed)


@kernel
def meet(points, pose, reference, rays, feet, normals, first, near):  # pragma: no cover
    """Return for each of `points` (N, 2) the reference point whose line it lies on (-1: none) and its distance [m]."""
    index, errors = np.full(len(points), -1, dtype=np.int32), np.zeros(len(points))
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    beside = -1
    for n in range(len(points)):
        x = cos * points[n, 0] - sin * points[n, 1] + pose[0]
        y = sin * points[n, 0] + cos * points[n, 1] + pose[1]
        # Along the surface the next point may be far: the distance that counts is that from the line.
        j, square = nearest_point(x, y, 1.0, reference, rays, first, 9.0 * near * near, beside)
        beside = min(j + 1, len(reference) - 1) if j >= 0 else -1
        if j < 0:
            continue
        error = normals[j, 0] * (feet[j, 0] - x) + normals[j, 1] * (feet[j, 1] - y)
        if normals[j, 0] == 0.0 and normals[j, 1] == 0.0:
            error = np.sqrt(square)
        if abs(error) <= near:
            index[n], errors[n] = j, error
    return index, errors


@kernel
def line_information(points, pose, index, normals, feigned):  # pragma: no cover
    """Return (3, 3) information of points on lines for a noise of 1 m, less `feigned` (M,) [rad^2] along each line."""
    information = np.zeros((3, 3))
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    row = np.empty(3)
    for n in range(len(points)):
        j = index[n]
        # A normal that may be off by 18 degrees says nothing.
        if j < 0 or not feigned[j] < 0.1:
            continue
        rx, ry = cos * points[n, 0] - sin * points[n, 1], sin * points[n, 0] + cos * points[n, 1]
        nx, ny = normals[j, 0], normals[j, 1]
        for sign in range(2):
            weight = 1.0
            row[0], row[1], row[2] = nx, ny, ny * rx - nx * ry
            if sign == 1:
                weight = -feigned[j]
                row[0], row[1], row[2] = -ny, nx, nx * rx + ny * ry
            for a in range(3):
                for b in range(3):
                    information[a, b] += weight * row[a] * row[b]
    return information
