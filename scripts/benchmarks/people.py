"""How well people are tracked and kept out of scans in simulated drives.

example:
  tagalong bench people --scene corridor --seeds 10 --people 4
"""

import argparse
import time
from collections import deque
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...envs.world.truth import TrueState
from ...envs.world.world import World, WorldConfig
from ...perception.config import perception_preset
from ...perception.hindsight import LAG_S, HindsightFilter
from ...perception.leader.selector import LeaderSelector
from ...perception.metrics.clear_mot import ClearMot
from ...perception.people_filter import FilteredScan, near_points, points_lidar
from ...slam.geometry import between, compose, inverse, transform_points, wrap_angle
from ...slam.scan import LaserScan
from ..console.arguments import at_least, positive, random_seed, within
from ..lab.cells import TIMING
from .results import write_results

RANGE = 6.0
LEAST_RETURNS = 3
Array = NDArray[np.float64]


@dataclass(eq=False)
class Shares:
    """Returns kept and removed.

    Attributes:
        people: Returns on walking people within 6 m, and those of them removed.
        tracked: The same, of people who have been tracked for a second or more at that moment.
        known: The same, from one second after a person's first track to the end of the drive, tracked or not.
        static: Returns on all that is no person, and those of them removed.
    """

    people: Array = field(default_factory=lambda: np.zeros(2))
    tracked: Array = field(default_factory=lambda: np.zeros(2))
    known: Array = field(default_factory=lambda: np.zeros(2))
    static: Array = field(default_factory=lambda: np.zeros(2))


