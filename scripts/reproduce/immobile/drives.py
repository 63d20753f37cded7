"""The cell that drives: one lab, one operator, several ways to map what the sensors saw."""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....envs.oracle import TrueRgbdPeopleFinder
from ....envs.recording.operator import Operator
from ....envs.robot.robot import ROBOTS
from ....envs.sensors.camera.config import RgbdConfig
from ....envs.sensors.lidar import LidarConfig
from ....envs.world.world import World, WorldConfig
from ....perception.immobile.localization import ImmobileLocalization
from ....perception.immobile.mapper import ImmobileMapper
from ....perception.immobile.slam import beams_on_people
from ....perception.immobile.view import CameraView, make_view
from ....perception.people_filter import PeopleFilter, PeopleFilterConfig
from ....perception.rgbd.frame import RgbdFrame
from ....perception.rgbd.people import RgbdPeopleFinder
from ....perception.rgbd.people_finder import PeopleFinder
from ....perception.rgbd.planes import PlaneFinder, Planes
from ....perception.rgbd.reduction import middle_pixels
from ....slam.engine import ENGINES, make_slam
from ....slam.errors import unknown_name
from ....slam.geometry import between, compose, inverse, transform_points
from ....slam.grid import GridConfig, OccupancyGrid
from ....slam.scan import LaserScan
from ..following.map_files import save_map
from . import measures
from .exhibits import Exhibits
from .measures import LASER_HEIGHT, DoorWatch, SeenTops

Array = NDArray[np.float64]

LASER = LidarConfig(range_max=10.0, height=LASER_HEIGHT)
"""The paper's laser: 10 m, 270 degrees, 0.25 degrees, 0.32 m above the floor."""
USUAL_ROBOT, PAPER_ROBOT, PAPER_PIXELS = "dingo-d", "pioneer", (512, 424)
"""The robot of the other experiments; that of the paper, and the pixels of its Kinect V2."""
MAPPERS = ("conventional", "laser", "immobile", "true people")
"""Ways to map: the occupancy grid; immobile area by the laser alone; by laser and camera; and the same with people told
by the simulator, an upper bound."""
METHOD = "immobile"
"""The way that stands for the paper's method."""
POSES = ("gmapping", "cartographer", "immobile", "truth")
"""Who localises: an engine, the immobile map itself, or the simulator."""
_LONGEST_S = 420.0
_SCANS_IN_2_S = round(2.0 * LASER.rate_hz)


def lab_drive(
    seed: int,
    poses: str,
    camera_hz: float,
    delay_s: float,
    vibration_deg: float,
    pitch_deg: float,
    missing: float,
    wrong: float,
    longest_s: float | None,
    ways: Sequence[str],
    files: Path,
    paper: bool = False,
) -> dict[str, Any]:
    """Drive once through the lab of `seed` and map it in several ways; return what is counted on the maps.

    Args:
        seed: Of building, people and noise.
        poses: Who says where the robot is, one of `POSES`.
        camera_hz: Frames a second [Hz].
        delay_s: Views are ready this long after their exposure [s].
        vibration_deg: Standard deviation of the camera's pitch and roll [degrees].
        pitch_deg: How far the camera's nose points down [degrees].
        missing: Share of the pixels that measure nothing, besides the usual ones.
        wrong: Share of the recognised things whose likelihood l is taken for 1 - l.
        longest_s: Where the drive is cut off [s]; None: at its end.
        ways: Those of `MAPPERS` to map in, the conventional one and `METHOD` among them.
        files: Folder for the maps.
        paper: Whether robot and camera are those of the paper: a Pioneer 3-DX, 512 x 424 pixels.
    """
    if poses not in POSES:
        raise unknown_name("source of poses", poses, POSES)
    vibration, pitch = np.radians((vibration_deg, pitch_deg)).tolist()
    camera = RgbdConfig(rate_hz=camera_hz, vibration=vibration, pitch=pitch, missing=max(missing, 0.002))
    camera = replace(camera, width=PAPER_PIXELS[0], height=PAPER_PIXELS[1]) if paper else camera
    drive = _Drive(lab_world(seed, camera, PAPER_ROBOT if paper else USUAL_ROBOT), poses, delay_s, wrong, seed, ways)
    operator = Operator(drive.world.scene)
    while not operator.done(drive.world.truth) and drive.world.time_s < (longest_s or _LONGEST_S):
        drive.world.step(operator.command(drive.world.truth))
        drive.take()
    drive.write(files)
    return drive.judged()


