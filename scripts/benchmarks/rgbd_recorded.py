"""Floor, table tops and people in recorded, labelled RGB-D frames, by source.

FOLDER holds frames (`perception/rgbd/pictures.py` says how); each NAME.json also says `camera_height_m`,
`pitch_deg_nose_down`, `roll_deg_left_up` (null where there is too little floor), `floor_visible`,
`table_top_visible`, `people` and `people_boxes_xyxy`. The source of a frame is its name up to the first "_".

The floor counts within 5 m: points within 2 cm + 0.4 % of depth squared of the reference plane are of the floor, those
more than twice as far from it are not, and those between count for nothing. It is recognised where it is called seen
and its tilt is within 5 degrees and its height within 0.15 m of the reference. The reference has errors of its own: how
far the floor's points lie from the plane that was found, and from the reference, is told, too. A table top is found
where a plane is called one between 0.5 and 1.1 m. Somebody is found by one detection most of whose pixels lie in the
box. A detection of nobody counts as false within 5 m, and as far beyond.

The shipped classifier was trained with frames of some of these sources; --left-out takes, for each source, the one that
was trained without it.

On 28 frames of seven sources, nothing being told of the camera and each source judged by a classifier trained without
it: floor in 23 of 23, height within 2.3 cm, tilt within 1.75 degrees (0.55 on average), recall 0.970, precision
0.999; table tops 2 of 2; people 10 of 10, false ones 0.25 a frame; the same floor with a height told 5 cm too low,
and at 160 and 640 columns (0.25 and 0.21 a frame). Those that were looked at, of the classifier before, were all cut by
the picture's upper edge: the columns of one machine before a camera 0.6 m high that looks down, a bag on a trolley
under a table's leg (in three frames), and one more.

examples:
  tagalong bench rgbd-recorded FOLDER
  tagalong bench rgbd-recorded FOLDER --camera-height reference --height-error -0.05
  tagalong bench rgbd-recorded FOLDER --columns 640
  tagalong bench rgbd-recorded FOLDER --no-colour
"""

import argparse
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...perception.rgbd.frame import RgbdFrame, grey
from ...perception.rgbd.people import RgbdPeople
from ...perception.rgbd.people_finder import PeopleFinder
from ...perception.rgbd.person_classifier import DEPTH_MODEL, MODEL, PersonClassifier
from ...perception.rgbd.pictures import RecordedFrame, read_frames
from ...perception.rgbd.planes import PlaneFinder, Planes, Surface
from ..console.arguments import at_least, within
from ..console.tables import format_table
from ..figures.planes import save_planes
from ..training.rgbd_labels import FrameLabels, labels_of
from ..training.rgbd_recordings import SEATED_LEFT, at_columns, boxes_of, source_of
from .results import write_results

Array = NDArray[np.float64]

NEAR_M = 5.0
_RECOGNISED = (5.0, 0.15)
_TOP_HEIGHTS = (0.5, 1.1)
_MOST_COLUMNS = 8192  # no camera is taken that has more


