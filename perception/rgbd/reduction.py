"""Frames of any resolution, brought to the one that perception works at.

Sizes in pixels, and the patterns that the classifier of people was trained on, belong to one resolution. A camera of
more columns is reduced to about that: each pixel of the smaller picture is the median of up to nine of the larger one,
which halves the noise of depth and puts no depth between two surfaces.
"""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...slam.view_kernel import kernel
from .frame import RgbdFrame

Number = TypeVar("Number", bound=np.generic)
WORKING_COLUMNS = 140
"""About so many columns are worked at [pixels]: the training's 128, and what whole steps make of 320, 512 and 640."""


def reduced_frame(frame: RgbdFrame) -> tuple[RgbdFrame, int]:
    """Return `frame` in about `WORKING_COLUMNS`, and how many of its pixels, each way, one of that stands for.

    Rows and columns that are left over at the lower and right edge are cut off. A frame that is small is returned
    as it is.
    """
    step = max(1, round(frame.camera.width / WORKING_COLUMNS))
    step = min(step, frame.camera.height // 2)
    if step < 2:
        return frame, 1
    camera = frame.camera.reduced(step)
    depth = np.empty((camera.height, camera.width), dtype=np.float32)
    median_depth(frame.depth, step, depth)
    colour = frame.colour[: camera.height * step, : camera.width * step]
    offsets = sorted({0, step // 2, step - 1})
    samples = [colour[i::step, j::step].astype(np.uint16) for i in offsets for j in offsets]
    mean = (sum(samples[1:], samples[0]) // len(samples)).astype(np.uint8)
    small = RgbdFrame(depth, mean, camera, frame.time_s, frame.T_robot_camera, frame.camera_height, frame.tilt)
    return small, step


def middle_pixels(values: NDArray[Number], step: int, size: tuple[int, int]) -> NDArray[Number]:
    """Return one of `values` (H, W) for each pixel of the smaller picture of `size` (h, w): the one in the middle."""
    return values[step // 2 :: step, step // 2 :: step][: size[0], : size[1]]


@kernel
def median_depth(depth, step, reduced):
    """Write the median of the measured depths of each block of `step` x `step` pixels.

    Of a block the corners, the middles of the sides and the middle are looked at; it measures nothing where fewer than
    a third of them do. Between the two middle ones of an even number lies the median if they are of one surface
    (within 3 %), else it is the nearer one: no depth may lie between two surfaces.

    Args:
        depth: (H, W) float32, NaN where nothing was measured [m].
        step: Size of a block [pixels].
        reduced: (H // step, W // step) float32, written.
    """
    rows, columns = reduced.shape
    offsets = np.array([0, step // 2, step - 1]) if step > 2 else np.array([0, 1])
    least = -(-len(offsets) * len(offsets) // 3)
    values = np.empty(len(offsets) * len(offsets))
    for row in range(rows):
        for col in range(columns):
            count = 0
            for i in offsets:
                for j in offsets:
                    value = depth[row * step + i, col * step + j]
                    if np.isfinite(value):
                        at = count
                        while at > 0 and values[at - 1] > value:
                            values[at] = values[at - 1]
                            at -= 1
                        values[at] = value
                        count += 1
            if count < least:
                reduced[row, col] = np.nan
                continue
            low, high = values[(count - 1) // 2], values[count // 2]
            reduced[row, col] = 0.5 * (low + high) if high - low < 0.03 * low else low
