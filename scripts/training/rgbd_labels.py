"""What somebody wrote down of a recorded frame: floor, table top, people."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...perception.rgbd.pictures import RecordedFrame, is_number
from ...slam.bounds import FARTHEST_MOUNT_M
from ...slam.errors import InputError, shown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class FrameLabels:
    """Labels of a frame.

    Attributes:
        floor_visible: Whether floor is in sight.
        table_top_visible: Whether a table top is.
        height: Of the camera above the floor [m]; None where there is too little floor to measure it.
        tilt: Pitch (nose down) and roll (left side up) [rad]; None likewise.
        boxes: (n, 4) left, upper, right and lower edge of each person [pixels of the picture].
        licence: On what terms the frame may be used.
    """

    floor_visible: bool
    table_top_visible: bool
    height: float | None
    tilt: tuple[float, float] | None
    boxes: Array
    licence: str


def labels_of(recorded: RecordedFrame) -> FrameLabels:
    """Return the labels of a frame: `floor_visible`, `table_top_visible`, `camera_height_m`, `pitch_deg_nose_down`,
    `roll_deg_left_up`, `people_boxes_xyxy` and, if it says, `licence`.

    Raises:
        InputError: Naming the frame and the label that is missing, or is none.
    """
    notes, name = recorded.notes, f"{recorded.name}.json"
    height = _number(notes, "camera_height_m", name, FARTHEST_MOUNT_M)
    pitch, roll = (_number(notes, key, name, 180.0) for key in ("pitch_deg_nose_down", "roll_deg_left_up"))
    if height is not None and (pitch is None or roll is None):
        raise InputError(f"{name}: where `camera_height_m` is known, pitch and roll must be numbers, too")
    return FrameLabels(
        floor_visible=_truth(notes, "floor_visible", name),
        table_top_visible=_truth(notes, "table_top_visible", name),
        height=height,
        tilt=None if pitch is None or roll is None else (math.radians(pitch), math.radians(roll)),
        boxes=_boxes(notes, name),
        licence=str(notes.get("licence", "")),
    )


def _number(notes: Mapping[str, Any], key: str, name: str, most: float) -> float | None:
    value = notes.get(key, "nothing")
    if value is not None and not (is_number(value) and abs(value) <= most):
        raise InputError(f"{name}: `{key}` must be a number within {most:g}, or null, got {shown(value)}")
    return value


def _truth(notes: Mapping[str, Any], key: str, name: str) -> bool:
    value = notes.get(key, "nothing")
    if not isinstance(value, bool):
        raise InputError(f"{name}: `{key}` must be true or false, got {shown(value)}")
    return value


def _boxes(notes: Mapping[str, Any], name: str) -> Array:
    value = notes.get("people_boxes_xyxy", "nothing")
    fours = isinstance(value, list) and all(isinstance(box, list) and len(box) == 4 for box in value)
    if not fours or not all(is_number(edge) and abs(edge) < 1e6 for box in value for edge in box):
        raise InputError(f"{name}: `people_boxes_xyxy` must be a list of boxes of four numbers, got {shown(value)}")
    return np.array(value, dtype=np.float64).reshape(-1, 4)
