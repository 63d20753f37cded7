"""All that changes in many worlds, as arrays over them."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...perception.leader.selection import LEADER, Company
from ...slam.view_kernel import inner_view_kernel
from ..people.behaviours.mind import NUMBERS
from ..people.movement.bodies import Bodies, Start, standing_bodies
from ..task.interface import LEADER_COLUMNS, PERSON_COLUMNS
from ..task.rewards import FOLLOWING_TERMS
from ..tracker_errors.kernel import COLUMNS, rows_for
from .driving import MOST_CONTACTS

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
        bodies: Of n people, each array with an axis over worlds before the others.
        numbers: (w, n, NUMBERS) what people remember, see `Minds`.
        open: (w, d) how far each door is open, from 0 to 1.
        pose: (w, 3) T_world_robot, its angle not wrapped.
        speed: (w, 3) of the robot in the world [m/s, m/s, rad/s].
        setpoint: (w, 3) of its servos.
        action: (w, 3) the last one, in [-1, 1].
        change: (w,) norm of its change.
        progress: (w, 1) way along the route [m].
        odometry: (w, 3) T_odom_robot.
        odometry_before: (w, 3) one control period ago.
        rolled: (w, 3) the true pose at the last odometry.
        touches: (w, 2) whether the robot touched a person, and a thing, in the last period.
        leader: (w,) of `LEADER`, whom each robot follows.
        tracks: (w, 2 n + 1, COLUMNS) what a tracker that errs knows, see `tracker_errors.kernel`.
        lost_s: (w,) for how long the leader has not been followed [s].
    """

    slot: Ints
    seed: NDArray[np.uint64]
    episode: Ints
    random: NDArray[np.uint64]
    steps: Ints
    ended: Flags
    bodies: Bodies
    numbers: Array
    open: Array
    pose: Array
    speed: Array
    setpoint: Array
    action: Array
    change: Array
    progress: Array
    odometry: Array
    odometry_before: Array
    rolled: Array
    touches: Flags
    leader: NDArray[Any]
    tracks: Array
    lost_s: Array


_OF_WORLDS: dict[str, tuple[tuple[int, ...], Any]] = {
    "slot": ((), np.int64), "seed": ((), np.uint64), "episode": ((), np.int64), "random": ((1,), np.uint64),
    "steps": ((), np.int64), "ended": ((), np.bool_), "pose": ((3,), float), "speed": ((3,), float),
    "setpoint": ((3,), float), "action": ((3,), float), "change": ((), float),
    "progress": ((1,), float), "odometry": ((3,), float),
    "odometry_before": ((3,), float), "rolled": ((3,), float), "touches": ((2,), np.bool_), "leader": ((), LEADER),
    "lost_s": ((), float),
}  # fmt: skip


def state_with_room(worlds: int, people: int, doors: int, old: WorldsState | None = None) -> WorldsState:
    """Return the state of `worlds` with room for so many people and doors; what `old` holds is kept."""
    somebody = standing_bodies([Start(0.0, 0.0, 0.0)], np.zeros(1))
    bodies: dict[str, NDArray[Any]] = {
        name: np.zeros((worlds, people, *array.shape[1:]), array.dtype) for name, array in somebody._asdict().items()
    }
    of_worlds: dict[str, NDArray[Any]] = {
        name: np.zeros((worlds, *shape), kind) for name, (shape, kind) in _OF_WORLDS.items()
    }
    new = WorldsState(
        **of_worlds,
        bodies=Bodies(**bodies),
        numbers=np.zeros((worlds, people, NUMBERS)),
        open=np.zeros((worlds, doors)),
        tracks=np.zeros((worlds, rows_for(people), COLUMNS)),
    )
    if old is not None:
        for array, before in zip(arrays_of(new), arrays_of(old), strict=True):
            array[tuple(slice(size) for size in before.shape)] = before
    return new


def arrays_of(values: Any) -> list[NDArray[Any]]:
    """Return all arrays of a NamedTuple, and of those that it holds."""
    return [values] if isinstance(values, np.ndarray) else [array for value in values for array in arrays_of(value)]


@inner_view_kernel
def bodies_of(bodies: Bodies, w: int, n: int) -> Bodies:
    """Return the first `n` people of world w."""
    b = bodies
    return Bodies(
        b.position[w, :n], b.velocity[w, :n], b.heading[w, :n], b.feet[w, :n], b.origin[w, :n], b.lift[w, :n],
        b.phase[w, :n], b.swing[w, :n], b.legs[w, :n], b.arc[w, :n], b.sense[w, :n], b.lateral[w, :n], b.wish[w, :n],
        b.face[w, :n], b.goal[w, :n], b.direction[w, :n],
    )  # fmt: skip


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
        facts: (w, 4) distance and bearing of the true leader [m, rad], free space to the others [m], and by how much
            the action changed, see `rewards.following_terms`.
        touched: (w,) whether the robot touches somebody or something.
        done: (w,) whether the tour is over.
        following: (w,) whether the robot follows its leader.
        lost_s: (w,) for how long it has not [s].
        track: (w,) identity of the leader, -1 for none.
        ranges: (w, beams) the sweep as measured [m], for a tracker outside of the kernels; (w, 0) without one.
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
    facts: Array
    touched: Flags
    done: Flags
    following: Flags
    lost_s: Array
    track: Ints
    ranges: Array


def nothing_told(worlds: int, beams: int, slots: int, speeds: int, read: bool = False) -> Told:
    """Return arrays to write into; where sweeps are `read` by a tracker, these, too."""
    row, flat = np.zeros, np.float32
    return Told(
        row((worlds, beams), flat), row((worlds, len(LEADER_COLUMNS)), flat),
        row((worlds, slots, len(PERSON_COLUMNS)), flat), row((worlds, speeds), flat),
        row((worlds, len(FOLLOWING_TERMS))), row(worlds), row(worlds, bool), row(worlds, bool),
        row(worlds, np.int64), row(worlds), row(worlds, np.int64), row((worlds, 3)), row((worlds, 3)), row((worlds, 4)),
        row(worlds, bool), row(worlds, bool), row(worlds, bool), row(worlds), row(worlds, np.int64),
        row((worlds, beams if read else 0)),
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
        company: Of 2 n + 1 people, whom the robot knows.
        others: (2 n + 1,) who of them does not lead.
        before: (n, 2) where people were before a tick [m].
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
    company: Company
    others: Flags
    before: Array


def scratch(ticks: int, beams: int, people: int) -> Scratch:
    """Return room for one thread."""
    row, rows = np.zeros, rows_for(people)
    return Scratch(
        row((ticks, 3)), row((ticks, 3)), row((3, beams)), row((2, 6)), row((MOST_CONTACTS, 5)),
        row((MOST_CONTACTS, 2)), row(8), row((1, 2)), row(3),
        Company(row(rows, np.int64), row((rows, 4)), row(rows), row(rows), row(rows)), row(rows, bool),
        row((people, 2)),
    )  # fmt: skip


@inner_view_kernel
def first_of(company: Company, count: int) -> Company:
    """Return the first so many of a company."""
    c = company
    return Company(c.ids[:count], c.x[:count], c.confidence[:count], c.unseen_s[:count], c.age_s[:count])