def lab_world(seed: int, camera: RgbdConfig | None = None, robot: str = USUAL_ROBOT) -> World:
    """Return the lab of `seed`, with the paper's laser, this camera and the robot of this name."""
    config = WorldConfig(
        scene="lab", route="operator", people=0, leader=False, lidar=LASER, camera=camera, robot=ROBOTS[robot]
    )
    return World(config, np.random.default_rng(seed))


class _Drive:
    """Everything that goes on during a drive."""

    def __init__(self, world: World, poses: str, delay_s: float, wrong: float, seed: int, ways: Sequence[str]) -> None:
        self.world = world
        self._engine = make_slam(poses, seed=seed) if poses in ENGINES else None
        self._by_map = ImmobileLocalization() if poses == "immobile" else None
        self._delay_s, self._wrong, self._rng = delay_s, wrong, np.random.default_rng([seed, 7])
        self._people_filter = PeopleFilter(PeopleFilterConfig(forest="simulation"))
        self._planes = PlaneFinder()
        finders: dict[str, RgbdPeopleFinder] = {METHOD: PeopleFinder.load(), "true people": TrueRgbdPeopleFinder(world)}
        self._finders = {name: finder for name, finder in finders.items() if name in ways}
        self.conventional = OccupancyGrid(GridConfig(max_range=LASER.range_max))
        self.mappers = {name: ImmobileMapper() for name in MAPPERS[1:] if name in ways}
        self._waiting: deque[tuple[float, dict[str, CameraView]]] = deque()
        self._last_frame: RgbdFrame | None = None
        kinds = ("floor", "ceiling", *(solid.kind for solid in world.scene.solids))
        self._kinds = np.array([*kinds, *["mover"] * (world.model.ngeom - len(kinds))])
        self.T_world_map = world.start.copy()
        resolution = self.conventional.config.resolution
        self.tops = SeenTops(world.scene, self.T_world_map, resolution)
        self.doors = {
            name: DoorWatch(world.scene, inverse(self.T_world_map), resolution) for name in ("conventional", METHOD)
        }
        self.exhibits = Exhibits(resolution)
        self._closed = True
        self._walked: list[Array] = []
        self._errors: list[Array] = []
        self._path: list[Array] = []
        self.take()

    def take(self) -> None:
        """Take the latest scan, and the latest frame if it is new."""
        scan, odometry = self.world.scan(), self.world.odometry
        true_pose = between(self.T_world_map, self.world.truth.robot_pose)
        filtered = self._people_filter.update(scan, odometry)
        people = beams_on_people(filtered, self._people_filter.config.removal.zeta)
        pose = self._located(odometry, scan, people, true_pose)
        self._errors.append(between(true_pose, pose))
        self._path.append(pose)
        self._walked.append(self.world.truth.people.positions.copy())
        self.conventional.write(pose, scan)
        for mapper in self.mappers.values():
            mapper.add_scan(pose, scan, people)
        if self.world.frames and self.world.frames[-1] is not self._last_frame:
            self._last_frame = self.world.frames[-1]
            self._look(self._last_frame, scan, true_pose)
        while self._waiting and self._waiting[0][0] <= scan.time_s + 1e-9:
            for name, view in self._waiting.popleft()[1].items():
                self.mappers[name].add_view(view)
        self._watch_door(pose, scan)

    def _located(self, odometry: Array, scan: LaserScan, people: Array, true_pose: Array) -> Array:
        """Return the pose by whom the drive was told to ask."""
        if self._by_map is not None:
            return self._by_map.locate(self.mappers[METHOD].grid, odometry, scan, people)
        return true_pose if self._engine is None else self._engine.update(odometry, scan).pose

    def _look(self, frame: RgbdFrame, scan: LaserScan, true_pose: Array) -> None:
        planes = self._spoiled_planes(self._planes.find(frame))
        views = {}
        for name, finder in self._finders.items():
            people = finder.find(frame, planes)
            views[name] = make_view(frame, planes, replace(people, likelihood=self._spoiled(people.likelihood)))
        self._waiting.append((frame.time_s + self._delay_s, views))
        geoms = middle_pixels(self.world.frame_geoms(), planes.step, planes.frame.depth.shape)
        truly = int((self.world.people_of(geoms) >= 0).sum())
        self.exhibits.add_frame(planes.frame, views[METHOD], scan, self._path[-1], truly)
        self.exhibits.add_view(views[METHOD], self._path[-1])
        kinds = self._kinds[geoms]
        T_map_camera = compose(true_pose, frame.T_robot_camera)
        level = np.isfinite(planes.frame.depth)
        for kind, lowest in measures.TOPS.items():
            mine = level & (kinds == kind) & (np.nan_to_num(planes.points[..., 2]) > lowest)
            self.tops.add(kind, transform_points(T_map_camera, planes.points[mine][:, :2]))

    def _spoiled_planes(self, planes: Planes) -> Planes:
        return replace(planes, likelihood=self._spoiled(planes.likelihood))

    def _spoiled(self, likelihood: Array) -> Array:
        wrong = self._rng.random(len(likelihood)) < self._wrong
        return np.where(wrong, 1.0 - likelihood, likelihood)

    def _watch_door(self, pose: Array, scan: LaserScan) -> None:
        angle = self.world.doors_open[0]
        if angle == 0.0:
            return
        for name, watch in self.doors.items():
            grid = self.conventional if name == "conventional" else self.mappers[name].grid
            if self._closed:
                watch.closed(grid.to_map())
            elif angle == 1.0:
                watch.opened(pose, scan, grid.to_map())
        self._closed = False

    def write(self, files: Path) -> None:
        """Write the maps and the path into `files`."""
        save_map(files / "conventional.npz", self.conventional.to_map(), np.array(self._path))
        for name, mapper in self.mappers.items():
            for layer, grid in measures.layered(mapper.grid).items():
                save_map(files / f"{name.replace(' ', '_')}_{layer}.npz", grid)

        self.exhibits.write(files / "exhibits.npz")

    def judged(self) -> dict[str, Any]:
        """Return the numbers, by mapper."""
        scene, T, resolution = self.world.scene, self.T_world_map, self.conventional.config.resolution
        maps = {"conventional": self.conventional.to_map()}
        maps |= {name: mapper.grid.to_map() for name, mapper in self.mappers.items()}
        walked = np.unique(np.round(np.concatenate(self._walked), 1), axis=0)
        static = measures.static_cells(maps["conventional"], T, scene)
        error = np.array(self._errors)
        return {
            "time_s": self.world.time_s,
            "pose_error_m": float(np.sqrt((error[:, :2] ** 2).sum(axis=1).mean())),
            "static_cells": len(static),
            "hidden_cells": {m: measures.cells_in(scene.marks[m], T, resolution) for m in measures.HIDDEN},
            "maps": {
                name: {
                    "people_cells": measures.people_cells(grid, T, scene, walked),
                    "table": self.tops.share("table", grid),
                    "chair": self.tops.share("chair", grid),
                    "known": {m: measures.known_cells(grid, T, scene.marks[m]) for m in measures.HIDDEN},
                    "wrongly_free": {m: measures.wrongly_free(grid, T, scene, scene.marks[m]) for m in measures.HIDDEN},
                    "static_lost": measures.lost_cells(grid, static, reach=0),
                    "static_lost_near": measures.lost_cells(grid, static, reach=1),
                }
                for name, grid in maps.items()
            },
            "door": {
                name: _delays(watch.delays(), watch.looks()) | {"at_the_end": watch.still(maps[name])}
                for name, watch in self.doors.items()
            },
        }


def _delays(delays: Array, looks: NDArray[np.int64]) -> dict[str, Any]:
    """Return how many cells there were and how many were cleared when, and after how many scans through them."""
    finite = delays[np.isfinite(delays)]
    return {
        "cells": len(delays),
        "within_2_s": int((delays <= 2.0 + 1e-9).sum()),
        "within_2_s_of_looking": int((np.isfinite(delays) & (looks <= _SCANS_IN_2_S)).sum()),
        "never": int(np.isinf(delays).sum()),
        "median_s": float(np.median(finite)) if len(finite) else None,
        "longest_s": float(finite.max()) if len(finite) else None,
    }
