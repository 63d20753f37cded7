"""One camera frame, understood: points in space, each with the lambda of what was recognised there."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...slam.bounds import check_numbers
from ...slam.errors import InputError
from ...slam.immobile.grid import UNKNOWN, moving_lambda, still_lambda
from ..rgbd.clusters import ObjectClusters, find_clusters
from ..rgbd.frame import RgbdFrame
from ..rgbd.mount import Mount
from ..rgbd.people import NoPeopleFinder, RgbdPeople, RgbdPeopleFinder
from ..rgbd.planes import PlaneFinder, Planes, Surface

Array = NDArray[np.float64]

_MOSTLY = 0.5


@dataclass(frozen=True, kw_only=True)
class ViewConfig:
    """Parameters of `CameraViewMaker`.

    Attributes:
        top: Likelihood that a horizontal plane is a thing that stays, such as a desk, in [0, 1].
        face: The same of an upright plane that is no wall: a box, a door, now and then a back.
        graze: A ray to a thing frees nothing lower than this above the point that it meets [m].
    """

    top: float = 1.0
    face: float = 0.5
    graze: float = 0.1

    def __post_init__(self) -> None:
        check_numbers(self)
        for name in ("top", "face"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise InputError(f"likelihood `{name}` must be in [0, 1], got {getattr(self, name)}")
        if not self.graze >= 0.0:
            raise InputError(f"`graze` must not be negative [m], got {self.graze}")


@dataclass(frozen=True, eq=False)
class CameraView:
    """What one frame says about the room.

    Attributes:
        time_s: Time of the exposure [s].
        T_robot_camera: Pose (x, y, theta) of the camera in the robot frame [m, m, rad].
        camera_height: Height of the camera above the floor [m].
        points: (n, 3) what was seen: camera frame turned level, heights above the floor [m].
        surface: (n,) `Surface` of each.
        lambdas: (n,) lambda of each; NaN for floor and ceiling, which stand in nobody's way.
        above: (n,) lowest height at which the ray to it frees anything [m].
        cluster: (n,) number of the object that each belongs to, -1 for none.
        person: (n,) row of `people` that each belongs to, -1 for none.
        people: Who was seen.
        planes: The frame's planes.
    """

    time_s: float
    T_robot_camera: tuple[float, float, float]
    camera_height: float
    points: Array
    surface: NDArray[np.int8]
    lambdas: Array
    above: Array
    cluster: NDArray[np.int32]
    person: NDArray[np.int32]
    people: RgbdPeople
    planes: Planes


class CameraViewMaker:
    """Turns frames into views.

    Args:
        people: Finds people.
        planes: Finds planes.
        config: Parameters.
    """

    def __init__(
        self,
        people: RgbdPeopleFinder | None = None,
        planes: PlaneFinder | None = None,
        config: ViewConfig | None = None,
    ) -> None:
        self._people, self._planes = people or NoPeopleFinder(), planes or PlaneFinder()
        self._config = config or ViewConfig()
        self._mount: Mount | None = None

    def make(self, frame: RgbdFrame) -> CameraView:
        """Return what `frame` says; the mount that the frames before it showed is remembered."""
        planes = self._planes.find(frame, self._mount)
        self._mount = planes.mount
        return make_view(frame, planes, self._people.find(frame, planes), self._config)


def make_view(frame: RgbdFrame, planes: Planes, people: RgbdPeople, config: ViewConfig | None = None) -> CameraView:
    """Return what `frame` says, its planes and people being known.

    Points that belong to no plane, no person and no object of some size are dropped: at edges the camera measures
    depths between two surfaces.
    """
    config = config or ViewConfig()
    objects = find_clusters(planes)
    alone = (planes.surface == Surface.OTHER) & (objects.label < 0) & (people.label < 0)
    chosen = (planes.surface != Surface.NOTHING) & ~alone & planes.mount.known  # else no height is
    people = _whole_objects(people, objects)
    lambdas = _lambdas(planes, people, config)
    thing = np.isin(planes.surface, (Surface.TOP, Surface.OTHER, Surface.FACE)) & (people.label < 0)
    above = np.where(thing, np.nan_to_num(planes.points[..., 2]) + config.graze, -np.inf)
    return CameraView(
        time_s=frame.time_s,
        T_robot_camera=frame.T_robot_camera,
        camera_height=planes.mount.height,
        points=_flattened(planes)[chosen],
        surface=planes.surface[chosen],
        lambdas=lambdas[chosen],
        above=above[chosen],
        cluster=objects.label[chosen],
        person=people.label[chosen],
        people=people,
        planes=planes,
    )


def _flattened(planes: Planes) -> Array:
    """Return (h, w, 3) the points, those of a plane moved onto it: the noise of one pixel is not the plane's."""
    inside = planes.region >= 0
    points, region = planes.points.copy(), planes.region[inside]
    normals = planes.normals[region]
    away = (points[inside] * normals).sum(axis=1) - planes.offsets[region]
    points[inside] -= away[:, None] * normals
    return points


def _whole_objects(people: RgbdPeople, objects: ObjectClusters) -> RgbdPeople:
    """Return the people with all of an object that is mostly one of them: nothing of its ragged edge is left over."""
    label = people.label.copy()
    both = (label >= 0) & (objects.label >= 0)
    if both.any():
        counts = np.zeros((len(objects), len(people)), dtype=np.int64)
        np.add.at(counts, (objects.label[both], label[both]), 1)
        for k in np.flatnonzero(counts.max(axis=1) > _MOSTLY * objects.count):
            label[(objects.label == k) & (label < 0)] = counts[k].argmax()
    return replace(people, label=label)


def _lambdas(planes: Planes, people: RgbdPeople, config: ViewConfig) -> Array:
    """Return (h, w) lambda of each pixel; NaN for floor and ceiling."""
    surface = planes.surface
    sure = np.append(planes.likelihood, 0.0)[planes.region]
    lambdas = np.full(surface.shape, UNKNOWN)
    lambdas[(surface == Surface.FLOOR) | (surface == Surface.CEILING)] = np.nan
    for kind, likelihood in ((Surface.WALL, 1.0), (Surface.TOP, config.top), (Surface.FACE, config.face)):
        mine = surface == kind
        lambdas[mine] = still_lambda(likelihood * sure[mine])
    somebody = people.label >= 0
    lambdas[somebody] = moving_lambda(people.likelihood)[people.label[somebody]]
    return lambdas
