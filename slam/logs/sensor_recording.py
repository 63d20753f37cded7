"""Writes what a robot's laser, wheels and RGB-D camera measured as one MCAP file, as their drivers record it."""

import numpy as np
from numpy.typing import NDArray

from .ros_recording import RosRecording
from .viewer_recording import ROBOT

OPTICAL = "camera_optical_frame"
"""The camera's frame: x to the right, y down, z ahead (REP 103)."""
DEPTH, COLOUR = "/camera/depth", "/camera/color"


class SensorRecording(RosRecording):
    """A recorded drive with both sensors: `scan` and `odometry` of the recordings for viewers, and frames.

    Depth is written as floats, so that what is read back is what was measured.

    Args:
        path: Of the file, ending in .mcap.
    """

    def mount(self, time_s: float, T_robot_optical: NDArray[np.float64]) -> None:
        """Write where the camera is on the robot, for good: (4, 4) pose of its optical frame."""
        frames = (ROBOT, OPTICAL)
        self._write("/tf_static", "transform", time_s, lambda make: make.mount(T_robot_optical, time_s, frames))

    def frame(
        self,
        time_s: float,
        depth: NDArray[np.float32],
        colour: NDArray[np.uint8],
        focal: tuple[float, float],
        centre: tuple[float, float],
    ) -> None:
        """Write a frame with the intrinsics of its camera.

        Args:
            time_s: Of the exposure [s].
            depth: (h, w) [m], NaN where nothing was measured.
            colour: (h, w, 3).
            focal: fx and fy [pixels].
            centre: cx and cy [pixels]; the centre of pixel (0, 0) is at (0, 0).
        """
        size = (depth.shape[1], depth.shape[0])
        for topic, pixels in ((DEPTH, depth), (COLOUR, colour)):
            self._write(
                f"{topic}/camera_info",
                "camera_info",
                time_s,
                lambda make: make.camera_info(size, focal, centre, time_s, OPTICAL),
            )
            self._write_picture(f"{topic}/image_raw", pixels, time_s)

    def _write_picture(self, topic: str, pixels: NDArray[np.float32] | NDArray[np.uint8], time_s: float) -> None:
        self._write(topic, "picture", time_s, lambda make: make.picture(pixels, time_s, OPTICAL))
