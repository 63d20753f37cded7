"""RVL: lossless compression of depth pictures (Wilson 2017, "Fast Lossless Depth Image Compression")."""

import numpy as np
from numpy.typing import NDArray

from ...slam.errors import InputError
from ...slam.view_kernel import kernel


def decode_rvl(data: bytes, pixels: int) -> NDArray[np.uint16]:
    """Return (pixels,) depths.

    A picture is runs of zeros and of others in turn; lengths, and differences of the others, are numbers of variable
    length: pieces of three bits, each in a nibble whose highest bit says that more follow. Words of 32 bits hold eight
    nibbles, the first one uppermost.

    Args:
        data: Words of 32 bits, little endian.
        pixels: How many there are.

    Raises:
        InputError: If the data end before the picture, or go on beyond it.
    """
    words = np.frombuffer(data[: len(data) // 4 * 4], dtype="<u4")
    depth = np.zeros(pixels, dtype=np.uint16)
    if _decode(words, depth) != pixels:
        raise InputError(f"a depth picture compressed by RVL does not hold the {pixels} pixels that it should")
    return depth


@kernel
def _number(words, at):
    """Return the number whose first nibble is number `at`, and where the next one begins; -1 at the data's end."""
    value, bits = 0, 0
    while at < 8 * len(words) and bits < 33:
        nibble = (int(words[at // 8]) >> (28 - 4 * (at % 8))) & 15
        at += 1
        value |= (nibble & 7) << bits
        bits += 3
        if nibble < 8:
            return value, at
    return -1, at


@kernel
def _decode(words, depth):
    """Write the depths; return how many there were, -1 if the data are not those of as many pixels."""
    done, at, previous = 0, 0, 0
    while done < len(depth):
        zeros, at = _number(words, at)
        if zeros < 0 or done + zeros > len(depth):
            return -1
        done += zeros
        others, at = _number(words, at)
        if others < 0 or done + others > len(depth) or zeros + others == 0:
            return -1
        for _ in range(others):
            code, at = _number(words, at)
            if code < 0:
                return -1
            previous += (code >> 1) ^ -(code & 1)
            depth[done] = previous & 0xFFFF
            done += 1
    return done
