"""Histograms of oriented gradients (Dalal and Triggs 2005) of small pictures, of any number of channels.

Unsigned gradients, `BINS` directions, cells of `CELL` x `CELL` pixels, blocks of 2 x 2 cells with the L2-Hys norm: what
`skimage.feature.hog` computes with these settings, and the tests compare. It is written anew because all of a frame's
candidates have to pass in a few milliseconds; scikit-image takes one channel a call, in float64, and is a large package
for one function.
"""

import numpy as np

from ...slam.view_kernel import kernel

CELL = 8
BINS = 9
_CUT = 0.2


def hog_length(height: int, width: int, channels: int) -> int:
    """Return how many numbers describe a picture of `height` x `width` pixels."""
    return channels * (height // CELL - 1) * (width // CELL - 1) * 4 * BINS


@kernel
def hog(patches, softness, features):
    """Write the descriptors of n pictures.

    Args:
        patches: (n, c, h, w) float32; h and w are multiples of `CELL`.
        softness: Added to the length of a block before it is divided by it; contrast well below it fades.
        features: (n, hog_length(h, w, c)) float32, written; channel by channel, block by block along the rows.
    """
    n, channels, height, width = patches.shape
    rows, cols = height // CELL, width // CELL
    block = np.empty(4 * BINS)
    for k in range(n):
        at = 0
        for c in range(channels):
            cells = np.zeros((rows, cols, BINS))
            _histograms(patches[k, c], cells)
            for i in range(rows - 1):
                for j in range(cols - 1):
                    for part in range(4):
                        for b in range(BINS):
                            block[part * BINS + b] = cells[i + part // 2, j + part % 2, b]
                    _normalise(block, softness)
                    for b in range(4 * BINS):
                        features[k, at + b] = block[b]
                    at += 4 * BINS


@kernel
def _histograms(picture, cells):
    height, width = picture.shape
    for row in range(height):
        for col in range(width):
            down = picture[row + 1, col] - picture[row - 1, col] if 0 < row < height - 1 else np.float32(0.0)
            across = picture[row, col + 1] - picture[row, col - 1] if 0 < col < width - 1 else np.float32(0.0)
            size = np.sqrt(float(down) ** 2 + float(across) ** 2)
            if size == 0.0:
                continue
            angle = np.degrees(np.arctan2(float(down), float(across))) % 180.0
            b = min(int(angle * BINS / 180.0), BINS - 1)
            cells[row // CELL, col // CELL, b] += size / (CELL * CELL)


@kernel
def _normalise(block, softness):
    total = softness * softness
    for value in block:
        total += value * value
    length = np.sqrt(total)
    total = softness * softness
    for b in range(len(block)):
        block[b] = min(block[b] / length, _CUT)
        total += block[b] * block[b]
    block /= np.sqrt(total)
