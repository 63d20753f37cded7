"""The floor of a frame, from any mount: the plane that everything else stands on.

Each planar region whose normal some mount could turn upwards is a hypothesis; its plane is fitted anew to all points
near it. The floor is the one that most points lie on and hardly any below. Where a table top fills the picture, a floor
that is parallel, lower and large enough wins over it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .mount import Mount, MountConfig, mount_of
from .noise import DepthNoise, Depths

Array = NDArray[np.float64]

_SAMPLE = 1000  # points that hypotheses are judged by
_MOST = 8  # hypotheses, those of the largest regions first
_FITS = 3
_LEAST = 0.02  # share of the measured points that lie on a floor
_SURFACE = 0.5  # share of the points near a floor whose normals say so, too: else it is a plane through edges of things
_TOGETHER = 30.0  # so many neighbouring pixels are off by the same error: the fit knows less than its points are many
_BELOW = 0.25  # points below a floor, as a share of those on it: mirrors, noise, stairs
_LOOKED_M = 5.0  # points farther off tell nothing of what is below
_PARALLEL = float(np.cos(np.radians(8.0)))
_SAME_TILT = float(np.cos(np.radians(2.0)))
_LOWER_M = 0.1
_TURNED = float(np.cos(np.radians(35.0)))
_SLACK_M = 0.015
_FEWEST = 12


@dataclass(frozen=True, eq=False)
class _Hypothesis:
    up: Array
    height: float
    near: int
    on: int
    below: int


@dataclass(frozen=True, eq=False)
class Regions:
    """The planar regions of a frame.

    Attributes:
        points: (h, w, 3) camera frame [m], NaN where nothing was measured.
        normals: (h, w, 3) at the points, NaN where unknown.
        flatness: (h, w) of their surroundings, see `surface_normals`.
        region: (h, w) int32 number of each pixel's region, -1 for none.
        planes: (k, 4) their normals towards the camera and offsets, n p = d.
        count: (k,) pixels of each.
        mean: (k, 3) mean point of each.
    """

    points: Array
    normals: Array
    flatness: Array
    region: NDArray[np.int32]
    planes: Array
    count: NDArray[np.int64]
    mean: Array


def floor_tolerance(depth: Depths, noise: DepthNoise) -> Depths:
    """Return how far from the floor a point at `depth` (...,) [m] may lie and be of it [m].

    Three standard deviations of depth, as if the floor were seen head-on: cameras are off by more than their noise at
    the grazing angles at which floors are seen.
    """
    return _SLACK_M + 3.0 * noise.sigma(depth)


def find_floor(scene: Regions, prior: Mount, config: MountConfig, noise: DepthNoise, height_told: bool) -> Mount | None:
    """Return the mount by the floor in sight, None if there is none.

    Args:
        scene: The frame's points and planar regions.
        prior: What is known of the mount.
        config: What mounts there are.
        noise: Of the depths.
        height_told: Whether the prior's height is one that was told, or seen before.
    """
    points, normals = scene.points.reshape(-1, 3), scene.normals.reshape(-1, 3)
    measured = np.flatnonzero(np.isfinite(points[:, 0]))
    if not len(measured):
        return None
    chosen = measured[:: max(1, len(measured) // _SAMPLE)]
    reach = max(config.height_within, 3.0 * float(np.sqrt(prior.covariance[2, 2]))) if height_told else np.inf
    found = [
        hypothesis
        for hypothesis in _hypotheses(scene, points[chosen], normals[chosen], config, noise)
        if hypothesis.on >= max(_LEAST * len(chosen), _SURFACE * hypothesis.near)
        and hypothesis.below <= _BELOW * hypothesis.on
        and _possible(np.append(hypothesis.up, -hypothesis.height)[None], config, 1.0)[0]
        and abs(hypothesis.height - prior.height) <= reach
    ]
    if not found:
        return None
    best = max(found, key=lambda h: h.on)
    for other in sorted(found, key=lambda h: h.height):
        if other.up @ best.up > _PARALLEL and other.height > best.height + _LOWER_M:
            best = other
    return _measured(points[measured], normals[measured], best, noise, prior.time_s)


def _hypotheses(
    scene: Regions, points: Array, normals: Array, config: MountConfig, noise: DepthNoise
) -> list[_Hypothesis]:
    """Return the planes through `points` (n, 3) that the largest regions lead to, each once."""
    found: list[_Hypothesis] = []
    possible = np.flatnonzero(_possible(scene.planes, config, 1.5))
    for k in possible[np.argsort(-scene.count[possible], kind="stable")][:_MOST]:
        up, middle = scene.planes[k, :3], scene.mean[k]
        near = floor_tolerance(float(middle[0]), noise)
        if any(up @ old.up > _TURNED and abs(middle @ old.up + old.height) < near for old in found):
            continue
        hypothesis = _fitted(points, normals, up, -float(scene.planes[k, 3]), noise)
        if hypothesis is not None:
            found.append(hypothesis)
    return found


def with_ceiling(floor: Mount, scene: Regions, ceiling: int, noise: DepthNoise) -> Mount:
    """Return the mount with its tilt by floor and region `ceiling` together, if they are parallel; else `floor`."""
    inside = scene.region == ceiling
    fit = _fit(scene.points[inside], scene.normals[inside], scene.planes[ceiling, :3], -scene.planes[ceiling, 3], noise)
    if fit is None or -fit[0] @ floor.up < _SAME_TILT:
        return floor
    other = mount_of(-fit[0], floor.height, fit[2], floor.time_s)
    by_floor, by_ceiling = (np.linalg.inv(each.covariance[:2, :2]) for each in (floor, other))
    covariance = floor.covariance.copy()
    covariance[:2, :2] = np.linalg.inv(by_floor + by_ceiling)
    tilts = by_floor @ (floor.pitch, floor.roll) + by_ceiling @ (other.pitch, other.roll)
    pitch, roll = (covariance[:2, :2] @ tilts).tolist()
    turned = replace(floor, pitch=pitch, roll=roll, covariance=covariance)
    points, normals = scene.points.reshape(-1, 3), scene.normals.reshape(-1, 3)
    _, _, on = _near(points, normals, floor.up, floor.height, noise)
    return replace(turned, height=-float(points[on].mean(axis=0) @ turned.up))


def _possible(planes: Array, config: MountConfig, wider: float) -> NDArray[np.bool_]:
    """Return (k,) whether each plane can be the floor under some mount whose limits are `wider` by a factor."""
    pitch = -np.arcsin(np.clip(planes[:, 0], -1.0, 1.0))
    roll = np.arctan2(planes[:, 1], planes[:, 2])
    height = -planes[:, 3]
    slack = (wider - 1.0) * config.roll
    good = (pitch >= -config.nose_up - slack) & (pitch <= config.nose_down + slack)
    good &= np.abs(roll) <= config.roll + slack
    return good & (height >= config.lowest / wider) & (height <= config.highest * wider)


def _near(
    points: Array, normals: Array, up: Array, height: float, noise: DepthNoise
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return (n,) heights over a plane [m], the tolerated ones [m], and which points lie on it, by normals, too."""
    over, most = points @ up + height, floor_tolerance(points[:, 0], noise)
    return over, most, (np.abs(over) < most) & (normals @ up > _TURNED)


