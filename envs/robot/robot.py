"""A robot like the Clearpath Dingo: a flat box on wheels, driven by body velocities with real contacts.

The chassis moves on two slides and a hinge. Its wheels are velocity servos in the body frame with a limited force, so
it accelerates, brakes and stops at walls like a body of its mass; the wheels of the differential drive also resist
sideways motion.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...slam.bounds import Within
from ...slam.errors import InputError, shown, unknown_name
from ..limits.field_checks import check_fields, finite_numbers
from ..physics.groups import GROUP_ROBOT
from ..physics.mj import MjSpec, mujoco

Array = NDArray[np.float64]
_Motion = Annotated[float, Within(1e-3, 100.0)]  # speeds and accelerations: no robot indoors comes near the upper end
_Strength = Annotated[float, Within(1e-3, 1e5)]
_Chassis = Annotated[tuple[float, float, float], Within(0.05, 3.0)]


@dataclass(frozen=True, kw_only=True)
class RobotConfig:
    """Size and limits of the robot.

    Speeds are those of the Dingo's data sheet (1.3 m/s) and of its public ROS controller (4 rad/s); that controller's
    acceleration limits (20 m/s^2) are no physical ones, so ours are moderate.

    Attributes:
        drive: "differential" (forward and turn) or "holonomic" (sideways, too).
        chassis: Length, width and height of the chassis [m]; None takes that of the Dingo with this drive, Dingo-D or
            Dingo-O. It hides nothing from the laser, which may look out of it.
        max_speed: Largest linear speed [m/s].
        max_turn_rate: Largest angular speed [rad/s].
        max_acceleration: Largest change of the linear velocity setpoint [m/s^2].
        max_turn_acceleration: Largest change of the angular velocity setpoint [rad/s^2].
        mass: Mass with laser and computer [kg].
        grip: Largest force of the wheels on the floor [N].
    """

    drive: str = "differential"
    chassis: _Chassis | None = None
    max_speed: _Motion = 1.3
    max_turn_rate: _Motion = 4.0
    max_acceleration: _Motion = 2.0
    max_turn_acceleration: _Motion = 8.0
    mass: _Strength = 14.0
    grip: _Strength = 70.0

    sizes: ClassVar[dict[str, tuple[float, float, float]]] = {
        "differential": (0.549, 0.517, 0.111),
        "holonomic": (0.680, 0.510, 0.111),
    }
    """Length, width and height of the Dingo's chassis with each drive [m]."""

    def __post_init__(self) -> None:
        check_fields(self)
        if self.drive not in self.sizes:
            raise unknown_name("drive", self.drive, tuple(self.sizes))

    @property
    def holonomic(self) -> bool:
        """Whether it can drive sideways."""
        return self.drive == "holonomic"

    @property
    def size(self) -> tuple[float, float, float]:
        """Length, width, height of the chassis [m]."""
        return self.sizes[self.drive] if self.chassis is None else self.chassis

    @property
    def radius(self) -> float:
        """Radius of the circle around the chassis [m]."""
        return float(np.hypot(self.size[0], self.size[1])) / 2.0


ROBOTS: dict[str, RobotConfig] = {
    "dingo-d": RobotConfig(),
    "dingo-o": RobotConfig(drive="holonomic"),
    "pioneer": RobotConfig(chassis=(0.455, 0.381, 0.237), max_speed=1.2, max_turn_rate=5.2, mass=14.0, grip=60.0),
}
"""Name -> robot. The Clearpath Dingo by its data sheet: "dingo-d" with two driven wheels, "dingo-o" with four Mecanum
wheels (Ye 2021). "pioneer" is the Pioneer 3-DX of Zhang et al. 2019: 455 x 381 x 237 mm, 9 kg without laser and
computer, 1.2 m/s and 300 deg/s by the data sheet of Adept MobileRobots; accelerations are moderate as the Dingo's,
since the firmware's are settings of its user."""


