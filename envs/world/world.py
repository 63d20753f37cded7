"""One episode's simulator: the building, its people, the robot and its sensors, without Gymnasium."""

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...perception.rgbd.frame import RgbdFrame
from ...slam.processes.stages import Stages, completed
from ...slam.scan import LaserScan
from ..people.body import PARTS
from ..people.casting import MOST_ON_ROUTE, cast_people
from ..people.crowd import Casting, Crowd, CrowdState
from ..people.terrain import Terrain
from ..people.walking import locate
from ..people.wanderers import MOST_DRAWN, cast_wanderers
from ..people.wardrobe import Outfit, draw_outfit, wardrobe
from ..robot.odometry import WheelOdometry, odometry_quality
from ..robot.robot import Robot
from ..scenes.catalogue import make_scene
from ..scenes.recorded_walks import with_recorded_walks
from ..scenes.scene import Scene
from ..sensors.camera.looks import dress
from ..sensors.camera.rgbd import RgbdCamera
from ..sensors.lidar import Lidar
from .building import build
from .config import TICK, WorldConfig, whole_ratio
from .doors import Doors
from .mj import mujoco
from .truth import TruePeople, TrueState

Array = NDArray[np.float64]

_KEPT = ("config", "scene", "start", "_streams", "_looks_seed")


@dataclass(frozen=True, eq=False)
class WorldState:
    """A snapshot of a world: continuing from it gives the same bytes again.

    Attributes:
        physics: MuJoCo's full integration state.
        crowd: The people.
        odometry: Believed pose, last true pose and systematic errors.
        setpoint: (3,) the wheels' setpoint.
        generators: State of each random generator.
        scans: The scans of the last control period.
        labels: What the beams of the latest one met.
        frames: The frames of the last control period.
        geoms: What the pixels of the latest one met.
        doors: (d,) how far each door is open.
        counters: Ticks since the start, way of the robot along the route, contacts.
    """

    physics: Array
    crowd: CrowdState
    odometry: dict[str, Any]
    setpoint: Array
    generators: dict[str, Any]
    scans: tuple[LaserScan, ...]
    labels: NDArray[np.int32]
    frames: tuple[RgbdFrame, ...]
    geoms: NDArray[np.int32]
    doors: Array
    counters: tuple[int, float, bool, bool]


