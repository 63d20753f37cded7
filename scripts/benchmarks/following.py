"""How long a followed person is held in a recorded drive with clicked positions and no odometry.

A scan counts where the person was clicked. `held`: the leader, chosen once and looked for unaided, is within 0.75 m.
`one_number`: so is the person with that number which was nearest in the first 3 s after anybody was tracked; the leader
keeps its own. `anybody`: so is anybody. `switches`: changes of the track that is the leader. `false`: people farther
off, a scan.

example:
  tagalong bench following person_following_outdoor_1.npz --preset recorded
"""

import argparse
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...perception.config import PRESETS, perception_preset
from ...perception.leader.estimate import LeaderEstimate
from ...perception.leader.selector import LeaderSelector, numbered_by_leader
from ...perception.people_filter import PeopleFilter
from ...perception.tracking.people import People
from ...slam.errors import InputError
from ...slam.logs.scans_npz import read_scans_npz
from .results import write_results

RADIUS = 0.75
CHOICE_S = 3.0
Array = NDArray[np.float64]


@dataclass(eq=False)
class FollowingJudge:
    """Counts over the scans with a clicked position."""

    scans: int = 0
    held: int = 0
    anybody: int = 0
    false: int = 0
    switches: int = 0
    nearest: list[int] = field(default_factory=list)
    _track: int = -1
    _first_s: float = np.inf
    _near: list[NDArray[np.int64]] = field(default_factory=list)

    def add(self, clicked: Array, people: People, leader: LeaderEstimate | None) -> None:
        """Take one scan where the person was `clicked` (2,)."""
        apart = np.hypot(people.positions[:, 0] - clicked[0], people.positions[:, 1] - clicked[1])
        self.scans += 1
        self.anybody += int(apart.min(initial=np.inf) < RADIUS)
        self.false += int(np.count_nonzero(apart >= RADIUS))
        self._near.append(people.ids[apart < RADIUS])
        if len(people):
            self._first_s = min(self._first_s, people.time_s)
            if people.time_s - self._first_s <= CHOICE_S:
                self.nearest.append(int(people.ids[apart.argmin()]))
        if leader is not None and leader.track_id >= 0 and float(np.hypot(*(leader.position - clicked))) < RADIUS:
            self.held += 1
            self.switches += int(self._track not in (-1, leader.track_id))
            self._track = leader.track_id

    def figures(self) -> dict[str, float]:
        """Return the shares and counts named in the module's docstring."""
        count = max(1, self.scans)
        chosen = max(set(self.nearest), key=self.nearest.count, default=-1)
        return {
            "scans": float(self.scans),
            "held": self.held / count,
            "one_number": sum(chosen in near for near in self._near) / count,
            "anybody": self.anybody / count,
            "switches": float(self.switches),
            "false": self.false / count,
        }


def judge_following(path: Path, preset: str, forest: str) -> dict[str, float]:
    """Return the figures of one recording.

    Raises:
        InputError: If the file has no `gt_xy` (n, 2) with `gt_scan_index` (n,).
    """
    scans = read_scans_npz(path)
    with np.load(path, allow_pickle=False) as content:
        if "gt_xy" not in content or "gt_scan_index" not in content:
            raise InputError(f"{path}: needs clicked positions, the arrays gt_xy and gt_scan_index")
        clicked = dict(zip(content["gt_scan_index"].tolist(), content["gt_xy"], strict=True))
    config = replace(perception_preset(preset), forest=forest)
    people_filter, selector = PeopleFilter(config), LeaderSelector(config.leader, config.tracker.motion)
    judge, origin = FollowingJudge(), np.zeros(3)
    for number, scan in enumerate(scans):
        people = people_filter.update(scan, origin).people
        leader = selector.update(people, origin)
        if number in clicked:
            judge.add(clicked[number], numbered_by_leader(people, leader), leader)
    return judge.figures()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("scans", type=Path, metavar="FILE", help="a recording with clicked positions (.npz)")
    parser.add_argument("--preset", choices=list(PRESETS), help="parameters of the tracker (default: all)")
    parser.add_argument("--forest", default="real", help="who tells legs (default: %(default)s)")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    rows = {}
    for preset in [options.preset] if options.preset else PRESETS:
        figures = rows[preset] = judge_following(options.scans, preset, options.forest)
        print(f"{preset:8s}", "  ".join(f"{key} {value:.4f}" for key, value in figures.items()), flush=True)
    write_results(options, {"figures": rows})
    return 0
