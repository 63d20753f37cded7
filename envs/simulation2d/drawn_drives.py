"""Drives drawn at random through drawn floors: a laser, a robot's way, its odometry and people who walk about."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from ...slam.geometry import between, compose, part_of
from ...slam.logs.drive import RecordedDrive
from ...slam.scan import LaserScan
from ..robot.odometry import OdometryConfig, WheelOdometry, odometry_quality
from ..scenes.polyline import arc_lengths
from .building_plans import BuildingPlan, draw_plan
from .sweep_kernel import sweep

Array = NDArray[np.float64]

_STEP_S = 0.05  # of the motion; scans come every so many steps [s]
_MOST_SCANS = 2500
_REVISITS = 0.35  # share of the goals that are places of before
_LOOKAHEAD = 0.3  # of the driver along its way [m]
_TURN_RATE = 1.2  # highest [rad/s]
_ROOM = 0.5  # people step aside for the robot so far [m]
_RANGE_MIN = 0.05  # [m]
_SLOWEST_TURN = 4  # steps of the motion in which a spinning laser turns once, at most
_AT_ONCE = 4  # beams of a spinning laser that are measured from one place


@dataclass(frozen=True, kw_only=True)
class OdometryErrors:
    """Errors of an odometry.

    Attributes:
        wheels: Systematic and random errors.
        slip_every: Mean way between two slips [m].
        slip_way: Standard deviation of what a slip adds forward [m].
        slip_turn: Standard deviation of what it adds to the heading [rad].
    """

    wheels: OdometryConfig
    slip_every: float
    slip_way: float
    slip_turn: float


ODOMETRY = {
    "good": OdometryErrors(wheels=odometry_quality("good"), slip_every=math.inf, slip_way=0.0, slip_turn=0.0),
    "typical": OdometryErrors(
        wheels=odometry_quality("typical"), slip_every=100.0, slip_way=0.05, slip_turn=math.radians(2.0)
    ),
    "bad": OdometryErrors(
        wheels=odometry_quality("slipping"), slip_every=30.0, slip_way=0.2, slip_turn=math.radians(6.0)
    ),
}
"""Qualities of an odometry by name."""


@dataclass(frozen=True, kw_only=True)
class Traits:
    """What is drawn of a drive beside its floor.

    Attributes:
        reach: Of the laser [m].
        view_deg: Field of view [deg].
        beams: How many.
        noise: Standard deviation of a range [m].
        missing: Share of beams that give no measurement.
        mount: How far the laser is before the robot's centre [m].
        interval_s: Between two scans [s].
        speed: Of the robot [m/s].
        way: How far it drives, at least [m].
        odometry: Name in `ODOMETRY`.
        people: How many walk about.
    """

    reach: float
    view_deg: float
    beams: int
    noise: float
    missing: float
    mount: float
    interval_s: float
    speed: float
    way: float
    odometry: str
    people: int

    @property
    def bearings(self) -> Array:
        """(beams,) [rad]."""
        view = np.radians(self.view_deg)
        return (np.arange(self.beams) + 0.5) * view / self.beams - 0.5 * view


def draw_traits(rng: Generator) -> Traits:
    """Draw laser, drive, odometry and people."""
    return Traits(
        reach=float(np.exp(rng.uniform(np.log(4.0), np.log(80.0)))),
        view_deg=float(rng.choice([180.0, 240.0, 270.0, 360.0])),
        beams=int(rng.choice([90, 180, 360, 540, 720])),
        noise=float(rng.uniform(0.01, 0.03)),
        missing=float(rng.choice([0.0, 0.02, 0.2])),
        mount=float(rng.choice([0.0, 0.2])),
        interval_s=_STEP_S * round(float(np.exp(rng.uniform(np.log(0.1), np.log(2.0)))) / _STEP_S),
        speed=float(rng.uniform(0.3, 1.2)),
        way=float(rng.uniform(150.0, 400.0)),
        odometry=str(rng.choice(list(ODOMETRY))),
        people=int(rng.integers(0, 7)),
    )


@dataclass(frozen=True, eq=False)
class DrawnDrive:
    """A drive and the truth about it.

    Attributes:
        plan: The floor.
        traits: What else was drawn.
        recording: Odometry, scans, and as reference the true poses T_plan_robot.
    """

    plan: BuildingPlan
    traits: Traits
    recording: RecordedDrive

    @property
    def truth(self) -> Array:
        """(n, 3) T_plan_robot of each scan."""
        assert self.recording.reference is not None
        return self.recording.reference


def draw_drive(kind: str, seed: int, *, spinning: bool = False) -> DrawnDrive:
    """Draw a floor of `kind` and a drive through it; the same to the byte for the same seed.

    Args:
        kind: Of `KINDS`.
        seed: Of all random draws.
        spinning: Whether the laser turns once from scan to scan, at 5 Hz at least, and measures one beam after the
            other; else it measures at once.

    Raises:
        InputError: If there is no such kind.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    plan, traits = draw_plan(kind, rng), draw_traits(rng)
    motion = drive_along(draw_way(plan, traits.way, rng), traits.speed, float(rng.uniform(-np.pi, np.pi)))
    every = round(traits.interval_s / _STEP_S)
    if spinning:
        every = min(every, _SLOWEST_TURN)
        motion = motion[: every * _MOST_SCANS]
    every = max(every, math.ceil(len(motion) / _MOST_SCANS))
    odometry = wheel_odometry(motion, every, ODOMETRY[traits.odometry], rng)
    truth = motion[::every]
    times = np.arange(len(truth), dtype=np.float64) * every * _STEP_S
    legs = draw_feet(plan, truth, times, traits.people, rng)
    walls = plan.outlines.arrays()
    ways = [motion[k : k + every + 1] if spinning else motion[k : k + 1] for k in range(0, len(motion), every)]
    scans = [
        take_scan(walls, way, feet, traits, time, rng)
        for way, feet, time in zip(ways, legs, times.tolist(), strict=True)
    ]
    return DrawnDrive(plan, traits, RecordedDrive(odometry, scans, truth, f"{kind}-{seed}"))