class DriveJudge:
    """Judges one drive, scan by scan."""

    def __init__(self) -> None:
        self.walking, self.standing, self.shares = ClearMot(), ClearMot(), Shares()
        self._since: dict[tuple[int, int], float] = {}
        self._first: dict[int, float] = {}

    def add(self, labels: NDArray[np.int32], truth: TrueState, update: FilteredScan) -> None:
        """Take one scan, of which `labels` (N,) say whom each beam meets, or -1."""
        scan = update.scan
        people, centres = update.people, truth.people.positions
        labels = labels[scan.is_return]
        T_world_odom = compose(truth.robot_pose, inverse(update.odometry))
        tracks = transform_points(T_world_odom, people.positions)
        near = np.hypot(*(centres - truth.robot_pose[:2]).T) <= RANGE
        seen = near & (returns_on_a_leg(truth, scan, labels) >= LEAST_RETURNS)
        tracks_near = np.hypot(*(tracks - truth.robot_pose[:2]).T) <= RANGE
        walks = truth.people.walking
        matched = self.walking.add(centres, seen & walks, tracks, people.ids, tracks_near)
        self.standing.add(centres, seen & ~walks, tracks, people.ids, np.zeros(len(tracks), dtype=bool))
        known = self._known(matched, people.ids, truth.time_s)
        self._count_returns(update, labels, walks, *known)

    def _known(
        self, matched: NDArray[np.intp], ids: NDArray[np.int64], time_s: float
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        tracked, known = np.zeros(len(matched), dtype=bool), np.zeros(len(matched), dtype=bool)
        for person, track in enumerate(matched):
            if track >= 0:
                since = self._since.setdefault((person, int(ids[track])), time_s)
                self._first.setdefault(person, time_s)
                tracked[person] = time_s - since >= 1.0
            known[person] = time_s - self._first.get(person, np.inf) >= 1.0
        return tracked, known

    def _count_returns(
        self,
        update: FilteredScan,
        labels: NDArray[np.int32],
        walks: NDArray[np.bool_],
        tracked: NDArray[np.bool_],
        known: NDArray[np.bool_],
    ) -> None:
        scan = update.scan
        points = points_lidar(scan, update.people.points, update.odometry)
        removed = near_points(scan, points, update.config.zeta)[scan.is_return]
        human = labels >= 0
        person = np.where(human, labels, 0)
        walker = human & walks[person] & (scan.ranges[scan.is_return] <= RANGE) if len(walks) else human
        for total, chosen in (
            (self.shares.people, walker),
            (self.shares.tracked, walker & tracked[person] if len(walks) else walker),
            (self.shares.known, walker & known[person] if len(walks) else walker),
            (self.shares.static, ~human),
        ):
            total += (np.count_nonzero(chosen), np.count_nonzero(chosen & removed))


def returns_on_a_leg(truth: TrueState, scan: LaserScan, labels: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return (n,) the returns on that leg of each person that has more of them."""
    points = transform_points(truth.robot_pose, scan.points_robot)
    counts = np.zeros((len(truth.people), 2), dtype=np.int64)
    for person, legs in enumerate(truth.people.legs):
        own = points[labels == person]
        leg = np.hypot(own[:, None, 0] - legs[:, 0], own[:, None, 1] - legs[:, 1]).argmin(axis=1)
        counts[person] = np.bincount(leg, minlength=2)
    return counts.max(axis=1)


def follow_command(truth: TrueState, distance: float = 1.3) -> Array:
    """Return (2,) speeds [m/s, rad/s] that follow the true leader; straight on without one."""
    if truth.leader_index < 0:
        return np.array([0.3, 0.0])
    leader = truth.people.positions[truth.leader_index]
    ahead = between(truth.robot_pose, np.array([*leader, 0.0]))
    bearing = float(wrap_angle(np.arctan2(ahead[1], ahead[0])))
    speed = 1.5 * (float(np.hypot(ahead[0], ahead[1])) - distance) * max(0.0, np.cos(bearing))
    return np.array([np.clip(speed, 0.0, 1.3), np.clip(2.5 * bearing, -1.5, 1.5)])


@dataclass(frozen=True, kw_only=True)
class DriveConfig:
    """A drive, and who looks for people in it.

    Attributes:
        scene: Of the world.
        people: How many, the leader among them.
        preset: Numbers of the tracker.
        forest: Leg forest.
        seconds: Longest drive [s].
        lag_s: How much later people are told of [s].
    """

    scene: str = "corridor"
    people: int = 4
    preset: str = "recorded"
    forest: str = "simulation"
    seconds: float = 120.0
    lag_s: float = 0.0


def judged_drive(drive: DriveConfig, seed: int) -> dict[str, Any]:
    """Run a drive and return its row of the table."""
    world = World(WorldConfig(scene=drive.scene, people=drive.people), np.random.default_rng(seed))
    config, lag_s = replace(perception_preset(drive.preset), forest=drive.forest), drive.lag_s
    people_filter, judge = HindsightFilter(config, lag_s=lag_s), DriveJudge()
    selector = LeaderSelector(config.leader, config.tracker.motion)
    spent, scans, right, chosen, onset_s = 0.0, 0, None, 0.0, 0.0
    seen: deque[tuple[NDArray[np.int32], TrueState]] = deque()

    def judge_all(due: list[FilteredScan]) -> None:
        """Judge the scans that are due."""
        nonlocal right, chosen, onset_s
        for update in due:
            labels, truth = seen.popleft()
            leader = selector.update(update.people, update.odometry)
            judge.add(labels, truth, update)
            if leader is None:
                continue
            place = transform_points(compose(truth.robot_pose, inverse(update.odometry)), leader.position[None])[0]
            on_leader = bool(np.hypot(*(place - truth.people.positions[truth.leader_index])) < 0.6)
            onset_s = truth.time_s if right is None else onset_s
            right = on_leader if right is None or truth.time_s - onset_s < 1.2 else right
            chosen += on_leader

    while world.time_s < drive.seconds and not world.truth.tour_done:
        world.step(follow_command(world.truth))
        scan, scans = world.scan(), scans + 1
        seen.append((world.scan_labels(), world.truth))
        start = time.perf_counter()
        due = people_filter.update(scan, world.odometry)
        spent += time.perf_counter() - start
        judge_all(due)
    judge_all(people_filter.finish())
    timing = {TIMING: {"ms": 1e3 * spent / scans}}
    return {"seed": seed} | _row(judge) | {"leader_right": right, "leader_held": chosen / scans} | timing


def _row(judge: DriveJudge) -> dict[str, Any]:
    walking, shares = judge.walking, judge.shares
    return {
        "mota": walking.mota,
        "misses": walking.misses,
        "false": walking.false,
        "switches": walking.switches,
        "truths": walking.truths,
        "motp": walking.motp,
        "standing_mota": judge.standing.mota,
        "standing_truths": judge.standing.truths,
        "people": shares.people,
        "tracked": shares.tracked,
        "known": shares.known,
        "static": shares.static,
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Return the figures over all drives: sums of counts, not means of ratios."""
    total = {key: sum(row[key] for row in rows) for key in ("misses", "false", "switches", "truths")}
    shares = {key: np.sum([row[key] for row in rows], axis=0) for key in ("people", "tracked", "known", "static")}
    known_leader = [row["leader_right"] for row in rows if row["leader_right"] is not None]
    return {
        "mota": 1.0 - (total["misses"] + total["false"] + total["switches"]) / max(1, total["truths"]),
        **{key: total[key] / max(1, total["truths"]) for key in ("misses", "false", "switches")},
        **{f"removed_{key}": float(value[1] / max(1.0, value[0])) for key, value in shares.items()},
        "leader_right": float(np.mean(known_leader)) if known_leader else float("nan"),
        "leader_held": float(np.mean([row["leader_held"] for row in rows])),
        "ms_per_scan": float(np.mean([row[TIMING]["ms"] for row in rows])),
    }


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--scene", default="corridor")
    parser.add_argument("--seeds", type=at_least(1), default=10)
    parser.add_argument("--first-seed", type=random_seed, default=0)
    parser.add_argument("--people", type=at_least(1), default=4)
    parser.add_argument("--preset", default="recorded")
    parser.add_argument("--forest", default="simulation")
    parser.add_argument("--seconds", type=positive, default=120.0, help="longest drive [s]")
    parser.add_argument(
        "--lag",
        type=within(0.0, 1e3),
        default=0.0,
        help=f"how much later people are told of [s]: 0 as on a robot (default), {LAG_S:g} as in recordings",
    )


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    names = "scene", "people", "preset", "forest", "seconds"
    drive = DriveConfig(**{name: getattr(options, name) for name in names}, lag_s=options.lag)
    rows = []
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        row = judged_drive(drive, seed)
        rows.append(row)
        print(
            f"seed {row['seed']:3d}  MOTA {row['mota']:.3f} (misses {row['misses']}, false {row['false']}, "
            f"switches {row['switches']} of {row['truths']})  standing {row['standing_mota']:.3f} "
            f"of {row['standing_truths']}  leader {row['leader_right']} held {row['leader_held']:.2f}",
            flush=True,
        )
    figures = summary(rows)
    print("  ".join(f"{key} {value:.4f}" for key, value in figures.items()))
    write_results(options, {"figures": figures, "drives": rows})
    return 0