class World:
    """One episode's simulator.

    `step` advances one control period. All draws come from streams that are spawned from `rng` once, one each for the
    building, the leader, the other people, the odometry and the laser: the same seed gives the same building and start
    whoever walks in it.

    Args:
        config: What to simulate.
        rng: Source of all draws; used only here, at the start.
    """

    def __init__(self, config: WorldConfig, rng: np.random.Generator) -> None:
        entropy = [int(word) for word in rng.integers(0, 2**63, 4)]
        names = ("scene", "leader", "people", "odometry", "lidar", "camera", "looks")
        children = np.random.SeedSequence(entropy).spawn(len(names))
        streams = {name: np.random.default_rng(child) for name, child in zip(names, children, strict=True)}
        self.config = config
        self.scene: Scene = make_scene(config.scene, streams["scene"], request=config.request())
        if config.walking_paths is not None:
            self.scene = with_recorded_walks(self.scene, config.walking_paths, streams["scene"])
        self.start, start_arc = _draw_start(self.scene, streams["scene"])
        terrain = Terrain(self.scene)
        cast = cast_wanderers if self.scene.walks else cast_people
        count = _how_many(config, self.scene, streams["people"])
        casting, people = cast(
            self.scene,
            terrain,
            count,
            config.standing,
            config.leader_style,
            config.leader and count > 0,
            start_arc,
            streams["leader"],
            streams["people"],
        )
        self._streams = {name: streams[name] for name in ("odometry", "lidar", "camera")}
        self._looks_seed = int(streams["looks"].integers(2**63))
        self._assemble(terrain, casting, people)
        self._progress = start_arc
        self._take_scan()
        self._take_frame()

    def _assemble(self, terrain: Terrain, casting: Casting, people: CrowdState) -> None:
        config = self.config
        outfits = self._outfits(len(casting.physiques))
        self._building = build(self.scene, casting.physiques, config.robot, config.lidar, config.physics_dt, outfits)
        self.model = self._building.model
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:3] = self.start
        self._crowd = Crowd(terrain, casting, people, config.force)
        self._doors = Doors(self.scene.doors)
        self._camera = self._ticks_per_frame = None
        if config.camera is not None:
            looks = dress(self.model, np.random.default_rng(self._looks_seed), outfits)
            self._camera = RgbdCamera(config.camera, self.model, looks)
            self._ticks_per_frame = whole_ratio("camera", 1.0 / config.camera.rate_hz, TICK)
        self._pose_movers()
        mujoco.mj_forward(self.model, self.data)
        self._robot = Robot(config.robot)
        quality = odometry_quality(config.odometry) if isinstance(config.odometry, str) else config.odometry
        self._odometry = WheelOdometry(quality, self._streams["odometry"], self.start)
        self._lidar = Lidar(config.lidar, self.model, self._building.labels)
        self._ticks_per_step = whole_ratio("control", 1.0 / config.control_hz, TICK)
        self._ticks_per_scan = whole_ratio("laser", 1.0 / config.lidar.rate_hz, TICK)
        self._substeps = whole_ratio("tick", TICK, config.physics_dt)
        self._ticks = 0
        self._contact_person = self._contact_static = False
        self._scans: tuple[LaserScan, ...] = ()
        self._labels = np.zeros(0, dtype=np.int32)
        self._frames: tuple[RgbdFrame, ...] = ()
        self._geoms = np.zeros((0, 0), dtype=np.int32)

    def _outfits(self, count: int) -> tuple[Outfit, ...]:
        """Return what each of `count` people wears; () without a camera."""
        if self.config.camera is None:
            return ()
        rng, choice = np.random.default_rng([self._looks_seed, 1]), wardrobe(self.config.camera.wardrobe)
        return tuple(draw_outfit(rng, choice) for _ in range(count))

    def step(self, command: ArrayLike) -> None:
        """Advance one control period.

        Args:
            command: (2,) forward speed and turn rate [m/s, rad/s]; or (3,) with the sideways speed in the middle, for
                the holonomic drive. Cut to the robot's limits.

        Raises:
            InputError: If the command does not fit the drive or is not finite.
        """
        completed(self.step_in_stages(command))

    def step_in_stages(self, command: ArrayLike) -> Stages[None]:
        """Do as `step`, with pauses."""
        wanted = self._robot.command(command)
        self._contact_person = self._contact_static = False
        scans: list[LaserScan] = []
        frames: list[RgbdFrame] = []
        self._crowd.decide(self._ticks_per_step * TICK, self._robot_row(), self._progress)
        yield
        poses = np.empty((self._ticks_per_step, 3))
        for tick in range(self._ticks_per_step):
            self.data.ctrl[:] = self._robot.ramp(wanted, TICK)
            if len(self._crowd):
                self._crowd.advance(TICK, self._robot_row())
                self._doors.advance(TICK, self._crowd.state.position)
                self._pose_movers()
            for _ in range(self._substeps):
                mujoco.mj_step(self.model, self.data)
                if self.data.ncon:
                    self._note_contacts()
            poses[tick] = self.data.qpos[:3]
            self._ticks += 1
            if self._ticks % self._ticks_per_scan == 0:
                yield
                self._take_scan()
                scans.append(self._scans[-1])
            if self._ticks_per_frame and self._ticks % self._ticks_per_frame == 0:
                self._take_frame()
                frames.append(self._frames[-1])
        yield
        self._odometry.update(poses)
        self._scans = tuple(scans) or self._scans[-1:]
        self._frames = tuple(frames) or self._frames[-1:]
        arc, ways = np.array([self._progress]), self._crowd.terrain
        locate(self.data.qpos[None, :2], arc, ways.paths, ways.tangents, ways.first[:1], ways.count[:1])
        self._progress = float(arc[0])

    def scan(self) -> LaserScan:
        """Return the latest sweep of the laser, with noise."""
        return self._scans[-1]

    @property
    def scans(self) -> tuple[LaserScan, ...]:
        """All sweeps of the last control period, oldest first; the latest older one where there was none."""
        return self._scans

    def scan_labels(self) -> NDArray[np.int32]:
        """Return (beams,) what each beam of the latest sweep really met: -1 static or nothing, else the person."""
        return self._labels.copy()

    @property
    def frames(self) -> tuple[RgbdFrame, ...]:
        """All frames of the last control period, oldest first; the latest older one where there was none; () without
        a camera.
        """
        return self._frames

    def frame_geoms(self) -> NDArray[np.int32]:
        """Return (height, width) the geom that each pixel of the latest frame really met, -1 for none."""
        return self._geoms.copy()

    def people_of(self, geoms: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return, for geoms (...,) as in `frame_geoms`, the person that each belongs to; -1 for none."""
        mocap = self.model.body_mocapid[self.model.geom_bodyid[np.maximum(geoms, 0)]]
        person = np.where((geoms >= 0) & (mocap >= 0), mocap // len(PARTS), -1)
        return np.where(person < len(self._crowd), person, -1).astype(np.int32)

    @property
    def doors_open(self) -> Array:
        """(d,) how far each door is open, from 0 to 1."""
        return self._doors.angle.copy()

    @property
    def odometry(self) -> Array:
        """(3,) T_odom_robot as the wheels believe; the odometry frame is the robot's frame at the start."""
        return self._odometry.pose.copy()

    @property
    def time_s(self) -> float:
        """Time since the start [s]."""
        return self._ticks * TICK

    @property
    def truth(self) -> TrueState:
        """What is really so, now."""
        people, leader = self._crowd.state, self._crowd.state.leader
        pose = self._pose()
        x, y, turn = self.data.qvel[:3]
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        speed = np.hypot(people.velocity[:, 0], people.velocity[:, 1])
        if leader is None:
            done = self._progress >= self.scene.tour_length
        else:
            done = leader.done and float(np.hypot(*(people.position[0] - pose[:2]))) < 2.0
        return TrueState(
            time_s=self.time_s,
            robot_pose=pose,
            robot_velocity=np.array([cos * x + sin * y, cos * y - sin * x, turn]),
            people=TruePeople(
                people.position.copy(),
                people.heading.copy(),
                people.velocity.copy(),
                people.feet.copy(),
                people.legs.copy(),
                self._crowd.radius.copy(),
                self._crowd.leg_radius.copy(),
                speed > 0.2,
            ),
            leader_index=self._crowd.leader_index,
            leader_walking=bool(leader is not None and people.wish[0] > 0.05 and speed[0] > 0.2),
            contact_person=self._contact_person,
            contact_static=self._contact_static,
            tour_done=bool(done),
            robot_progress=self._progress,
        )

    def save_state(self) -> WorldState:
        """Return a snapshot; `restore_state` of it in an equal world continues with the same bytes."""
        kind = int(mujoco.mjtState.mjSTATE_INTEGRATION)
        physics = np.empty(mujoco.mj_stateSize(self.model, kind))
        mujoco.mj_getState(self.model, self.data, physics, kind)
        odometry = {key: copy.copy(value) for key, value in vars(self._odometry).items() if not key.startswith("_")}
        return WorldState(
            physics=physics,
            crowd=copy.deepcopy(self._crowd.state),
            odometry=odometry,
            setpoint=self._robot.setpoint.copy(),
            generators={name: stream.bit_generator.state for name, stream in self._streams.items()},
            scans=self._scans,
            labels=self._labels.copy(),
            frames=self._frames,
            geoms=self._geoms.copy(),
            doors=self._doors.angle.copy(),
            counters=(self._ticks, self._progress, self._contact_person, self._contact_static),
        )

    def restore_state(self, state: WorldState) -> None:
        """Go back to `state`, a snapshot of this world or of an equal one; the snapshot can be used again."""
        mujoco.mj_setState(self.model, self.data, state.physics, int(mujoco.mjtState.mjSTATE_INTEGRATION))
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state.physics, int(mujoco.mjtState.mjSTATE_INTEGRATION))
        self._crowd.state = copy.deepcopy(state.crowd)
        vars(self._odometry).update({key: copy.copy(value) for key, value in state.odometry.items()})
        self._robot.setpoint = state.setpoint.copy()
        for name, stream in self._streams.items():
            stream.bit_generator.state = state.generators[name]
        self._scans, self._labels = state.scans, state.labels.copy()
        self._frames, self._geoms = state.frames, state.geoms.copy()
        self._doors.angle = state.doors.copy()
        self._ticks, self._progress, self._contact_person, self._contact_static = state.counters

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: getattr(self, name) for name in _KEPT}
        return {**kept, "casting": self._crowd.casting, "state": self.save_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        for name in _KEPT:
            setattr(self, name, kept[name])
        self._assemble(Terrain(self.scene), kept["casting"], copy.deepcopy(kept["state"].crowd))
        self.restore_state(kept["state"])

    def _pose(self) -> Array:
        x, y, theta = self.data.qpos[:3]
        return np.array([x, y, (theta + np.pi) % (2.0 * np.pi) - np.pi])

    def _robot_row(self) -> Array:
        x, y, theta = self.data.qpos[:3].tolist()
        length, width, _ = self._robot.config.size
        vx, vy = self.data.qvel[:2].tolist()
        return np.array((x, y, np.cos(theta), np.sin(theta), vx, vy, length / 2.0, width / 2.0))

    def _note_contacts(self) -> None:
        for pair in self.data.contact.geom:
            if max(self._building.contact_of[pair]) >= 0:
                self._contact_person = True
            else:
                self._contact_static = True

    def _pose_movers(self) -> None:
        self._crowd.pose(self.config.lidar.height, self.data.mocap_pos, self.data.mocap_quat)
        if len(self._doors.angle):
            self._doors.pose(self.data.mocap_quat[-len(self._doors.angle) :])

    def _take_scan(self) -> None:
        exact, self._labels = self._lidar.cast(self.data, self.data.qpos[:3])
        self._scans = (self._lidar.measure(exact, self._streams["lidar"], self.time_s),)

    def _take_frame(self) -> None:
        if self._camera is None:
            return
        frame, self._geoms = self._camera.take(self.data, self.data.qpos[:3], self._streams["camera"], self.time_s)
        self._frames = (frame,)


def _how_many(config: WorldConfig, scene: Scene, rng: np.random.Generator) -> int:
    if config.people is not None:
        return config.people
    bystanders = int(rng.integers(0, 1 + (MOST_DRAWN if scene.walks else MOST_ON_ROUTE)))
    return bystanders + int(config.leader)


def _draw_start(scene: Scene, rng: np.random.Generator) -> tuple[Array, float]:
    """Return the robot's start pose (3,) near the beginning of the route, and its way along it [m]."""
    arc, lateral, turn = rng.uniform(0.0, 0.5), rng.uniform(-0.1, 0.1), rng.uniform(-0.12, 0.12)
    ahead = scene.route[1] - scene.route[0]
    ahead = ahead / np.hypot(*ahead)
    x, y = scene.route[0] + arc * ahead + lateral * np.array([-ahead[1], ahead[0]])
    return np.array([x, y, np.arctan2(ahead[1], ahead[0]) + turn]), float(arc)
