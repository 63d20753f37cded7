"""People in recorded scans: who is found, who is none, and whose number changes, recording by recording.

DATA holds .npz recordings in the layout of the leg_tracker ones. What is chosen by data is chosen without the
recording that it is tried on: forests for positive_1 to 3 and for each third of negative_2 are trained without it
(`--forest left-out`; a few minutes), all others never saw theirs. The tracker's numbers are its preset's. A recording
without odometry gets that of its scans (scan matching), as any user's would; with `--odometry scans` all do.
`lag`: how much later people are told of [s], 0 as on a robot, a second as in what is made of recordings (`filter`,
`perceive`, `slam --filter-people`).

`found`: annotated people, or labelled legs, with somebody tracked within 0.75 m. `extra`: people farther than that from
all annotated ones, a scan with annotations; annotations leave out people, so not all of them are wrong. `walked`: those
of them that walk more than a metre while they are tracked. `known`: those that an annotation meets in another scan: a
person surely, whom nobody annotated in this one. `switches`: changes of number. `people`: tracked a scan;
where nobody is, all are false.

A second table tells of labelled legs within 5 m: the share found by a cluster within 0.2 m, at so many false legs a
scan of the people-free recording. A tracker that knows where something has stood still tells its detector.

example:
  tagalong bench people-recorded recordings
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...perception.config import PRESETS, PerceptionConfig, perception_preset
from ...perception.hindsight import LAG_S, HindsightFilter
from ...perception.legs.detector import Detections, LegDetector
from ...perception.legs.forest import LegForest
from ...perception.tracking.data_association import assign, distances
from ...slam.errors import InputError
from ...slam.geometry import compose, inverse, transform_points
from ...slam.logs.scans_npz import read_scans_npz
from ...slam.scan import LaserScan
from ...slam.scan_to_scan.laser_odometry import laser_odometry
from ..console.arguments import at_least, within
from ..console.tables import format_table
from ..training.evaluate_legs import FARTHEST_LEG, MATCH_DISTANCE, RATES, LegScores
from ..training.leg_forests import left_out_forests
from ..training.leg_recordings import NEGATIVE, read_leg_recordings
from ..training.train_legs import TrainConfig
from .results import write_results

RADIUS = 0.75
WALKED = 1.0
HEADER = ("recording", "preset", "lag", "truths", "found", "extra", "walked", "known", "switches", "people", "numbers")
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PeopleRecording:
    """Recorded scans, the laser's way, and who was annotated.

    Attributes:
        name: Of the file.
        scans: In order; the laser is the robot.
        poses: (n, 3) T_odom_laser of each.
        truths: Scan -> numbers (k,) and places (k, 2) in the laser frame; the number -1 says that it is not known.
        has_legs: Whether these are single legs.
    """

    name: str
    scans: list[LaserScan]
    poses: Array
    truths: Mapping[int, tuple[NDArray[np.int64], Array]]
    has_legs: bool = False


@dataclass(eq=False)
class Judge:
    """Counts over the scans of one recording."""

    truths: int = 0
    found: int = 0
    annotated: int = 0
    switches: int = 0
    people: int = 0
    scans: int = 0
    extra: list[int] = field(default_factory=list)
    met: set[int] = field(default_factory=set)
    legs: list[float] = field(default_factory=list)
    clusters: list[Array] = field(default_factory=list)
    _partner: dict[int, int] = field(default_factory=dict)
    _ways: dict[int, list[Array]] = field(default_factory=dict)

    def add(self, ids: NDArray[np.int64], places: Array, in_odom: Array, truth: Any) -> None:
        """Take one scan: people `ids` (n,) at `places` (n, 2), laser frame, and `in_odom` (n, 2), and who is there."""
        self.scans += 1
        self.people += len(ids)
        for number, place in zip(ids.tolist(), in_odom, strict=True):
            self._ways.setdefault(number, []).append(place)
        if truth is None:
            return
        numbers, there = truth
        apart = distances(there, places)
        self.annotated += 1
        self.truths += len(there)
        self.found += int((apart.min(axis=1, initial=np.inf) < RADIUS).sum())
        self.met.update(ids[apart.min(axis=0, initial=np.inf) < RADIUS].tolist())
        self.extra += ids[apart.min(axis=0, initial=np.inf) >= RADIUS].tolist()
        for person, track in zip(*assign(apart, RADIUS), strict=True):
            known, now = int(numbers[person]), int(ids[track])
            if known >= 0:
                self.switches += int(self._partner.get(known, now) != now)
                self._partner[known] = now

    def add_legs(self, found: Detections, legs: Array) -> None:
        """Take the clusters of one scan and the labelled `legs` (n, 2) in it, robot frame."""
        self.clusters.append(found.confidence)
        for leg in legs[np.hypot(*legs.T) <= FARTHEST_LEG]:
            near = np.hypot(*(found.positions - leg).T) <= MATCH_DISTANCE
            self.legs.append(float(found.confidence[near].max(initial=0.0)))

    def figures(self) -> dict[str, float]:
        """Return the figures named in the module's docstring."""
        walked = {number for number, way in self._ways.items() if np.ptp(way, axis=0).max() >= WALKED}
        annotated, nan = max(1, self.annotated), float("nan")
        return {
            "truths": self.truths,
            "found": self.found / self.truths if self.truths else nan,
            "extra": len(self.extra) / annotated if self.truths else nan,
            "walked": sum(number in walked for number in self.extra) / annotated if self.truths else nan,
            "known": sum(number in self.met for number in self.extra) / annotated if self.truths else nan,
            "switches": self.switches,
            "people": self.people / max(1, self.scans),
            "numbers": len(self._ways),
        }