class Robot:
    """Turns commands into the setpoints of the wheels, within the limits of acceleration.

    Args:
        config: Size and limits.
    """

    def __init__(self, config: RobotConfig) -> None:
        self.config = config
        self.setpoint = np.zeros(3)

    def command(self, command: ArrayLike) -> Array:
        """Return the wanted body velocity (3,) [m/s, m/s, rad/s] of a command, cut to the limits.

        Args:
            command: (2,) forward and turning speed; or (3,) with sideways speed in the middle, for the holonomic drive.

        Raises:
            InputError: If the shape does not fit the drive or a value is not finite.
        """
        wanted = finite_numbers(command)
        shapes = [(2,), (3,)] if self.config.holonomic else [(2,)]
        if wanted is None or wanted.shape not in shapes:
            raise InputError(
                f"a command of the {self.config.drive} drive has shape {shapes}, finite, got {shown(command)}"
            )
        if wanted.shape == (2,):
            wanted = np.array([wanted[0], 0.0, wanted[1]])
        speed = np.hypot(wanted[0], wanted[1])
        scale = min(1.0, self.config.max_speed / speed) if speed > 0.0 else 1.0
        turn = min(max(float(wanted[2]), -self.config.max_turn_rate), self.config.max_turn_rate)
        return np.array([wanted[0] * scale, wanted[1] * scale, turn])

    def ramp(self, wanted: Array, dt: float) -> Array:
        """Move the setpoint (3,) towards `wanted` (3,) for `dt` seconds and return it."""
        step, turn_step = self.config.max_acceleration * dt, self.config.max_turn_acceleration * dt
        x, y, turn = (wanted - self.setpoint).tolist()
        change = (min(max(x, -step), step), min(max(y, -step), step), min(max(turn, -turn_step), turn_step))
        self.setpoint = self.setpoint + change
        return self.setpoint


def add_robot(spec: MjSpec, config: RobotConfig, laser_height: float, laser_at: tuple[float, float]) -> None:
    """Add the robot to `spec`: body "robot", joints "robot x", "robot y", "robot theta", three actuators."""
    length, width, height = config.size
    body = spec.worldbody.add_body(name="robot", pos=[0.0, 0.0, 0.0])
    body.add_joint(name="robot x", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[1, 0, 0])
    body.add_joint(name="robot y", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0, 1, 0])
    body.add_joint(name="robot theta", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    body.add_geom(
        name="chassis",
        type=mujoco.mjtGeom.mjGEOM_BOX,
        size=[length / 2.0, width / 2.0, (height - 0.02) / 2.0],
        pos=[0.0, 0.0, height / 2.0 + 0.01],
        mass=config.mass,
        rgba=[0.95, 0.75, 0.1, 1.0],
        contype=1,
        conaffinity=0,
        friction=[0.3, 0.005, 0.0001],
        group=GROUP_ROBOT,
    )
    body.add_geom(
        name="laser",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=[0.03, max(0.02, (laser_height + 0.03 - height) / 2.0), 0.0],
        pos=[*laser_at, (laser_height + 0.03 + height) / 2.0],
        mass=0.0,
        rgba=[0.1, 0.1, 0.1, 1.0],
        contype=0,
        conaffinity=0,
        group=GROUP_ROBOT,
    )
    body.add_site(name="wheels", pos=[0.0, 0.0, 0.0])
    gains, limits = servo_gains(config)
    for k, (name, axis) in enumerate((("forward", 0), ("sideways", 1), ("turn", 5))):
        _add_servo(spec, name, axis, gains[k], limits[k])


def servo_gains(config: RobotConfig) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the gains [N s/m, N s/m, N m s] and limits [N, N, N m] of the servos forward, sideways and turn."""
    length, width, _ = config.size
    inertia = config.mass * (length**2 + width**2) / 12.0
    gains = config.mass / 0.03, config.mass / 0.01, inertia / 0.03
    return gains, (config.grip, config.grip, config.grip * width / 2.0)


def _add_servo(spec: MjSpec, name: str, axis: int, gain: float, limit: float) -> None:
    """Add an actuator that drives the robot's velocity along one axis of its own frame to the control."""
    gear = np.zeros(6)
    gear[axis] = 1.0
    spec.add_actuator(
        name=name,
        trntype=mujoco.mjtTrn.mjTRN_SITE,
        target="wheels",
        gear=gear,
        gaintype=mujoco.mjtGain.mjGAIN_FIXED,
        gainprm=[gain] + [0.0] * 9,
        biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        biasprm=[0.0, 0.0, -gain] + [0.0] * 7,
        forcerange=[-limit, limit],
        forcelimited=True,
    )
