"""What never changes in a batch of worlds, and what of a configuration compiled worlds can do."""

from collections.abc import Mapping
from typing import Any, NamedTuple, get_type_hints

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.selection import LeaderNumbers, leader_numbers
from ...slam.errors import InputError, shown
from ..episode_setup import world_config
from ..follow_config import FollowConfig, make_config
from ..robot.robot import RobotConfig, servo_gains
from ..tracker_errors.errors import TrackerErrors, chosen_errors
from ..world.config import TICK, whole_ratio
from .driving import Base

Array = NDArray[np.float64]

DEFAULTS: dict[str, Any] = {"people": "truth", "slam": None}
"""What compiled worlds take where nothing is said: those of `FollowEnv` are not supported yet."""
PEOPLE = "truth", "modelled", "tracker"
"""How compiled worlds let the robot know of people."""


class Laser(NamedTuple):
    """The laser; kernels take it as it is.

    Attributes:
        cos_bearing: (n,) of the beams in the robot's axes.
        sin_bearing: (n,).
        first: Bearing of the first beam in the robot's axes [rad].
        spacing: Between two beams [rad].
        mount: (2,) its place in the robot's frame [m].
        height: Of its plane [m].
        range_min: [m].
        range_max: [m].
        near: Where the noise changes [m].
        sigma_near: Noise up to there [m].
        sigma_far: Noise beyond [m].
        dropout: Share of the beams that fail.
    """

    cos_bearing: Array
    sin_bearing: Array
    first: float
    spacing: float
    mount: Array
    height: float
    range_min: float
    range_max: float
    near: float
    sigma_near: float
    sigma_far: float
    dropout: float


class Rules(NamedTuple):
    """What never changes; kernels take it as it is.

    Attributes:
        base: The robot.
        laser: Its laser.
        selecting: How it chooses its leader.
        modelled: Whether it knows people with the errors of a tracker; else by the truth.
        tracked: Whether the real tracker tells it of people, by kernels of its own.
        errors: These.
        force: (9,) `SocialForceConfig.as_array()`.
        top: (3,) body velocity at action 1, of forward, left, turn [m/s, m/s, rad/s].
        weights: (7,) of the reward's terms.
        shapes: (6,) of them.
        robot_radius: Of the circle around the robot [m].
        lost_limit_s: The episode ends when the leader was not followed for this long [s].
        ends_on_contact: Whether a contact ends it.
        holonomic: Whether the action is (forward, left, turn).
        ticks: Ticks of a control period.
        substeps: Physics steps of a tick.
        sweeps: Sweeps of a control period.
        limit: Steps after which an episode is truncated; 0: never.
        ahead: How many plans there are for episodes that follow by themselves; those of single worlds stand behind.
    """

    base: Base
    laser: Laser
    selecting: LeaderNumbers
    modelled: bool
    tracked: bool
    errors: TrackerErrors
    force: Array
    top: Array
    weights: Array
    shapes: Array
    robot_radius: float
    lost_limit_s: float
    ends_on_contact: bool
    holonomic: bool
    ticks: int
    substeps: int
    sweeps: int
    limit: int
    ahead: int


def compiled_config(fields: Mapping[str, Any]) -> FollowConfig:
    """Return the configuration of compiled worlds; `people` is "truth" and `slam` None where nothing is said.

    Args:
        fields: Keyword arguments of `FollowEnv`.

    Raises:
        InputError: If they are wrong, or ask for what only MuJoCo's worlds can do.
    """
    fields = {name: value for name, value in fields.items() if not (name == "render_mode" and value is None)}
    for name in ("render_mode", "render_backend"):
        if name in fields:
            raise _unsupported(f"`{name}`", fields[name], "nothing can be drawn")
    said = {name.split(".")[0] for name in fields}
    config = make_config({**{name: value for name, value in DEFAULTS.items() if name not in said}, **fields})
    if config.people.source not in PEOPLE:
        raise _unsupported("`people`", config.people.source, f"it must be one of {', '.join(PEOPLE)}")
    for name, given, only in (
        ("`slam`", config.slam, None),
        ("`camera`", config.sensors.camera, None),
        ("`task.leader`", bool(config.task.leader), True),
        ("`task.coverage`", bool(config.task.coverage), False),
        ("`behaviours`", config.people.behaviours, ()),
        ("`observation.entries`", dict(config.observation.entries), {}),
    ):
        if given != only:
            raise _unsupported(name, given, f"it must be {only!r}")
    sweeps = round(config.sensors.lidar.rate_hz / config.task.control_hz)
    if config.people.source == "tracker" and sweeps != 1:
        raise _unsupported("`people`", "tracker", f"with {sweeps} sweeps a step, for it takes one")
    if config.people.source == "tracker" and config.perception.method != "hypotheses":
        raise _unsupported("`perception.method`", config.perception.method, 'it must be "hypotheses"')
    world_config(config, None)
    return config