def read_people_recording(path: Path, odometry_of: str = "recording") -> PeopleRecording:
    """Read a recording: `ranges`, ..., and `gt_xy`, `gt_id`, `gt_scan_index`, `odom_t_x_y_theta` where it has them.

    Args:
        path: The file.
        odometry_of: "recording", where it has any, or "scans", as if it had none.

    Raises:
        InputError: If the file is missing or has another layout.
    """
    scans = read_scans_npz(path)
    truths: dict[int, tuple[NDArray[np.int64], Array]] = {}
    with np.load(path, allow_pickle=False) as content:
        if odometry_of == "recording" and "odom_t_x_y_theta" in content:
            odometry, mounts = content["odom_t_x_y_theta"], content["tf_base_link__left_laser"]
            columns = odometry[:, 1], odometry[:, 2], np.unwrap(odometry[:, 3])
            robot = np.stack([np.interp(content["stamp"], odometry[:, 0], column) for column in columns], axis=1)
            poses = np.array([compose(pose, mounts[0, 1:]) for pose in robot])
        else:
            poses = laser_odometry(scans).poses
        if "gt_xy" in content:
            rows = content["gt_scan_index"]
            truths = {int(k): (content["gt_id"][rows == k], content["gt_xy"][rows == k]) for k in np.unique(rows)}
    labelled = path.with_name(path.name.replace("_scans", "_labelled"))
    has_legs = not truths and labelled != path and labelled.exists()
    if has_legs:
        truths = _labelled_legs(labelled, scans)
    return PeopleRecording(path.stem, scans, poses, truths, has_legs)


def _labelled_legs(path: Path, scans: list[LaserScan]) -> dict[int, tuple[NDArray[np.int64], Array]]:
    with np.load(path, allow_pickle=False) as content:
        ranges, legs, rows = content["ranges"], content["leg_xy"], content["leg_scan_index"]
    number = {scan.ranges.astype(np.float32).tobytes(): k for k, scan in enumerate(scans)}
    where = [number.get(row.tobytes()) for row in ranges]
    places = [legs[rows == k] for k in range(len(ranges))]
    return {k: (np.full(len(p), -1), p) for k, p in zip(where, places, strict=True) if k is not None and len(p)}


