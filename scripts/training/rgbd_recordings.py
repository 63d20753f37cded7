"""Candidates in recorded frames with labelled people: what a classifier of simulated people has not seen."""

import os
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...perception.rgbd.frame import Pinhole, RgbdFrame
from ...perception.rgbd.heads import Candidates, find_candidates
from ...perception.rgbd.person_svm import candidate_features
from ...perception.rgbd.pictures import RecordedFrame, read_frames
from ...perception.rgbd.planes import PlaneFinder
from .rgbd_labels import labels_of

Array = NDArray[np.float64]

NO_LICENCE = "none stated"
"""How the `licence` of frames begins that may be measured with and not trained on."""
SEATED_LEFT = {"tue": 2.5}
"""Source -> left of the boxes and farther than this [m] people sit who are not boxed: neither somebody nor nobody."""
BOX_MARGIN = 6.0
"""The boxes are drawn by hand, +- 6 pixels of 320 columns."""
_INSIDE, _OUTSIDE = 0.7, 0.2


def source_of(name: str) -> str:
    """Return where a frame comes from: its name up to the first "_"."""
    return name.split("_")[0]


def boxes_of(recorded: RecordedFrame, columns: int) -> Array:
    """Return (n, 4) the people's boxes with their margin, at a width of `columns` [pixels]."""
    scale = columns / recorded.frame.camera.width
    return (labels_of(recorded).boxes + np.array([-1.0, -1.0, 1.0, 1.0]) * BOX_MARGIN) * scale


def recorded_candidates(
    folder: str | os.PathLike[str],
) -> Iterator[tuple[str, NDArray[np.float32], NDArray[np.bool_]]]:
    """Yield, for each frame that may be trained on and its mirror image: source, features and who is somebody."""
    finder = PlaneFinder()
    for recorded in read_frames(folder):
        if labels_of(recorded).licence.startswith(NO_LICENCE):
            continue
        for mirror in (False, True):
            planes = finder.find(mirrored(recorded.frame) if mirror else recorded.frame)
            candidates = find_candidates(planes)
            boxes = boxes_of(recorded, planes.frame.camera.width)
            if mirror:
                boxes[:, [0, 2]] = planes.frame.camera.width - boxes[:, [2, 0]]
            person, sure = _truth(candidates, boxes, source_of(recorded.name), mirror)
            features = candidate_features(planes, candidates)
            yield source_of(recorded.name), features[sure], person[sure]


def mirrored(frame: RgbdFrame) -> RgbdFrame:
    """Return the frame with left and right exchanged."""
    (across, down), (column, row), camera = frame.camera.focal, frame.camera.axis, frame.camera
    size = (camera.width, camera.height)
    turned = Pinhole.from_intrinsics(size, (across, down), (camera.width - column - 0.5, row - 0.5))
    return replace(frame, depth=frame.depth[:, ::-1].copy(), colour=frame.colour[:, ::-1].copy(), camera=turned)


def _truth(
    candidates: Candidates, boxes: Array, source: str, mirror: bool
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (n,) whether each candidate is somebody, and whether that is sure."""
    person, sure = np.zeros(len(candidates), dtype=bool), np.ones(len(candidates), dtype=bool)
    inside = np.zeros((len(candidates), len(boxes)), dtype=np.int64)
    for k in range(len(candidates)):
        rows, cols = np.nonzero(candidates.label == k)
        inside[k] = [((cols >= x0) & (rows >= y0) & (cols <= x1) & (rows <= y1)).sum() for x0, y0, x1, y1 in boxes]
        share = inside[k].max(initial=0) / len(rows)
        person[k] = share >= _INSIDE
        far = np.hypot(*candidates.axes[k]) > SEATED_LEFT.get(source, np.inf)
        beside = cols.mean() > boxes[:, 2].max(initial=0.0) if mirror else cols.mean() < boxes[:, 0].min(initial=0.0)
        sure[k] = (share >= _INSIDE or share <= _OUTSIDE) and not (far and beside)
    # of all that lies in a box, what has most of its pixels is somebody; the rest is a piece of them, or behind
    first = np.zeros(len(candidates), dtype=bool)
    first[inside.argmax(axis=0) if len(candidates) else []] = True
    return person & first, sure & (first | ~person)