def _fitted(points: Array, normals: Array, up: Array, height: float, noise: DepthNoise) -> _Hypothesis | None:
    """Return a plane fitted anew to all `points` (n, 3) near it, with the numbers of those on and below it."""
    for _ in range(_FITS):
        fit = _fit(points, normals, up, height, noise)
        if fit is None:
            return None
        up, height, _ = fit
    over, most, on = _near(points, normals, up, height, noise)
    below = (points[:, 0] < _LOOKED_M) & (over < -2.0 * most)
    return _Hypothesis(up, height, int((np.abs(over) < most).sum()), int(on.sum()), int(below.sum()))


def _fit(
    points: Array, normals: Array, up: Array, height: float, noise: DepthNoise
) -> tuple[Array, float, Array] | None:
    """Return the plane by least squares through the `points` (n, 3) on a first one.

    None: fewer than a dozen are, or all of them lie on one line.

    With it comes the covariance (3, 3) of its slopes along the camera's axis and across, and of its height.

    Points weigh by their noise, and the less the farther they lie from the first plane: what lies on a floor pulls it
    up, and nothing lies below. They also weigh by how much of the floor they stand for, about the square of depth: what
    bends a floor is the calibration, whose error neighbours share, so that many pixels nearby are worth no more.
    """
    over, most, on = _near(points, normals, up, height, noise)
    if on.sum() < _FEWEST:
        return None
    of, over, most = points[on], over[on], most[on]
    along = np.array([1.0, 0.0, 0.0]) - up[0] * up
    along /= np.linalg.norm(along)
    across = np.cross(up, along)
    weight = (1.0 - (over / most) ** 2) * of[:, 0] / noise.sigma(of[:, 0])
    design = np.stack((of @ along, of @ across, np.ones(len(of))), axis=1) * weight[:, None]
    information = design.T @ design + 1e-9 * np.eye(3)
    if np.linalg.matrix_rank(information, hermitian=True) < 3:
        return None
    covariance = np.linalg.inv(information).astype(np.float64)
    slopes = covariance @ (design.T @ (over * weight))
    turned = up - slopes[0] * along - slopes[1] * across
    size = float(np.linalg.norm(turned))
    return turned / size, (height - float(slopes[2])) / size, _TOGETHER * covariance


def _measured(points: Array, normals: Array, best: _Hypothesis, noise: DepthNoise, time_s: float) -> Mount:
    """Return the mount by all points on the floor that was chosen."""
    up, height, covariance = best.up, best.height, np.eye(3)
    for _ in range(_FITS):
        fit = _fit(points, normals, up, height, noise)
        if fit is not None:
            up, height, covariance = fit
    return mount_of(up, height, covariance, time_s)
