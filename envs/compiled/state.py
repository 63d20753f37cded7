"""All that changes in many worlds, as arrays over them."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..people.behaviours.mind import NUMBERS
from ..task.interface import LEADER_COLUMNS, PERSON_COLUMNS
from ..task.rewards import FOLLOWING_TERMS
from .driving import MOST_CONTACTS
from .leading import MEMORY

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float32]


class WorldsState(NamedTuple):
    """What changes in w worlds of up to n people and d doors; kernels read and write it.

    Attributes:
        slot: (w,) row of `Plans` that each world plays.
        seed: (w,) of each world.
        episode: (w,) number of its episode.
        random: (w, 1) state of its random numbers.
        steps: (w,) control periods of the episode.
        ended: (w,) whether the episode is over.
        position: (w, n, 2) bodies and their feet, as the next fifteen: see `Bodies`.
        velocity: (w, n, 2).
        heading: (w, n).
        feet: (w, n, 2, 2).
        origin: (w, n, 2).
        lift: (w, n, 2).
        phase: (w, n).
        swing: (w, n).
        arc: (w, n).
        sense: (w, n).
        lateral: (w, n).
        wish: (w, n).
        face: (w, n).
        goal: (w, n, 2).
        direction: (w, n, 2).
        numbers: (w, n, NUMBERS) what people remember, see `Minds`.
        open: (w, d) how far each door is open, from 0 to 1.
        pose: (w, 3) T_world_robot, its angle not wrapped.
        speed: (w, 3) of the robot in the world [m/s, m/s, rad/s].
        setpoint: (w, 3) of its servos.
        action: (w, 3) the last one, in [-1, 1].
        progress: (w, 1) way along the route [m].
        odometry: (w, 3) T_odom_robot.
        odometry_before: (w, 3) one control period ago.
        rolled: (w, 3) the true pose at the last odometry.
        touches: (w, 2) whether the robot touched a person, and a thing, in the last period.
        track: (w,) row of the person taken for the leader, -1 for none.
        memory: (w, MEMORY) of the choice of the leader, as the next three: see `leading.select`.
        estimate: (w, 4).
        covariance: (w, 3).
        duplicate: (w, n).
        lost_s: (w,) for how long the leader has not been followed [s].
    """

    slot: Ints
    seed: NDArray[np.uint64]
    episode: Ints
    random: NDArray[np.uint64]
    steps: Ints
    ended: Flags
    position: Array
    velocity: Array
    heading: Array
    feet: Array
    origin: Array
    lift: Array
    phase: Array
    swing: Ints
    arc: Array
    sense: Array
    lateral: Array
    wish: Array
    face: Array
    goal: Array
    direction: Array
    numbers: Array
    open: Array
    pose: Array
    speed: Array
    setpoint: Array
    action: Array
    progress: Array
    odometry: Array
    odometry_before: Array
    rolled: Array
    touches: Flags
    track: Ints
    memory: Array
    estimate: Array
    covariance: Array
    duplicate: Flags
    lost_s: Array


_OF_WORLDS: dict[str, tuple[tuple[int, ...], Any]] = {
    "slot": ((), np.int64), "seed": ((), np.uint64), "episode": ((), np.int64), "random": ((1,), np.uint64),
    "steps": ((), np.int64), "ended": ((), np.bool_), "pose": ((3,), float), "speed": ((3,), float),
    "setpoint": ((3,), float), "action": ((3,), float), "progress": ((1,), float), "odometry": ((3,), float),
    "odometry_before": ((3,), float), "rolled": ((3,), float), "touches": ((2,), np.bool_), "track": ((), np.int64),
    "memory": ((MEMORY,), float), "estimate": ((4,), float), "covariance": ((3,), float), "lost_s": ((), float),
}  # fmt: skip
_OF_PEOPLE: dict[str, tuple[tuple[int, ...], Any]] = {
    "position": ((2,), float), "velocity": ((2,), float), "heading": ((), float), "feet": ((2, 2), float),
    "origin": ((2,), float), "lift": ((2,), float), "phase": ((), float), "swing": ((), np.int64), "arc": ((), float),
    "sense": ((), float), "lateral": ((), float), "wish": ((), float), "face": ((), float), "goal": ((2,), float),
    "direction": ((2,), float), "numbers": ((NUMBERS,), float), "duplicate": ((), np.bool_),
}  # fmt: skip


def state_with_room(worlds: int, people: int, doors: int, old: WorldsState | None = None) -> WorldsState:
    """Return the state of `worlds` with room for so many people and doors; what `old` holds is kept."""
    arrays: dict[str, NDArray[Any]] = {
        name: np.zeros((worlds, *shape), kind) for name, (shape, kind) in _OF_WORLDS.items()
    }
    for name, (shape, kind) in _OF_PEOPLE.items():
        arrays[name] = np.zeros((worlds, people, *shape), kind)
    arrays["open"] = np.zeros((worlds, doors))
    if old is not None:
        for name, before in old._asdict().items():
            arrays[name][tuple(slice(size) for size in before.shape)] = before
    return WorldsState(**arrays)


class Told(NamedTuple):
    """What is told of w worlds after a step: observations, rewards, endings and infos; kernels write it.

    Attributes:
        scan: (w, beams).
        leader: (w, 6).
        people: (w, slots, 6).
        velocity: (w, 2) or (w, 3).
        terms: (w, 7) of the reward, in the order of `FOLLOWING_TERMS`.
        reward: (w,).
        terminated: (w,).
        truncated: (w,).
        ending: (w,) number in `task.endings.REASONS`.
        time_s: (w,) [s].
        tracked: (w,) how many people the robot knows.
        odometry: (w, 3).
        robot_pose: (w, 3).
        distance: (w,) from the true leader [m].
        following: (w,) whether the robot follows its leader.
        lost_s: (w,) for how long it has not [s].
        track: (w,) identity of the leader, -1 for none.
    """

    scan: Floats
    leader: Floats
    people: Floats
    velocity: Floats
    terms: Array
    reward: Array
    terminated: Flags
    truncated: Flags
    ending: Ints
    time_s: Array
    tracked: Ints
    odometry: Array
    robot_pose: Array
    distance: Array
    following: Flags
    lost_s: Array
    track: Ints


def nothing_told(worlds: int, beams: int, slots: int, speeds: int) -> Told:
    """Return arrays to write into."""
    row, flat = np.zeros, np.float32
    return Told(
        row((worlds, beams), flat), row((worlds, len(LEADER_COLUMNS)), flat),
        row((worlds, slots, len(PERSON_COLUMNS)), flat), row((worlds, speeds), flat),
        row((worlds, len(FOLLOWING_TERMS))), row(worlds), row(worlds, bool), row(worlds, bool),
        row(worlds, np.int64), row(worlds), row(worlds, np.int64), row((worlds, 3)), row((worlds, 3)), row(worlds),
        row(worlds, bool), row(worlds), row(worlds, np.int64),
    )  # fmt: skip


class Scratch(NamedTuple):
    """Room to work in, one for each thread; nothing in it lasts.

    Attributes:
        poses: (ticks, 3) of the robot in one control period.
        noise: (ticks, 3).
        beams: (3, n) of one sweep, see `beams.cast_faces`.
        ellipse: (2, 6) legs of one person in the laser's plane.
        contacts: (MOST_CONTACTS, 5) see `driving.drive`.
        work: (MOST_CONTACTS, 2).
        robot: (8,) as in `walking.advance_bodies`.
        place: (1, 2) of the robot [m].
        wanted: (3,) command.
        known: (n,) which people the robot knows.
        apart: (n,) their distances from it [m].
        places: (n, 2) where they are, odometry frame [m].
        motions: (n, 2) how they move in it [m/s].
        before: (n, 2) where people were before a tick [m].
        truth: (4,) of `rewards.following_terms`.
    """

    poses: Array
    noise: Array
    beams: Array
    ellipse: Array
    contacts: Array
    work: Array
    robot: Array
    place: Array
    wanted: Array
    known: Flags
    apart: Array
    places: Array
    motions: Array
    before: Array
    truth: Array


def scratch(ticks: int, beams: int, people: int) -> Scratch:
    """Return room for one thread."""
    row = np.zeros
    return Scratch(
        row((ticks, 3)), row((ticks, 3)), row((3, beams)), row((2, 6)), row((MOST_CONTACTS, 5)),
        row((MOST_CONTACTS, 2)), row(8), row((1, 2)), row(3), row(people, bool), row(people), row((people, 2)),
        row((people, 2)), row((people, 2)), row(4),
    )  # fmt: skip
