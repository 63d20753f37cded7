"""Candidates in recorded frames with labelled people: what a classifier of simulated people has not seen."""

import os
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...perception.rgbd.frame import Pinhole, RgbdFrame
from ...perception.rgbd.heads import Candidates, find_candidates
from ...perception.rgbd.person_classifier import candidate_features
from ...perception.rgbd.pictures import RecordedFrame, read_frames
from ...perception.rgbd.planes import PlaneFinder
from .rgbd_labels import labels_of

Array = NDArray[np.float64]

NO_LICENCE = "none stated"
"""How the `licence` of frames begins that may be measured with and not trained on."""
SEATED_LEFT = {"tue": 2.5}
"""Source -> left of the boxes and farther than this [m] people sit who are not boxed: neither somebody nor nobody."""
COLUMNS = (80, 160, 320, 640)
"""Each frame is trained on at all these widths [pixels]: what is somebody at one is at the others."""
CUTS = (0.0, 0.25, 0.5, 0.75)
"""So much of each frame's height is cut off above: a mount that looks lower, or a smaller lens, shows so much."""
BOX_MARGIN = 6.0
"""The boxes are drawn by hand, +- 6 pixels of 320 columns."""
_INSIDE, _OUTSIDE = 0.7, 0.2


def source_of(name: str) -> str:
    """Return where a frame comes from: its name up to the first "_"."""
    return name.split("_")[0]


def boxes_of(recorded: RecordedFrame, columns: int, cut: int = 0) -> Array:
    """Return (n, 4) the people's boxes with their margin, at a width of `columns`, without `cut` rows [pixels]."""
    scale = columns / recorded.frame.camera.width
    off = np.array([0.0, cut, 0.0, cut])
    return (labels_of(recorded).boxes - off + np.array([-1.0, -1.0, 1.0, 1.0]) * BOX_MARGIN) * scale


def recorded_candidates(
    folder: str | os.PathLike[str],
) -> Iterator[tuple[str, NDArray[np.float32], NDArray[np.bool_]]]:
    """Yield, for each frame that may be trained on, its mirror image, each of `COLUMNS` and each of `CUTS`: source,
    features, and who is somebody.
    """
    finder = PlaneFinder()
    for recorded in read_frames(folder):
        if labels_of(recorded).licence.startswith(NO_LICENCE):
            continue
        for mirror, columns, share in product((False, True), COLUMNS, CUTS):
            cut = round(share * recorded.frame.camera.height)
            frame = at_columns(cut_above(recorded.frame, cut), columns)
            planes = finder.find(mirrored(frame) if mirror else frame)
            candidates = find_candidates(planes)
            boxes = boxes_of(recorded, planes.frame.camera.width, cut)
            if mirror:
                boxes[:, [0, 2]] = planes.frame.camera.width - boxes[:, [2, 0]]
            person, sure = _truth(candidates, boxes, source_of(recorded.name), mirror)
            features = candidate_features(planes, candidates)
            yield source_of(recorded.name), features[sure], person[sure]


def at_columns(frame: RgbdFrame, columns: int | None) -> RgbdFrame:
    """Return `frame` with every other pixel left out or each one repeated, so that it has about so many columns."""
    width = frame.camera.width
    if columns is None or columns == width:
        return frame
    if columns > width:
        times = columns // width
        depth, colour = (np.repeat(np.repeat(a, times, axis=0), times, axis=1) for a in (frame.depth, frame.colour))
        (across, down), (column, row) = frame.camera.focal, frame.camera.axis
        size, focal = (width * times, frame.camera.height * times), (across * times, down * times)
        camera = Pinhole.from_intrinsics(size, focal, (column * times - 0.5, row * times - 0.5))
        return replace(frame, depth=depth, colour=colour, camera=camera)
    step = width // columns
    camera, start = frame.camera.reduced(step), step // 2
    rows, cols = camera.height, camera.width
    depth = frame.depth[start::step, start::step][:rows, :cols]
    shift = (start + 0.5) / step - 0.5  # of the pixel that is kept from the middle of its block
    (x, y), (across, down) = camera.axis, camera.focal
    camera = Pinhole.from_intrinsics((cols, rows), (across, down), (x - 0.5 - shift, y - 0.5 - shift))
    return replace(frame, depth=depth, colour=frame.colour[start::step, start::step][:rows, :cols], camera=camera)


def cut_above(frame: RgbdFrame, rows: int) -> RgbdFrame:
    """Return the frame without its uppermost `rows` [pixels]."""
    (column, row), camera = frame.camera.axis, frame.camera
    size = (camera.width, camera.height - rows)
    below = Pinhole.from_intrinsics(size, camera.focal, (column - 0.5, row - rows - 0.5))
    return replace(frame, depth=frame.depth[rows:], colour=frame.colour[rows:], camera=below)


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
