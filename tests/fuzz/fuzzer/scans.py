"""Short drives of a few beams as plain data, and the scans that they describe."""

from typing import Any

import numpy as np
from fuzzer.grammars import poses, ranges
from fuzzer.mutations import extreme_float
from numpy.random import Generator
from tagalong.slam import LaserScan

Frames = list[dict[str, Any]]


def drive(rng: Generator, most: int = 5, beams: int = 40) -> Frames:
    """Return 2 to `most` frames: odometry (3), ranges (n), fan (first, step), limits (2), time and mount (3)."""
    n, count = int(rng.integers(2, beams)), int(rng.integers(2, most + 1))
    fan, mount = [-0.05 * n, 0.1], [0.1, 0.0, 0.0]
    walls = ranges(rng, n)
    return [
        {
            "odometry": pose.tolist(),
            "ranges": np.round(walls + rng.normal(0.0, 0.01, n), 3).tolist(),
            "fan": fan, "limits": [0.05, 10.0], "time": 0.1 * k, "mount": mount,
        }
        for k, pose in enumerate(0.6 * poses(rng, count))
    ]  # fmt: skip


def hostile_drive(rng: Generator, most: int = 5, beams: int = 40) -> Frames:
    """Return a drive of which one to four numbers are extreme, or shapes do not agree; one of ten is sound."""
    frames = drive(rng, most, beams)
    return with_extreme_numbers(rng, frames, int(rng.integers(1, 5)) if rng.random() < 0.9 else 0)


def with_extreme_numbers(rng: Generator, frames: Frames, count: int) -> Frames:
    """Return the frames with so many numbers made extreme, or shapes that do not agree."""
    for _ in range(count):
        frame = frames[int(rng.integers(len(frames)))]
        key = ("odometry", "odometry", "ranges", "ranges", "fan", "limits", "time", "mount")[int(rng.integers(8))]
        if key == "time":
            frame[key] = extreme_float(rng)
        elif rng.random() < 0.06:
            frame[key] = frame[key][: int(rng.integers(len(frame[key]) + 1))]
        elif frame[key]:
            values = list(frame[key])
            values[int(rng.integers(len(values)))] = extreme_float(rng)
            frame[key] = values
    return frames


def scan_of(frame: dict[str, Any]) -> LaserScan:
    """Return the scan of a frame."""
    first, step = (*frame["fan"], 0.1, 0.1)[:2] if len(frame["fan"]) < 2 else frame["fan"]
    bearings = first + step * np.arange(len(frame["ranges"]))
    low, high = (*frame["limits"], 0.05, 10.0)[:2] if len(frame["limits"]) < 2 else frame["limits"]
    return LaserScan(
        np.array(frame["ranges"], dtype=np.float64), bearings, low, high, frame["time"], tuple(frame["mount"])
    )