def judge_recording(
    recording: PeopleRecording, config: PerceptionConfig, forests: list[LegForest], lag_s: float = 0.0
) -> Judge:
    """Return the judge of one recording, whose n-th part has the n-th of `forests`; the tracker is one for all.

    People are told of `lag_s` later.
    """
    parts = np.array_split(np.arange(len(recording.scans)), len(forests))
    detector = LegDetector(forests[0], config.detector)
    people_filter, judge = HindsightFilter(config, detector, lag_s), Judge()

    def drive() -> Iterator[tuple[LaserScan, Array]]:
        for forest, part in zip(forests, parts, strict=True):
            detector.forest = forest
            yield from ((recording.scans[k], recording.poses[k]) for k in part.tolist())

    for k, update in enumerate(people_filter.over(drive())):
        people = update.people
        places = transform_points(inverse(recording.poses[k]), people.positions)
        judge.add(people.ids, places, people.positions, recording.truths.get(k))
        legs = recording.truths[k][1] if recording.has_legs and k in recording.truths else np.empty((0, 2))
        judge.add_legs(update.detections, legs)
    return judge


def leg_scores(judges: Mapping[str, Judge]) -> dict[str, float]:
    """Return the recall of the labelled legs of all recordings, by the rate of false legs on the people-free one."""
    free = judges.get(Path(NEGATIVE).stem)
    legs = np.array([confidence for judge in judges.values() for confidence in judge.legs])
    if free is None or len(legs) == 0:
        return {}
    scores = LegScores(legs, np.concatenate(free.clusters), free.scans)
    return {f"{rate:g}": scores.recall(rate) for rate in RATES}


def forests_for(folder: Path, names: list[str], left_out: bool, scans: int) -> dict[str, list[LegForest]]:
    """Return the forests of each recording, those of its parts in order."""
    forests = {name: [LegForest.load("real")] for name in names}
    if left_out:
        positive, people_free = read_leg_recordings(folder)
        folds = left_out_forests(TrainConfig(scans=scans), 0, positive, people_free.scans)
        for forest, recording, _ in folds:
            forests[recording.name.replace("labelled", "scans")] = [forest]
        forests[Path(NEGATIVE).stem] = [forest for forest, *_ in folds]
    return forests


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("data", type=Path, metavar="DATA", help="folder of recordings (.npz)")
    parser.add_argument("--preset", choices=list(PRESETS), help="parameters of the tracker (default: all)")
    parser.add_argument(
        "--lag",
        type=within(0.0, 1e3),
        nargs="+",
        default=[0.0, LAG_S],
        metavar="S",
        help=f"how much later people are told of (default: 0 and {LAG_S:g})",
    )
    parser.add_argument(
        "--forest", choices=("left-out", "shipped"), default="left-out", help="who tells legs (default: %(default)s)"
    )
    parser.add_argument(
        "--odometry",
        choices=("recording", "scans"),
        default="recording",
        help="the recording's own, or made of its scans (default: %(default)s, where it has any)",
    )
    parser.add_argument(
        "--scans",
        type=at_least(1),
        default=TrainConfig().scans,
        metavar="N",
        help="simulated scans of each forest",
    )


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    paths = sorted(path for path in options.data.glob("*.npz") if "labelled" not in path.name)
    if not paths:
        raise InputError(f"no recordings (.npz) in {options.data}")
    forests = forests_for(options.data, [path.stem for path in paths], options.forest == "left-out", options.scans)
    rows, presets = [], [options.preset] if options.preset else list(PRESETS)
    judges: dict[str, dict[str, Judge]] = {preset: {} for preset in presets}
    for path in paths:
        recording = read_people_recording(path, options.odometry)
        for preset in presets:
            config = replace(perception_preset(preset), forest="real")
            for lag_s in options.lag:
                judge = judge_recording(recording, config, forests[recording.name], lag_s)
                judges[preset][recording.name] = judge
                rows.append({"recording": recording.name, "preset": preset, "lag": lag_s, **judge.figures()})
    legs = {preset: scores for preset in presets if (scores := leg_scores(judges[preset]))}
    _show(rows, legs)
    write_results(options, {"figures": rows, "legs": legs})
    return 0


def _show(rows: Sequence[Mapping[str, object]], legs: Mapping[str, Mapping[str, float]]) -> None:
    """Print the figures of each recording, then those of legs."""
    shown = [[f"{row[key]:.3f}" if isinstance(row[key], float) else str(row[key]) for key in HEADER] for row in rows]
    print(format_table(HEADER, shown))
    if legs:
        header = ("preset", *(f"legs at {rate:g}" for rate in RATES))
        print("\n" + format_table(header, [[p, *(f"{share:.3f}" for share in legs[p].values())] for p in legs]))