@dataclass
class Tally:
    """What was counted of frames.

    Attributes:
        frames: How many.
        floors: Those with a measurable floor.
        recognised: Of these, where it was.
        height: Errors of the height [m], frame by frame where it was recognised.
        tilt: Errors of the tilt [deg].
        recall: Share of the floor's points called so, frame by frame, all with a floor.
        precision: Share of the points called floor that are, likewise where any is.
        off: How far the floor's points lie from the plane that was found, in the median of each frame [m].
        off_reference: The same from the reference plane.
        no_floor: Frames without a floor in sight.
        false_floors: Of these, where one was seen.
        tops: Frames with a labelled table top.
        tops_found: Of these, where it was.
        people: Boxes of people.
        found: Of these, those found.
        false: Detections of nobody within 5 m.
        far: Beyond.
    """

    frames: int = 0
    floors: int = 0
    recognised: int = 0
    height: list[float] = field(default_factory=list)
    tilt: list[float] = field(default_factory=list)
    recall: list[float] = field(default_factory=list)
    precision: list[float] = field(default_factory=list)
    off: list[float] = field(default_factory=list)
    off_reference: list[float] = field(default_factory=list)
    no_floor: int = 0
    false_floors: int = 0
    tops: int = 0
    tops_found: int = 0
    people: int = 0
    found: int = 0
    false: int = 0
    far: int = 0

    def add_floor(self, planes: Planes, labels: FrameLabels) -> None:
        """Count the floor of one frame."""
        if not labels.floor_visible:
            self.no_floor += 1
            self.false_floors += planes.mount.floor_seen
        if labels.height is None or labels.tilt is None:
            return
        self.floors += 1
        up, height = _upwards(*labels.tilt), labels.height
        points = planes.frame.camera.rays * planes.frame.depth[..., None]
        over, within = np.abs(points @ up + height), 0.02 + 0.004 * points[..., 0] ** 2
        near = points[..., 0] < NEAR_M
        is_floor, called = near & (over < within), near & (planes.surface == Surface.FLOOR)
        right, wrong = int((is_floor & called).sum()), int((called & (over > 2.0 * within)).sum())
        self.recall.append(right / max(int(is_floor.sum()), 1))
        if right + wrong:
            self.precision.append(right / (right + wrong))
        tilt = float(np.degrees(np.arccos(np.clip(up @ planes.mount.up, -1.0, 1.0))))
        off = planes.mount.height - height
        if planes.mount.floor_seen and tilt <= _RECOGNISED[0] and abs(off) <= _RECOGNISED[1]:
            self.recognised += 1
            self.height.append(off)
            self.tilt.append(tilt)
            mine = np.abs(points @ planes.mount.up + planes.mount.height)
            either = near & (np.fmin(over, mine) < within)
            self.off.append(float(np.median(mine[either])))
            self.off_reference.append(float(np.median(over[either])))

    def add_tops(self, planes: Planes, labels: FrameLabels) -> None:
        """Count whether a labelled table top was found."""
        if labels.table_top_visible:
            self.tops += 1
            heights = [planes.points[planes.region == k, 2].mean() for k in np.flatnonzero(planes.kinds == Surface.TOP)]
            self.tops_found += any(_TOP_HEIGHTS[0] < height < _TOP_HEIGHTS[1] for height in heights)

    def add_people(self, planes: Planes, people: RgbdPeople, recorded: RecordedFrame, source: str) -> None:
        """Count who was found in one frame, and who is nobody."""
        boxes = boxes_of(recorded, planes.frame.camera.width)
        found = np.zeros(len(boxes), dtype=bool)
        for k in range(len(people)):
            rows, cols = np.nonzero(people.label == k)
            inside = [(cols >= x0) & (rows >= y0) & (cols <= x1) & (rows <= y1) for x0, y0, x1, y1 in boxes]
            shares = np.array([mine.mean() for mine in inside]) * ~found
            distance = float(np.hypot(*people.positions[k]))
            if len(shares) and shares.max() >= 0.5:
                found[shares.argmax()] = True
            elif source in SEATED_LEFT and distance > SEATED_LEFT[source] and cols.mean() < boxes[:, 0].min():
                continue
            elif distance <= NEAR_M:
                self.false += 1
            else:
                self.far += 1
        self.people += len(boxes)
        self.found += int(found.sum())

    def row(self) -> list[str]:
        """Return the cells of a table."""
        off, tilt = np.abs(self.height), np.array(self.tilt)
        recall, precision = np.array(self.recall), np.array(self.precision)
        return [
            str(self.frames),
            f"{self.recognised}/{self.floors}",
            f"{off.mean() * 100:.1f} ({off.max() * 100:.1f})" if len(off) else "-",
            f"{tilt.mean():.2f} ({tilt.max():.2f})" if len(tilt) else "-",
            f"{recall.mean():.3f}" if len(recall) else "-",
            f"{precision.mean():.3f}" if len(precision) else "-",
            f"{np.mean(self.off) * 1000:.1f}, {np.mean(self.off_reference) * 1000:.1f}" if self.off else "-",
            f"{self.false_floors}/{self.no_floor}",
            f"{self.tops_found}/{self.tops}",
            f"{self.found}/{self.people}",
            f"{self.false / max(self.frames, 1):.2f}",
            str(self.far),
        ]


