"""Reading and writing of recorded drives, trajectories and maps.

`tagalong.slam.read_log` reads every kind of drive. What this folder offers besides:

    read_carmen(path) -> RecordedDrive, write_carmen(path, drive)     drives as CARMEN logs
    read_tum(path) -> Trajectory, write_tum(path, trajectory)         times and poses, a line each
    open_recording(path) -> RosRecording or RerunRecording            what viewers show: FILE.mcap (ROS 2) or FILE.rrd

A name ending in `.gz` is a compressed file. All other names are private.
"""

from typing import TYPE_CHECKING

from ..door import lends

if TYPE_CHECKING:
    from .carmen import read_carmen
    from .carmen_writer import write_carmen
    from .recording import open_recording
    from .rerun_recording import RerunRecording
    from .ros_recording import RosRecording
    from .tum import Trajectory, read_tum, write_tum

__all__ = [
    "RerunRecording",
    "RosRecording",
    "Trajectory",
    "open_recording",
    "read_carmen",
    "read_tum",
    "write_carmen",
    "write_tum",
]

_HOME = {
    "RerunRecording": "rerun_recording",
    "RosRecording": "ros_recording",
    "Trajectory": "tum",
    "open_recording": "recording",
    "read_carmen": "carmen",
    "read_tum": "tum",
    "write_carmen": "carmen_writer",
    "write_tum": "tum",
}
"""Public name -> module; imported when it is asked for."""

__getattr__, __dir__ = lends(__name__, _HOME)
