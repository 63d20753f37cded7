"""Mean, covariance and ellipse of the objects in a scan, and what the filter may use of them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..scan import LaserScan
from .clustering import Clusterer

Array = NDArray[np.float64]


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
        radius: Radius of the round landmarks [m]; the mean of their visible points lies pi / 4 of it before the centre.
        widest: Objects that extend further than this from their mean are no landmarks [m].
        border: Objects nearer than this to the end of the range may be seen in part only [m].
        sigma_range: Standard deviation of one range [m].
        shape_share: Standard deviation of a measured centre through the shape, as a share of `radius`.
        alike: Factor of all variances: views from neighbouring places err alike, so that each tells less than it would
            alone. Chosen so that the filter of simulated drives is consistent.
    """

    radius: float = 0.1
    widest: float = 0.25
    border: float = 0.3
    sigma_range: float = 0.01
    shape_share: float = 0.08
    alike: float = 1.35

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not value >= 0.0:
                raise InputError(f"`{name}` must not be negative, got {value}")
        if not self.sigma_range > 0.0:
            raise InputError(f"`sigma_range` must be positive [m], got {self.sigma_range}")


@dataclass(frozen=True, eq=False)
class Sightings:
    """Landmarks seen in one scan, from the robot.

    Attributes:
        z: (m, 2) range and bearing of their centres in the robot frame [m, rad].
        R: (m, 2, 2) covariances of `z`.
        objects: All objects of the scan, robot frame.
    """

    z: Array
    R: Array
    objects: Objects


def see_landmarks(scan: LaserScan, clusterer: Clusterer, config: SightingConfig) -> Sightings:
    """Return what a scan shows of landmarks.

    Left out are objects that are too wide, at the end of the range or of the field of view, or cut by something nearer.
    Each side of an object is known to the spacing of the beams, so its middle has the variance spacing^2 / 24, whatever
    the number of beams. A single beam that hits something round hits its middle.
    """
    labels = clusterer.fit_predict(scan.points)
    objects = describe_objects(scan.points_robot, labels)
    if not len(objects):
        return Sightings(np.zeros((0, 2)), np.zeros((0, 2, 2)), objects)
    usable = _whole(scan, labels, config) & (np.sqrt(np.trace(objects.covariances, axis1=1, axis2=2)) <= config.widest)
    mount = np.asarray(scan.T_robot_lidar)
    apart = objects.means[usable] - mount[:2]
    distance = np.maximum(np.hypot(apart[:, 0], apart[:, 1]), 1e-9)
    behind = config.radius * np.where(objects.counts[usable] == 1, 1.0, 0.25 * np.pi)
    centres = mount[:2] + apart * (1.0 + behind / distance)[:, None]
    spacing = float(np.median(np.diff(scan.bearings))) if len(scan) > 1 else np.pi
    R = np.zeros((len(centres), 2, 2))
    R[:, 0, 0] = config.sigma_range**2 / objects.counts[usable] + (config.shape_share * config.radius) ** 2
    R[:, 1, 1] = spacing**2 / 24.0 + (config.shape_share * config.radius / distance) ** 2
    R *= config.alike
    z = np.stack((np.hypot(centres[:, 0], centres[:, 1]), np.arctan2(centres[:, 1], centres[:, 0])), axis=-1)
    return Sightings(z, R, objects)


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
    padded = np.concatenate(([0.0], np.nan_to_num(scan.ranges, nan=0.0, posinf=np.inf), [0.0]))
    nearest_beside = np.minimum(padded[first], padded[last + 2])
    return (nearest_beside > far) & (far < scan.range_max - config.border)