HEADER = (
    "source", "frames", "floor", "height cm (most)", "tilt deg (most)", "recall", "precision", "off mm, reference's",
    "no floor: seen", "tops", "people", "false a frame", "far",
)  # fmt: skip


def _upwards(pitch: float, roll: float) -> Array:
    """Return (3,) the vertical in the frame of a camera that looks down by `pitch`, left side up by `roll` [rad]."""
    return np.array([-np.sin(pitch), np.cos(pitch) * np.sin(roll), np.cos(pitch) * np.cos(roll)])


def tally(recorded: Iterable[RecordedFrame], options: argparse.Namespace) -> dict[str, Tally]:
    """Return what was counted, by source."""
    tallies: dict[str, Tally] = {}
    planes_finder, finders = PlaneFinder(), {}
    for each in recorded:
        source = source_of(each.name)
        if source not in finders:
            finders[source] = _finder_for(source, options)
        counted = tallies.setdefault(source, Tally())
        labels = labels_of(each)
        planes = planes_finder.find(at_columns(_told(each, labels, options), options.columns))
        people = finders[source].find(planes.frame, planes)
        counted.frames += 1
        counted.add_floor(planes, labels)
        counted.add_tops(planes, labels)
        counted.add_people(planes, people, each, source)
        if options.overlays:
            save_planes(options.out / "overlays" / f"{each.name}.png", planes, people)
    return tallies


def _finder_for(source: str, options: argparse.Namespace) -> PeopleFinder:
    """Return the finder that frames of a source are looked at with: if there is one, that trained without them."""
    models = {"": options.model, "_depth": DEPTH_MODEL}
    for ending in models if options.left_out else ():
        without = options.left_out / f"without_{source}{ending}.npz"
        if without.exists():
            models[ending] = without
    classifier, depth_classifier = (PersonClassifier.load(path) for path in models.values())
    return PeopleFinder(classifier, depth_classifier=depth_classifier)


def _told(each: RecordedFrame, labels: FrameLabels, options: argparse.Namespace) -> RgbdFrame:
    """Return the frame with what is told of its mount, and with its colour if that is told."""
    if options.no_colour:
        each = replace(each, frame=replace(each.frame, colour=grey(each.frame.camera)))
    if options.camera_height == "none" or labels.height is None:
        return each.frame
    return replace(each.frame, camera_height=labels.height + options.height_error)


def joined(tallies: Iterable[Tally]) -> Tally:
    """Return all of them together."""
    whole = Tally()
    for each in tallies:
        for name, value in vars(each).items():
            setattr(whole, name, getattr(whole, name) + value)
    return whole


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="labelled frames")
    parser.add_argument(
        "--camera-height", choices=("none", "reference"), default="none", help="what is told of it (default: none)"
    )
    parser.add_argument(
        "--height-error", type=within(-10.0, 10.0), default=0.0, metavar="M", help="added to what is told [m]"
    )
    parser.add_argument(
        "--columns", type=at_least(40, _MOST_COLUMNS), help="look at the frames in about so many columns"
    )
    parser.add_argument("--no-colour", action="store_true", help="look at depth alone")
    parser.add_argument("--model", type=Path, default=MODEL, help="classifier (the shipped one)")
    parser.add_argument(
        "--left-out", type=Path, metavar="DIR", help="folder of without_SOURCE.npz, one for each source"
    )
    parser.add_argument("--overlays", action="store_true", help="draw each frame")


def run(options: argparse.Namespace) -> int:
    """Measure, print, write results.json."""
    tallies = tally(read_frames(options.folder), options)
    rows = [[source, *each.row()] for source, each in tallies.items()]
    print(format_table(HEADER, [*rows, ["all", *joined(tallies.values()).row()]]))
    write_results(options, {"sources": {source: vars(each) for source, each in tallies.items()}})
    return 0