def draw_way(plan: BuildingPlan, least: float, rng: Generator) -> Array:
    """Return (n, 2) a way of at least `least` [m] through places of the floor, some of them more than once [m]."""
    places = plan.planner.places
    visited, pieces, length = [places[rng.integers(len(places))]], list[Array](), 0.0
    while length < least:
        again = rng.random() < _REVISITS and len(visited) > 2
        goal = visited[rng.integers(len(visited) - 1)] if again else places[rng.integers(len(places))]
        leg = plan.planner.way(np.array([visited[-1], goal]))
        if leg is None:
            continue
        visited.append(goal)
        pieces.append(leg.points)
        length += leg.length
    return np.concatenate(pieces)


def drive_along(way: Array, speed: float, heading: float) -> Array:
    """Return (n, 3) poses every `_STEP_S` of a robot that follows `way` (m, 2) and begins at `heading` [rad].

    It steers for a point a little ahead, turns on the spot where that is behind it, and slows down in bends.
    """
    points, ahead = way.tolist(), 0
    x, y = points[0]
    poses = [(x, y, heading)]
    while True:
        while ahead < len(points) - 1 and math.hypot(points[ahead][0] - x, points[ahead][1] - y) < _LOOKAHEAD:
            ahead += 1
        dx, dy = points[ahead][0] - x, points[ahead][1] - y
        if ahead == len(points) - 1 and math.hypot(dx, dy) < _LOOKAHEAD:
            return np.array(poses)
        error = math.remainder(math.atan2(dy, dx) - heading, math.tau)
        turn = min(max(3.0 * error, -_TURN_RATE), _TURN_RATE)
        step = speed * max(0.0, math.cos(error)) ** 3 * _STEP_S
        x, y = x + step * math.cos(heading), y + step * math.sin(heading)
        heading = math.remainder(heading + turn * _STEP_S, math.tau)
        poses.append((x, y, heading))