def _unsupported(name: str, given: object, rule: str) -> InputError:
    return InputError(f'`simulator="compiled"` does not support {name} {shown(given)}: {rule}; "mujoco" does')


def as_declared(numbers: Any) -> Any:
    """Return a NamedTuple whose fields have the types that they declare, as kernels that were compiled know them.

    A whole number where a fraction may stand, as in `robot.max_turn_rate=3`, would be another type, and compile all
    kernels anew: half a minute.
    """
    kinds = get_type_hints(type(numbers))
    return numbers._replace(**{name: _as(kinds[name], value) for name, value in numbers._asdict().items()})


def _as(kind: Any, value: Any) -> Any:
    if kind == Array:
        return np.asarray(value, dtype=np.float64)
    if kind in (float, int, bool):
        return kind(value)
    return as_declared(value) if hasattr(value, "_fields") else value


def make_rules(config: FollowConfig, limit: int, ahead: int) -> Rules:
    """Return the rules of a configuration."""
    world, robot = world_config(config, None), config.robot
    sweeps = round(config.sensors.lidar.rate_hz / config.task.control_hz)
    top = config.task.top_turn_rate
    rules = Rules(
        base=_base(robot, world.physics_dt),
        laser=_laser(config),
        selecting=leader_numbers(config.perception.leader, config.perception.tracker.motion),
        modelled=config.people.source == "modelled",
        tracked=config.people.source == "tracker",
        errors=chosen_errors(config.people.tracker_errors),
        force=world.force.as_array(),
        top=np.array([robot.max_speed, robot.max_speed if robot.holonomic else 0.0, top]),
        weights=config.reward.weights,
        shapes=config.reward.shapes,
        robot_radius=robot.radius,
        lost_limit_s=config.task.lost_limit_s,
        ends_on_contact=bool(config.task.ends_on_contact),
        holonomic=robot.holonomic,
        ticks=whole_ratio("control", 1.0 / config.task.control_hz, TICK),
        substeps=whole_ratio("tick", TICK, world.physics_dt),
        sweeps=sweeps,
        limit=limit,
        ahead=ahead,
    )
    return as_declared(rules)


def _base(robot: RobotConfig, dt: float) -> Base:
    length, width, _ = robot.size
    gains, limits = servo_gains(robot)
    slope = robot.max_acceleration
    return Base(
        half_length=length / 2.0,
        half_width=width / 2.0,
        mass=robot.mass,
        inertia=robot.mass * (length**2 + width**2) / 12.0,
        gains=np.array(gains),
        limits=np.array(limits),
        slopes=np.array([slope, slope, robot.max_turn_acceleration]),
        max_speed=robot.max_speed,
        max_turn_rate=robot.max_turn_rate,
        dt=dt,
    )


def _laser(config: FollowConfig) -> Laser:
    lidar = config.sensors.lidar
    x, y, turn = lidar.mount
    bearings = lidar.bearings + turn
    return Laser(
        cos_bearing=np.cos(bearings),
        sin_bearing=np.sin(bearings),
        first=float(bearings[0]),
        spacing=float(bearings[1] - bearings[0]),
        mount=np.array([x, y]),
        height=lidar.height,
        range_min=lidar.range_min,
        range_max=lidar.range_max,
        near=lidar.near,
        sigma_near=lidar.sigma_near,
        sigma_far=lidar.sigma_far,
        dropout=lidar.dropout,
    )
