"""One episode's simulator: the building, its people, the robot and its sensors, without Gymnasium."""

import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..slam.errors import InputError, unknown_name
from ..slam.scan import LaserScan
from .building import build
from .lidar import Lidar, LidarConfig
from .mj import mujoco
from .odometry import QUALITIES, OdometryConfig, WheelOdometry, odometry_quality
from .people.casting import cast_people
from .people.crowd import Casting, Crowd, CrowdState
from .people.leader import STYLES
from .people.social_force import SocialForceConfig
from .people.terrain import Terrain
from .people.walking import locate
from .robot import Robot, RobotConfig
from .scenes.catalogue import SCENES, make_scene
from .scenes.scene import Scene
from .truth import TruePeople, TrueState

Array = NDArray[np.float64]

TICK = 0.025
"""Time between two updates of people, odometry and laser [s]; control and laser periods are multiples of it."""


@dataclass(frozen=True, kw_only=True)
class WorldConfig:
    """What to simulate.

    Attributes:
        scene: Name of the building, see `SCENES`.
        route: Name of the tour, None draws one.
        people: Number of walking people, the leader included.
        leader: Whether the first of the people leads the robot. Without, all are bystanders: the same as with a
            leader and one person more.
        leader_style: "steady", "hurried" or "waits" (when the robot lags); None draws one.
        standing: Number of further people who walk to and fro beside the route and stand still for 25 s once the
            robot has come near.
        odometry: Name of a quality, see `QUALITIES`, or a configuration.
        lidar: The laser scanner.
        robot: The robot.
        force: The social force between people.
        control_hz: Commands per second [Hz].
        physics_dt: Time step of the physics [s].
    """

    scene: str = "corridor"
    route: str | None = None
    people: int = 2
    leader: bool = True
    leader_style: str | None = None
    standing: int = 0
    odometry: str | OdometryConfig = "typical"
    lidar: LidarConfig = field(default_factory=LidarConfig)
    robot: RobotConfig = field(default_factory=RobotConfig)
    force: SocialForceConfig = field(default_factory=SocialForceConfig)
    control_hz: float = 10.0
    physics_dt: float = 0.0125

    def __post_init__(self) -> None:
        if self.scene not in SCENES:
            raise unknown_name("scene", self.scene, tuple(SCENES))
        if self.leader_style is not None and self.leader_style not in STYLES:
            raise unknown_name("leader style", self.leader_style, tuple(STYLES))
        if isinstance(self.odometry, str) and self.odometry not in QUALITIES:
            raise unknown_name("odometry quality", self.odometry, tuple(QUALITIES))
        for name in ("people", "standing"):
            value = getattr(self, name)
            if not isinstance(value, int) or value < 0:
                raise InputError(f"`{name}` must be a whole number of at least 0, got {value!r}")
        _whole_ratio("the control period 1 / `control_hz`", 1.0 / self.control_hz, TICK)
        _whole_ratio("the laser's period 1 / `rate_hz`", 1.0 / self.lidar.rate_hz, TICK)
        _whole_ratio("the simulation's tick", TICK, self.physics_dt)