def take_scan(
    walls: tuple[Array, Array], way: Array, feet: Array, traits: Traits, time_s: float, rng: Generator
) -> LaserScan:
    """Return what the laser of a robot measures among ellipses and segments, and of people's feet.

    Args:
        walls: As of `Outlines.arrays`.
        way: (m, 3) T_plan_robot, evenly in time while the laser turns once; one pose: it measures at once.
        feet: (k, 3) x, y, radius [m].
        traits: Of the laser.
        time_s: Stamp of the scan [s].
        rng: Source of noise and of missing beams.
    """
    ellipses, segments = walls
    legs = np.zeros((len(feet), 7))
    legs[:, :2], legs[:, 2], legs[:, 3] = feet[:, :2], feet[:, 2], feet[:, 2]
    bearings, things = traits.bearings, np.concatenate((ellipses, legs))
    ranges = np.empty(len(bearings))
    for first in range(0, len(bearings), _AT_ONCE if len(way) > 1 else len(bearings)):
        beams = slice(first, first + _AT_ONCE if len(way) > 1 else len(bearings))
        pose = _pose_at(way, float(bearings[beams].mean() - bearings[0]) / (2.0 * np.pi))
        x, y, heading = compose(pose, np.array([traits.mount, 0.0, 0.0])).tolist()
        ranges[beams] = sweep(x, y, heading + bearings[beams], traits.reach, things, segments)
    ranges = np.maximum(ranges + rng.normal(0.0, traits.noise, len(ranges)), _RANGE_MIN)
    ranges[rng.random(len(ranges)) < traits.missing] = np.nan
    return LaserScan(ranges, bearings, _RANGE_MIN, traits.reach, time_s, (traits.mount, 0.0, 0.0))


def _pose_at(way: Array, share: float) -> Array:
    """Return the pose (3,) at a share of the time that a `way` (m, 3) takes."""
    before = min(int(share * (len(way) - 1)), max(len(way) - 2, 0))
    if before + 1 >= len(way):
        return way[before]
    step = between(way[before], way[before + 1])
    return compose(way[before], part_of(step, share * (len(way) - 1) - before))


def wheel_odometry(motion: Array, every: int, errors: OdometryErrors, rng: Generator) -> Array:
    """Return (n, 3) T_odom_robot as the wheels believe it at every so many poses of `motion` (m, 3), from zeros on."""
    wheels = WheelOdometry(errors.wheels, rng, motion[0])
    said, before = [np.zeros(3)], np.zeros(3)
    for k in range(every, len(motion), every):
        now = wheels.update(motion[k - every + 1 : k + 1])
        step = between(before, now)
        if rng.random() < float(np.hypot(step[0], step[1])) / errors.slip_every:
            step = compose(step, rng.normal(0.0, (errors.slip_way, 0.25 * errors.slip_way, errors.slip_turn)))
        said.append(compose(said[-1], step))
        before = now.copy()
    return np.array(said)


def draw_feet(plan: BuildingPlan, truth: Array, times: Array, people: int, rng: Generator) -> Array:
    """Return (n, 2 people, 3) the feet x, y, radius [m] at `times` (n,) [s] of people who walk to and fro.

    They step aside for the robot, which is at `truth` (n, 3) then.
    """
    feet = np.zeros((len(times), 2 * people, 3))
    for k in range(people):
        way = draw_way(plan, float(rng.uniform(10.0, 40.0)), rng)
        arcs, pace, radius = arc_lengths(way), rng.uniform(0.4, 1.4), rng.uniform(0.05, 0.08)
        along = np.abs((pace * times + rng.uniform(0.0, arcs[-1])) % (2.0 * arcs[-1]) - arcs[-1])
        places = _at(way, arcs, along)
        towards = _at(way, arcs, along + 0.2) - _at(way, arcs, along - 0.2)
        towards /= np.maximum(np.hypot(*towards.T), 1e-9)[:, None]
        away = places - truth[:, :2]
        distance = np.maximum(np.hypot(*away.T), 1e-9)[:, None]
        places = places + away / distance * np.maximum(_ROOM - distance, 0.0)
        swing = 0.25 * np.sin(2.0 * np.pi * along / 1.3)[:, None]
        aside = 0.12 * np.stack((-towards[:, 1], towards[:, 0]), axis=-1)
        for side, sign in enumerate((-1.0, 1.0)):
            feet[:, 2 * k + side, :2] = places + sign * (aside + swing * towards)
            feet[:, 2 * k + side, 2] = radius
    return feet


def _at(way: Array, arcs: Array, along: Array) -> Array:
    return np.stack([np.interp(along, arcs, axis) for axis in way.T], axis=-1)
