"""Recordings for viewers, chosen by the ending of their names: .mcap for ROS 2 and Foxglove, .rrd for rerun."""

import os
from pathlib import Path

from ..errors import InputError, shown
from .rerun_recording import RerunRecording, check_rerun_recording
from .ros_recording import RosRecording, check_ros_recording

AnyRecording = RosRecording | RerunRecording
"""They have the same verbs."""


def open_recording(path: str | os.PathLike[str]) -> AnyRecording:
    """Return a new recording, to be used in a `with` block.

    Args:
        path: Of the file: FILE.mcap (messages of ROS 2; extra `ros`) or FILE.rrd (rerun's own; extra `rerun`).

    Raises:
        InputError: If it ends otherwise, or nothing can be written there.
        MissingExtraError: If the extra is not installed.
    """
    return RerunRecording(path) if _is_reruns(path) else RosRecording(path)


def check_recording(path: str | os.PathLike[str]) -> None:
    """Make sure that a recording could be written to `path`, before hours of work are spent on it; raises likewise."""
    _ = check_rerun_recording(path) if _is_reruns(path) else check_ros_recording(path)


def _is_reruns(path: str | os.PathLike[str]) -> bool:
    if Path(path).suffix not in (".mcap", ".rrd"):
        raise InputError(f"{shown(Path(path))}: a recording is called FILE.mcap (ROS 2, Foxglove) or FILE.rrd (rerun)")
    return Path(path).suffix == ".rrd"
