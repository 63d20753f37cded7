"""Mean, covariance and ellipse of the objects in a scan, and what the filter may use of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds import check_numbers
from ..errors import InputError
from ..scan import LaserScan
from .clustering import Clusterer
from .round_centres import round_centres

Array = NDArray[np.float64]

MOST_SIGHTINGS = 100
"""So many landmarks tell all that a scan can; the time to tell which is which grows with more than their square."""


@dataclass(frozen=True, eq=False)
class Objects:
    """The objects of one scan.

    Attributes:
        means: (m, 2) mean of each object's points, in their frame [m].
        covariances: (m, 2, 2) of its points [m^2]; zero for a single point.
        counts: (m,) how many points it has.
    """

    means: Array
    covariances: Array
    counts: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.means)


def describe_objects(points: Array, labels: NDArray[np.int64]) -> Objects:
    """Return mean and covariance of every cluster of `points` (n, 2); noise (label -1) is left out."""
    kept = labels >= 0
    inside, label = points[kept], labels[kept]
    counts = np.bincount(label)
    if not len(counts):
        return Objects(np.zeros((0, 2)), np.zeros((0, 2, 2)), np.zeros(0, dtype=np.int64))
    share = np.maximum(counts, 1)
    means = np.stack([np.bincount(label, inside[:, axis]) / share for axis in range(2)], axis=-1)
    apart = inside - means[label]
    xx, xy, yy = (np.bincount(label, apart[:, i] * apart[:, j]) / share for i, j in ((0, 0), (0, 1), (1, 1)))
    covariances = np.stack((np.stack((xx, xy), -1), np.stack((xy, yy), -1)), -2)
    real = counts > 0
    return Objects(means[real], covariances[real], counts[real])


@dataclass(frozen=True)
class Ellipse:
    """Where an object most probably is.

    Attributes:
        centre: (x, y) [m].
        semi_axes: (long, short) [m].
        angle: Direction of the long one [rad].
    """

    centre: tuple[float, float]
    semi_axes: tuple[float, float]
    angle: float

    @property
    def area(self) -> float:
        """Its area [m^2]."""
        return float(np.pi * self.semi_axes[0] * self.semi_axes[1])


def covariance_ellipse(mean: Array, covariance: Array, sigmas: float = 2.0) -> Ellipse:
    """Return the ellipse of `covariance` (2, 2): axes along its eigenvectors, `sigmas` standard deviations long.

    An object's drawn ellipse is that of its own covariance plus that of the robot's position (Urvina 2023, eq. 17).
    """
    values, vectors = np.linalg.eigh(covariance)
    short, long = (sigmas * np.sqrt(np.maximum(values, 0.0))).tolist()
    return Ellipse((float(mean[0]), float(mean[1])), (long, short), float(np.arctan2(vectors[1, 1], vectors[0, 1])))


@dataclass(frozen=True, kw_only=True)
class SightingConfig:
    """Which objects serve as landmarks, and how well they are measured.

    Attributes:
        radius: Radius of the round landmarks [m].
        widest: Objects that extend further than this from their mean are no landmarks [m].
        border: Objects nearer than this to the end of the range may be seen in part only [m].
        sigma_range: Standard deviation of one range [m].
        sigma_shape: Standard deviation of a centre, in all directions, because objects are not quite round or of other
            radii [m]; 0 for posts that are all alike.
    """

    radius: float = 0.1
    widest: float = 0.25
    border: float = 0.3
    sigma_range: float = 0.01
    sigma_shape: float = 0.0

    def __post_init__(self) -> None:
        check_numbers(self)
        for name, value in vars(self).items():
            if not value >= 0.0:
                raise InputError(f"`{name}` must not be negative, got {value}")
        if not self.sigma_range > 0.0:
            raise InputError(f"`sigma_range` must be positive [m], got {self.sigma_range}")


@dataclass(frozen=True, eq=False)
class LandmarkSightings:
    """Landmarks seen in one scan, from the robot.

    Attributes:
        z: (m, 2) range and bearing of their centres in the robot frame [m, rad].
        R: (m, 2, 2) covariances of `z`.
        objects: All objects of the scan, robot frame.
    """

    z: Array
    R: Array
    objects: Objects


def see_landmarks(scan: LaserScan, clusterer: Clusterer, config: SightingConfig) -> LandmarkSightings:
    """Return what a scan shows of landmarks, by `round_centres`.

    Left out are objects that are too wide, at the end of the range or of the field of view, or cut by something nearer;
    and of more than `MOST_SIGHTINGS` the farther ones.
    """
    labels = clusterer.fit_predict(scan.points)
    objects = describe_objects(scan.points_robot, labels)
    if not len(objects):
        return LandmarkSightings(np.zeros((0, 2)), np.zeros((0, 2, 2)), objects)
    usable = _whole(scan, labels, config) & (np.sqrt(np.trace(objects.covariances, axis1=1, axis2=2)) <= config.widest)
    if np.count_nonzero(usable) > MOST_SIGHTINGS:
        farness = np.where(usable, np.hypot(objects.means[:, 0], objects.means[:, 1]), np.inf)
        usable[np.argsort(farness, kind="stable")[MOST_SIGHTINGS:]] = False
    if not usable.any():
        return LandmarkSightings(np.zeros((0, 2)), np.zeros((0, 2, 2)), objects)
    beams = np.flatnonzero(scan.is_return)
    place = np.full(int(labels.max()) + 2, -1)
    place[np.unique(labels[labels >= 0])[usable]] = np.arange(int(usable.sum()))
    label = place[labels]
    kept = label >= 0
    spacing = float(np.median(np.diff(scan.bearings))) if len(scan) > 1 else np.pi
    polar, covariance = round_centres(
        scan.ranges[beams[kept]], scan.bearings[beams[kept]], label[kept], spacing, config.radius, config.sigma_range
    )
    z, R = _from_robot(polar, covariance, np.asarray(scan.T_robot_lidar), config.sigma_shape)
    return LandmarkSightings(z, R, objects)


def _from_robot(polar: Array, covariance: Array, T_robot_lidar: Array, sigma_shape: float) -> tuple[Array, Array]:
    """Return range and bearing (m, 2) from the robot and their covariance (m, 2, 2), given those from the laser."""
    D, angle = polar[:, 0], polar[:, 1] + T_robot_lidar[2]
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = T_robot_lidar[0] + D * cos, T_robot_lidar[1] + D * sin
    r = np.maximum(np.hypot(x, y), 1e-9)
    by_polar = np.stack((np.stack((cos, -D * sin), -1), np.stack((sin, D * cos), -1)), -2)
    by_place = np.stack((np.stack((x / r, y / r), -1), np.stack((-y / r**2, x / r**2), -1)), -2)
    place = by_polar @ covariance @ by_polar.transpose(0, 2, 1) + sigma_shape**2 * np.eye(2)
    R = by_place @ place @ by_place.transpose(0, 2, 1)
    return np.stack((r, np.arctan2(y, x)), axis=-1), 0.5 * (R + R.transpose(0, 2, 1))


def _whole(scan: LaserScan, labels: NDArray[np.int64], config: SightingConfig) -> NDArray[np.bool_]:
    """Return (m,) whether each object is seen whole."""
    beams = np.flatnonzero(scan.is_return)
    size = int(labels.max()) + 1
    first, last, far = np.full(size, len(scan)), np.full(size, -1), np.zeros(size)
    inside = labels >= 0
    np.minimum.at(first, labels[inside], beams[inside])
    np.maximum.at(last, labels[inside], beams[inside])
    np.maximum.at(far, labels[inside], scan.ranges[beams[inside]])
    present = last >= 0
    first, last, far = first[present], last[present], far[present]
    padded = np.concatenate(([0.0], np.where(np.isnan(scan.ranges), 0.0, scan.ranges), [0.0]))
    nearest_beside = np.minimum(padded[first], padded[last + 2])
    return (nearest_beside > far) & (far < scan.range_max - config.border)
