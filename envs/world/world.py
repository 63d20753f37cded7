"""One episode's simulator: the building, its people, the robot and its sensors, without Gymnasium."""

import copy
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...perception.rgbd.frame import RgbdFrame
from ...slam.geometry import wrap_one
from ...slam.processes.stages import Stages, completed
from ...slam.scan import LaserScan
from ..appearance.looks import dress
from ..appearance.wardrobe import Outfit, draw_outfit, wardrobe
from ..people.body import PARTS
from ..people.crowd import Crowd, first_state
from ..people.movement.terrain import Terrain
from ..people.movement.walking import locate
from ..physics.mj import MjData, mujoco
from ..robot.robot import Robot
from ..sensors.camera.rgbd import RgbdCamera
from ..sensors.lidar import Lidar
from .building import build
from .config import TICK, WorldConfig, whole_ratio
from .doors import Doors
from .drawing import draw_episode
from .state import Changing, Plan, WorldState
from .truth import TruePeople, TrueState

Array = NDArray[np.float64]

_PHYSICS = int(mujoco.mjtState.mjSTATE_INTEGRATION)


class World:
    """One episode's simulator.

    `step` advances one control period. All draws come from streams of `draw_episode`: the same seed gives the same
    building and start whoever walks in it.

    Args:
        config: What to simulate.
        rng: Source of all draws; used only here, at the start.
    """

    def __init__(self, config: WorldConfig, rng: np.random.Generator) -> None:
        drawn = draw_episode(config, rng)
        self._plan, casting = drawn.plan, drawn.plan.casting
        self._now = Changing(
            crowd=first_state(casting),
            doors=Doors(drawn.plan.scene.doors),
            robot=Robot(config.robot),
            odometry=drawn.odometry,
            streams=drawn.streams,
            progress=drawn.start_arc,
        )
        self._build(drawn.terrain)
        self.data.qpos[:3] = self.start
        self._pose_movers()
        mujoco.mj_forward(self.model, self.data)
        self._take_scan()
        self._take_frame()

    def _build(self, terrain: Terrain) -> None:
        """Make all that never changes, from the plan."""
        plan = self._plan
        config = self.config = plan.config
        self.scene, self.start = plan.scene, plan.start
        physiques, outfits = plan.casting.physiques, _outfits(plan)
        self._building = build(plan.scene, physiques, config.robot, config.lidar, config.physics_dt, outfits)
        self.model = self._building.model
        self.data = mujoco.MjData(self.model)
        self._crowd = Crowd(terrain, plan.casting, config.force)
        self._camera = self._ticks_per_frame = None
        if config.camera is not None:
            looks = dress(self.model, np.random.default_rng(plan.looks_seed), outfits)
            self._camera = RgbdCamera(config.camera, self.model, looks)
            self._ticks_per_frame = whole_ratio("camera", 1.0 / config.camera.rate_hz, TICK)
        self._lidar = Lidar(config.lidar, self.model, self._building.labels)
        self._ticks_per_step = whole_ratio("control", 1.0 / config.control_hz, TICK)
        self._ticks_per_scan = whole_ratio("laser", 1.0 / config.lidar.rate_hz, TICK)
        self._substeps = whole_ratio("tick", TICK, config.physics_dt)

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
        now = self._now
        wanted = now.robot.command(command)
        now.contact_person = now.contact_static = False
        scans: list[LaserScan] = []
        frames: list[RgbdFrame] = []
        period = self._ticks_per_step * TICK
        robot = _robot_row(self.data, self.config.robot.size)
        self._crowd.decide(now.crowd, period, robot, now.progress, now.streams["behaviours"])
        yield
        poses = np.empty((self._ticks_per_step, 3))
        for tick in range(self._ticks_per_step):
            self.data.ctrl[:] = now.robot.ramp(wanted, TICK)
            if len(self._crowd):
                self._crowd.advance(now.crowd, TICK, _robot_row(self.data, self.config.robot.size))
                now.doors.advance(TICK, now.crowd.bodies.position)
                self._pose_movers()
            for _ in range(self._substeps):
                mujoco.mj_step(self.model, self.data)
                if self.data.ncon:
                    person = self._building.contact_of[self.data.contact.geom].max(axis=1) >= 0
                    now.contact_person |= bool(person.any())
                    now.contact_static |= not person.all()
            poses[tick] = self.data.qpos[:3]
            now.ticks += 1
            if now.ticks % self._ticks_per_scan == 0:
                yield
                self._take_scan()
                scans.append(now.scans[-1])
            if self._ticks_per_frame and now.ticks % self._ticks_per_frame == 0:
                self._take_frame()
                frames.append(now.frames[-1])
        yield
        now.odometry.update(poses)
        now.scans = tuple(scans) or now.scans[-1:]
        now.frames = tuple(frames) or now.frames[-1:]
        arc, ways = np.array([now.progress]), self._crowd.terrain.ways
        locate(self.data.qpos[None, :2], arc, ways.points, ways.tangents, ways.first[:1], ways.rows[:1])
        now.progress = float(arc[0])

    def scan(self) -> LaserScan:
        """Return the latest sweep of the laser, with noise."""
        return self._now.scans[-1]

    @property
    def scans(self) -> tuple[LaserScan, ...]:
        """All sweeps of the last control period, oldest first; the latest older one where there was none."""
        return self._now.scans

    def scan_labels(self) -> NDArray[np.int32]:
        """Return (beams,) what each beam of the latest sweep really met: -1 static or nothing, else the person."""
        return self._now.labels.copy()

    @property
    def frames(self) -> tuple[RgbdFrame, ...]:
        """All frames of the last control period, oldest first; the latest older one where there was none; () without
        a camera.
        """
        return self._now.frames

    def frame_geoms(self) -> NDArray[np.int32]:
        """Return (height, width) the geom that each pixel of the latest frame really met, -1 for none."""
        return self._now.geoms.copy()

    def people_of(self, geoms: NDArray[np.int32]) -> NDArray[np.int32]:
        """Return, for geoms (...,) as in `frame_geoms`, the person that each belongs to; -1 for none."""
        mocap = self.model.body_mocapid[self.model.geom_bodyid[np.maximum(geoms, 0)]]
        person = np.where((geoms >= 0) & (mocap >= 0), mocap // len(PARTS), -1)
        return np.where(person < len(self._crowd), person, -1).astype(np.int32)

    @property
    def doors_open(self) -> Array:
        """(d,) how far each door is open, from 0 to 1."""
        return self._now.doors.angle.copy()

    @property
    def odometry(self) -> Array:
        """(3,) T_odom_robot as the wheels believe; the odometry frame is the robot's frame at the start."""
        return self._now.odometry.pose.copy()

    @property
    def time_s(self) -> float:
        """Time since the start [s]."""
        return self._now.ticks * TICK

    @property
    def truth(self) -> TrueState:
        """What is really so, now."""
        people, led = self._now.crowd.bodies, self._now.crowd.led
        pose = true_robot_pose(self)
        x, y, turn = self.data.qvel[:3]
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        speed = np.hypot(people.velocity[:, 0], people.velocity[:, 1])
        if not led:
            done = self._now.progress >= self.scene.tour_length
        else:
            done = self._now.crowd.leader_done and float(np.hypot(*(people.position[0] - pose[:2]))) < 2.0
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
            leader_index=0 if led else -1,
            leader_walking=bool(led and people.wish[0] > 0.05 and speed[0] > 0.2),
            contact_person=self._now.contact_person,
            contact_static=self._now.contact_static,
            tour_done=bool(done),
            robot_progress=self._now.progress,
        )

    def save_state(self) -> WorldState:
        """Return a snapshot; `restore_state` of it in an equal world continues with the same bytes."""
        physics = np.empty(mujoco.mj_stateSize(self.model, _PHYSICS))
        mujoco.mj_getState(self.model, self.data, physics, _PHYSICS)
        return WorldState(physics, copy.deepcopy(self._now))

    def restore_state(self, state: WorldState) -> None:
        """Go back to `state`, a snapshot of this world or of an equal one; the snapshot can be used again."""
        self._now = copy.deepcopy(state.changing)
        mujoco.mj_setState(self.model, self.data, state.physics, _PHYSICS)
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state.physics, _PHYSICS)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, (self._plan, self.save_state())

    def _pose_movers(self) -> None:
        self._crowd.pose(self._now.crowd, self.config.lidar.height, self.data.mocap_pos, self.data.mocap_quat)
        if len(self._now.doors.angle):
            self._now.doors.pose(self.data.mocap_quat[-len(self._now.doors.angle) :])

    def _take_scan(self) -> None:
        exact, self._now.labels = self._lidar.cast(self.data, self.data.qpos[:3])
        self._now.scans = (self._lidar.measure(exact, self._now.streams["lidar"], self.time_s),)

    def _take_frame(self) -> None:
        if self._camera is None:
            return
        frame, self._now.geoms = self._camera.take(
            self.data, self.data.qpos[:3], self._now.streams["camera"], self.time_s
        )
        self._now.frames = (frame,)