def _whole_ratio(what: str, long: float, short: float) -> int:
    ratio = round(long / short) if short > 0.0 else 0
    if ratio < 1 or abs(ratio * short - long) > 1e-9:
        raise InputError(f"{what} must be a whole multiple of {short} s, got {long} s")
    return ratio


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
        counters: Ticks since the start, way of the robot along the route, contacts.
    """

    physics: Array
    crowd: CrowdState
    odometry: dict[str, Any]
    setpoint: Array
    generators: dict[str, Any]
    scans: tuple[LaserScan, ...]
    labels: NDArray[np.int32]
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
        names = ("scene", "leader", "people", "odometry", "lidar")
        children = np.random.SeedSequence(entropy).spawn(len(names))
        streams = {name: np.random.default_rng(child) for name, child in zip(names, children, strict=True)}
        self.config = config
        self.scene: Scene = make_scene(config.scene, streams["scene"], config.route)
        self.start, start_arc = _draw_start(self.scene, streams["scene"])
        terrain = Terrain(self.scene)
        casting, people = cast_people(
            self.scene,
            terrain,
            config.people,
            config.standing,
            config.leader_style,
            config.leader and config.people > 0,
            start_arc,
            streams["leader"],
            streams["people"],
        )
        self._streams = {name: streams[name] for name in ("odometry", "lidar")}
        self._assemble(terrain, casting, people)
        self._progress = start_arc
        self._take_scan()

    def _assemble(self, terrain: Terrain, casting: Casting, people: CrowdState) -> None:
        config = self.config
        self._building = build(self.scene, casting.physiques, config.robot, config.lidar, config.physics_dt)
        self.model = self._building.model
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:3] = self.start
        self._crowd = Crowd(terrain, casting, people, config.force)
        self._crowd.pose(config.lidar.height, self.data.mocap_pos, self.data.mocap_quat)
        mujoco.mj_forward(self.model, self.data)
        self._robot = Robot(config.robot)
        quality = odometry_quality(config.odometry) if isinstance(config.odometry, str) else config.odometry
        self._odometry = WheelOdometry(quality, self._streams["odometry"], self.start)
        self._lidar = Lidar(config.lidar, self.model, self._building.labels)
        self._ticks_per_step = _whole_ratio("control", 1.0 / config.control_hz, TICK)
        self._ticks_per_scan = _whole_ratio("laser", 1.0 / config.lidar.rate_hz, TICK)
        self._substeps = _whole_ratio("tick", TICK, config.physics_dt)
        self._ticks = 0
        self._contact_person = self._contact_static = False
        self._scans: tuple[LaserScan, ...] = ()
        self._labels = np.zeros(0, dtype=np.int32)

    def step(self, command: ArrayLike) -> None:
        """Advance one control period.

        Args:
            command: (2,) forward speed and turn rate [m/s, rad/s]; or (3,) with the sideways speed in the middle, for
                the holonomic drive. Cut to the robot's limits.

        Raises:
            InputError: If the command does not fit the drive or is not finite.
        """
        wanted = self._robot.command(command)
        self._contact_person = self._contact_static = False
        scans: list[LaserScan] = []
        self._crowd.decide(self._ticks_per_step * TICK, self._robot_row(), self._progress)
        for _ in range(self._ticks_per_step):
            self.data.ctrl[:] = self._robot.ramp(wanted, TICK)
            if len(self._crowd):
                self._crowd.advance(TICK, self._robot_row())
                self._crowd.pose(self.config.lidar.height, self.data.mocap_pos, self.data.mocap_quat)
            for _ in range(self._substeps):
                mujoco.mj_step(self.model, self.data)
                if self.data.ncon:
                    self._note_contacts()
            self._odometry.update(self.data.qpos[:3].copy())
            self._ticks += 1
            if self._ticks % self._ticks_per_scan == 0:
                self._take_scan()
                scans.append(self._scans[-1])
        self._scans = tuple(scans) or self._scans[-1:]
        arc = np.array([self._progress])
        locate(self.data.qpos[None, :2], arc, self._crowd.terrain.path, self._crowd.terrain.tangent)
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
        self._ticks, self._progress, self._contact_person, self._contact_static = state.counters

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: getattr(self, name) for name in ("config", "scene", "start", "_streams")}
        return {**kept, "casting": self._crowd.casting, "state": self.save_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        for name in ("config", "scene", "start", "_streams"):
            setattr(self, name, kept[name])
        self._assemble(Terrain(self.scene), kept["casting"], copy.deepcopy(kept["state"].crowd))
        self.restore_state(kept["state"])

    def _pose(self) -> Array:
        x, y, theta = self.data.qpos[:3]
        return np.array([x, y, (theta + np.pi) % (2.0 * np.pi) - np.pi])

    def _robot_row(self) -> Array:
        x, y, theta = self.data.qpos[:3]
        length, width, _ = self.config.robot.size
        vx, vy = self.data.qvel[:2]
        return np.array([x, y, np.cos(theta), np.sin(theta), vx, vy, length / 2.0, width / 2.0])

    def _note_contacts(self) -> None:
        for pair in self.data.contact.geom:
            if max(self._building.contact_of[pair]) >= 0:
                self._contact_person = True
            else:
                self._contact_static = True

    def _take_scan(self) -> None:
        exact, self._labels = self._lidar.cast(self.data, self.data.qpos[:3])
        self._scans = (self._lidar.measure(exact, self._streams["lidar"], self.time_s),)


def _draw_start(scene: Scene, rng: np.random.Generator) -> tuple[Array, float]:
    """Return the robot's start pose (3,) near the beginning of the route, and its way along it [m]."""
    arc, lateral, turn = rng.uniform(0.0, 0.5), rng.uniform(-0.1, 0.1), rng.uniform(-0.12, 0.12)
    ahead = scene.route[1] - scene.route[0]
    ahead = ahead / np.hypot(*ahead)
    x, y = scene.route[0] + arc * ahead + lateral * np.array([-ahead[1], ahead[0]])
    return np.array([x, y, np.arctan2(ahead[1], ahead[0]) + turn]), float(arc)
