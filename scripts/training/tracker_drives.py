"""Drives in which the true people, how they were seen, and what the robot knew of them are written down."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from ...agents import make_follower
from ...envs.follow_env import FollowEnv
from ...envs.tracker_errors.kernel import seen
from ...perception.metrics.clear_mot import ClearMot
from ...slam.geometry import compose, inverse, transform_points

Array = NDArray[np.float64]

SAME_M = 0.75
"""A track within this distance of a person can be theirs [m]."""
UNKNOWN, SEEN, UNSEEN = 0, 1, 2
NOBODY, LEADER = -1, 0


@dataclass(frozen=True, kw_only=True)
class DriveSetting:
    """Where a follower drives: an environment and its arguments."""

    name: str
    env: str
    arguments: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class FalseTrack:
    """A track that is at nobody's place, in one scan.

    Attributes:
        scan: Number of the scan.
        number: Of the track.
        seen: Whether it was seen in the scan.
        person: Row of the nearest person.
        apart: From the nearest person [m].
        speed: As tracked [m/s].
        trust: Its confidence.
    """

    scan: int
    number: int
    seen: bool
    person: int
    apart: float
    speed: float
    trust: float


@dataclass(frozen=True, eq=False)
class TrackedDrive:
    """T scans among n people, who keep their rows; places and velocities in the world.

    Attributes:
        setting: Where it was.
        seed: Of the episode.
        ending: Why it ended.
        dt: Between two scans [s].
        position: (T, n, 2) of the people [m].
        velocity: (T, n, 2) [m/s].
        sight: (T, n, 6) how each is seen, see `tracker_errors.kernel.seen`.
        phase: (T, n) `UNKNOWN`, `SEEN` or `UNSEEN`: tracked all the same, be it farther away than `SAME_M`.
        unseen_s: (T, n) for how long the track was not seen [s].
        number: (T, n) of the track, -1 for none.
        place: (T, n, 2) as tracked [m].
        motion: (T, n, 2) as tracked [m/s].
        trust: (T, n) confidence.
        false: Tracks that are nobody's within `SAME_M`.
        ever: Numbers of the tracks that were somebody's once.
        near_beams: Share of all beams that end within 4 m, in the mean.
        leads: (T,) the person whom the robot sees as its leader, -1 for none or a thing.
        switches: Changes of a person's track from one number to another, by `ClearMot`.
    """

    setting: DriveSetting
    seed: int
    ending: str
    dt: float
    position: Array
    velocity: Array
    sight: Array
    phase: NDArray[np.int64]
    unseen_s: Array
    number: NDArray[np.int64]
    place: Array
    motion: Array
    trust: Array
    false: list[FalseTrack]
    ever: set[int]
    near_beams: float
    leads: NDArray[np.int64]
    switches: int

    @property
    def off(self) -> Array:
        """(T, n) how far tracks are off their people [m]; 0 without one."""
        return np.where(self.phase == UNKNOWN, 0.0, np.hypot(*(self.place - self.position).transpose(2, 0, 1)))


class _Notes:
    """Writes a drive down, scan by scan."""

    def __init__(self, env: FollowEnv) -> None:
        self._env, self._matching = env, ClearMot(radius=SAME_M)
        lidar = env.config.sensors.lidar
        x, y, turn = lidar.mount
        bearings = lidar.bearings
        self._laser = x, y, float(bearings[0]) + turn, float(bearings[1] - bearings[0])
        self._rows: dict[str, list[Any]] = {}
        self.false: list[FalseTrack] = []
        self.ever: set[int] = set()
        self._owner: dict[int, int] = {}

    def add(self) -> None:
        """Write the present scan down."""
        truth, belief = self._env.truth, self._env.belief
        people, where = truth.people, truth.people.positions
        T_world_odom = compose(truth.robot_pose, inverse(belief.odometry))
        tracks = belief.people
        places = transform_points(T_world_odom, tracks.positions)
        motions = transform_points(np.array([0.0, 0.0, T_world_odom[2]]), tracks.velocities)
        everyone, all_tracks = np.ones(len(people), bool), np.ones(len(tracks), bool)
        match = self._matching.add(where, everyone, places, tracks.ids, all_tracks)
        stray = np.setdiff1d(np.arange(len(tracks)), match).tolist()
        self._owner.update({int(tracks.ids[match[i]]): i for i in np.flatnonzero(match >= 0).tolist()})
        self.ever.update(self._owner)
        for j in stray:  # its person's still, as long as it is believed in and nothing was seen elsewhere in its place
            person = self._owner.get(int(tracks.ids[j]), NOBODY)
            if tracks.unseen_s[j] == 0.0:
                self._owner.pop(int(tracks.ids[j]), None)
            elif person != NOBODY and match[person] < 0:
                match[person] = j
        known = match >= 0
        speeds, ranges = np.hypot(*people.velocities.T), belief.scan.ranges
        sights = [seen(p, v, truth.robot_pose, ranges, self._laser) for p, v in zip(where, speeds, strict=True)]
        self._note(
            position=where,
            velocity=people.velocities,
            sight=np.array(sights),
            phase=np.where(known, np.where(_of(tracks.unseen_s, match) > 0.0, UNSEEN, SEEN), UNKNOWN),
            unseen_s=_of(tracks.unseen_s, match),
            number=np.where(known, _of(tracks.ids, match), NOBODY),
            place=_of(places, match),
            motion=_of(motions, match),
            trust=_of(tracks.confidence, match),
            leads=self._leads(where, truth.robot_pose),
            near_beams=float((ranges < 4.0).mean()),
        )
        for j in stray:
            apart = np.hypot(*(where - places[j]).T)
            person = int(apart.argmin())
            seen_now, speed = bool(tracks.unseen_s[j] == 0.0), float(np.hypot(*motions[j]))
            number, trust = int(tracks.ids[j]), float(tracks.confidence[j])
            self.false.append(
                FalseTrack(len(self._rows["leads"]) - 1, number, seen_now, person, float(apart[person]), speed, trust)
            )

    def _note(self, **values: Any) -> None:
        for name, value in values.items():
            self._rows.setdefault(name, []).append(value)

    def _leads(self, where: Array, pose: Array) -> int:
        leader = self._env.belief.leader
        if leader is None or not leader.visible:
            return NOBODY
        apart = np.hypot(*(where - transform_points(pose, leader.position[None])[0]).T)
        return int(apart.argmin()) if apart.min() <= SAME_M else NOBODY

    def drive(self, setting: DriveSetting, seed: int, ending: str) -> TrackedDrive:
        """Return all that was written down."""
        arrays = {name: np.array(values) for name, values in self._rows.items()}
        near = float(arrays.pop("near_beams").mean())
        dt = 1.0 / self._env.config.task.control_hz
        return TrackedDrive(
            setting=setting, seed=seed, ending=ending, dt=dt, false=self.false, ever=self.ever, near_beams=near,
            switches=self._matching.switches, **arrays,
        )  # fmt: skip


def _of(values: NDArray[Any], match: NDArray[np.intp]) -> NDArray[Any]:
    """Return the rows `match` of `values`; zeros where there is none."""
    padded = np.concatenate((values, np.zeros((1, *values.shape[1:]), values.dtype)))
    return padded[match]


def record_drive(setting: DriveSetting, seed: int, steps: int, **known: str) -> TrackedDrive:
    """Let the PID follower drive one episode, and write it down.

    Args:
        setting: Where.
        seed: Of the episode.
        steps: Most control periods.
        known: How people are known, arguments of the environment: `people="tracker"`, `people="modelled"` ...
    """
    given = {**setting.arguments, **known}
    env = gym.make(f"tagalong/{setting.env}-v0", disable_env_checker=True, slam=None, **given)
    inner = env.unwrapped
    assert isinstance(inner, FollowEnv)
    observation, info = env.reset(seed=seed)
    driver, notes = make_follower("pid", inner.interface), _Notes(inner)
    driver.reset()
    notes.add()
    for _ in range(steps):
        observation, _, terminated, truncated, info = env.step(driver.act(observation))
        notes.add()
        if terminated or truncated:
            break
    env.close()
    return notes.drive(setting, seed, info["ending"])


def record_drives(settings: Iterable[DriveSetting], seeds: range, steps: int, **known: str) -> list[TrackedDrive]:
    """Return a drive in each setting for each seed; the rest as of `record_drive`."""
    return [record_drive(setting, seed, steps, **known) for seed in seeds for setting in settings]