def _outfits(plan: Plan) -> tuple[Outfit, ...]:
    """Return what everybody wears; () without a camera."""
    if plan.config.camera is None:
        return ()
    rng, choice = np.random.default_rng([plan.looks_seed, 1]), wardrobe(plan.config.camera.wardrobe)
    return tuple(draw_outfit(rng, choice) for _ in plan.casting.people)


def true_robot_pose(world: World) -> Array:
    """Return (3,) T_world_robot [m, m, rad]; all of `World.truth` takes ten times as long."""
    x, y, theta = world.data.qpos[:3].tolist()
    return np.array([x, y, wrap_one(theta)])


def _robot_row(data: MjData, size: tuple[float, float, float]) -> Array:
    """Return (8,) the robot of a chassis' size as `advance_bodies` takes it."""
    x, y, theta = data.qpos[:3].tolist()
    length, width, _ = size
    vx, vy = data.qvel[:2].tolist()
    return np.array((x, y, np.cos(theta), np.sin(theta), vx, vy, length / 2.0, width / 2.0))


def _rebuilt(plan: Plan, state: WorldState) -> World:
    """Return the world of a plan in a state that was saved."""
    world = World.__new__(World)
    world._plan = plan
    world._build(Terrain(plan.scene))
    world.restore_state(state)
    return world
